// A run is kept in a file named by the hash of its key: two keys of one hash are told apart by the
// key in the file. Whoever finds no file, or a bad one, makes the run anew.
#include "study/store.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <sstream>
#include <system_error>

#include "core/errors.hpp"
#include "output.hpp"

namespace vdwmesh::apps {
namespace {

namespace fs = std::filesystem;

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directory(folder, error);
  if (error || !fs::is_directory(folder)) {
    throw InvalidInput(fmt::format("-o {}: the folder cannot be made: {}", folder.string(),
                                   error ? error.message() : "something else has that name"));
  }
}

}  // namespace

std::string hash_text(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return fmt::format("{:016x}", hash);
}

StudyStore::StudyStore(const fs::path& folder) : folder_(folder / "runs") {
  make_folder(folder);
  make_folder(folder_);
  check_writable("-o", folder / "study.json");
  check_writable("-o", folder_ / "run.json");
}

fs::path StudyStore::path_of(const RunKey& key) const {
  return folder_ / (hash_text(key_json(key)) + ".json");
}

std::optional<StudyRun> StudyStore::find(const RunKey& key) const {
  std::ifstream file(path_of(key), std::ios::binary);
  if (!file) return std::nullopt;
  std::ostringstream text;
  text << file.rdbuf();
  return run_of_record(text.str(), key);
}

void StudyStore::keep(const RunKey& key, const StudyRun& run) const {
  write_file(path_of(key), record_json(key, run));
}

}  // namespace vdwmesh::apps

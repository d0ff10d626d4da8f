// Keeps the runs of a study and finds them again. A run stands in a file that is named by the hash
// of its key; the file holds the key as well, which tells two keys of one hash apart. The functions
// describe() that wrote a run also read it (JsonReader), so every member must be there. A file that
// is damaged, cut off or of another version is as if it was not there: the run is made anew.
#include "study/records.hpp"

#include <fmt/format.h>

#include <concepts>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "build_id.hpp"
#include "core/errors.hpp"
#include "core/fnv.hpp"
#include "report/json_text.hpp"
#include "report/output.hpp"
#include "request/refuse.hpp"

namespace vdwmesh::apps {

using Json = nlohmann::ordered_json;

// A visitor for describe(), which shows it every member with its key: it fills the member with the
// value that stands in the JSON under that key. It throws Json::exception or InvalidInput where
// there is none that fits.
class JsonReader {
 public:
  explicit JsonReader(const Json& in) : in_(in) {}
  template <class T>
  void operator()(const char* key, T& value) {
    read(in_.at(key), value);
  }

 private:
  template <class T>
  static void read(const Json& json, T& value) {
    if constexpr (std::is_enum_v<T>) {
      value = value_named<T>("record", json.get_ref<const std::string&>());
    } else if constexpr (std::is_floating_point_v<T>) {
      value = json.is_null() ? std::numeric_limits<T>::quiet_NaN() : json.get<T>();
    } else if constexpr (std::is_class_v<T> && !std::constructible_from<Json, T>) {  // has members
      JsonReader inner(json);
      describe(inner, value);
    } else {
      value = json.get<T>();
    }
  }
  template <class T>
  static void read(const Json& json, std::optional<T>& value) {
    value.reset();
    if (!json.is_null()) read(json, value.emplace());
  }

  const Json& in_;
};

namespace {

namespace fs = std::filesystem;

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directory(folder, error);
  refuse_if(error || !fs::is_directory(folder), "-o {}: the folder cannot be made: {}",
            folder.string(), error ? error.message() : "something else has that name");
}

}  // namespace

// The build is part of the key: other code may give other figures.
void describe(JsonText& a, const RunKey& key) {
  a("version", kVersion), a("revision", kRevision), a("build", kBuild);
  a("spheres", key.spheres);
  a("setting", key.setting);
  a("samples", key.samples), a("seed", key.seed);
  a("self_intersections", key.self_intersections);
  a("device", key.device), a("threads", key.threads);
}

std::string hash_text(std::string_view bytes) { return fmt::format("{:016x}", fnv1a(bytes)); }

StudyStore::StudyStore(const fs::path& folder) : folder_(folder / "runs") {
  make_folder(folder);
  make_folder(folder_);
  // Before hours of work: "run.json" stands for the files of all runs.
  check_writable("-o", folder / "study.json");
  check_writable("-o", folder_ / "run.json");
}

fs::path StudyStore::path_of(const RunKey& key) const {
  return folder_ / (hash_text(json_of(key)) + ".json");
}

std::optional<StudyRun> StudyStore::find(const RunKey& key) const {
  std::ifstream file(path_of(key), std::ios::binary);
  if (!file) return std::nullopt;
  try {
    const Json kept = Json::parse(file);
    if (kept.at("key") != Json::parse(json_of(key))) return std::nullopt;
    StudyRun run;
    JsonReader reader(kept.at("run"));
    describe(reader, run);
    return run;
  } catch (const Json::exception&) {
    return std::nullopt;
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

void StudyStore::keep(const RunKey& key, const StudyRun& run) const {
  JsonText json;
  json("key", key), json("run", run);
  write_file(path_of(key), std::move(json).take());
}

}  // namespace vdwmesh::apps

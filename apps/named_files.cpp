// Keeps account of the files that a command line names. Two names are one file if the system says
// so, which follows links. For files that do not exist yet, the paths that would be written are
// compared. Devices and pipes may be named twice, because nothing is lost on them.
#include "named_files.hpp"

#include <fmt/format.h>

#include <system_error>
#include <utility>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "mesh/formats/output_file.hpp"
#include "report/output.hpp"

namespace vdwmesh::apps {
namespace {

namespace fs = std::filesystem;

bool same_file(const fs::path& a, const fs::path& b) {
  if (a == "-" || b == "-") return a == b;
  if (is_written_directly(a)) return false;
  std::error_code error;
  if (fs::equivalent(a, b, error) && !error) return true;
  const fs::path whole_a = fs::weakly_canonical(written_file(a), error);
  if (error) return false;
  const fs::path whole_b = fs::weakly_canonical(written_file(b), error);
  return !error && whole_a == whole_b;
}

}  // namespace

bool is_vtkhdf(const fs::path& path) { return lower_case(path.extension().string()) == ".vtkhdf"; }

void NamedFiles::add_input(std::string_view option, const fs::path& path) {
  if (path != "-") add({std::string(option), path, Use::reads});
}

void NamedFiles::add_output(std::string_view option, const fs::path& path) {
  if (!path.empty() && path != "-") check_writable(option, path);
  add({std::string(option), path, Use::writes});
}

void NamedFiles::add_output_in(std::string_view option, const fs::path& folder,
                               const fs::path& name) {
  add({std::string(option), folder / name, Use::writes});
}

void NamedFiles::add(Named named) {
  if (named.path.empty()) return;
  for (const Named& other : files_) {
    const bool harmless = named.use == Use::reads && other.use == Use::reads;
    if (harmless || !same_file(named.path, other.path)) continue;
    const bool overwrites = named.use != other.use;
    const Named& output = named.use == Use::writes ? named : other;
    const Named& taken = &output == &named ? other : named;
    throw InvalidInput(fmt::format("{} {}: {} {}; name another file", output.option,
                                   output.path.string(),
                                   overwrites ? "would overwrite" : "is written by", taken.option));
  }
  files_.push_back(std::move(named));
}

}  // namespace vdwmesh::apps

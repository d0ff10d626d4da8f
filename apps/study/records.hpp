// Finished runs of a study, each in a file of its own that appears whole or not at all: JSON, with
// everything that the run depends on beside it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "study/describe_study.hpp"

namespace vdwmesh::apps {

// Everything that a run depends on, the program included.
struct RunKey {
  std::string spheres;  // their hash
  StudySetting setting;
  std::optional<double> samples = {};  // per Å²; none without distances, like the seed
  std::optional<std::uint64_t> seed = {};
  int self_intersections;
  std::optional<std::string> device;
  int threads;
};

// FNV-1a, 64 bits, as sixteen hexadecimal digits.
std::string hash_text(std::string_view bytes);

class StudyStore {
 public:
  // Makes the folder where it is not there; what it is in must be. Throws InvalidInput.
  explicit StudyStore(const std::filesystem::path& folder);

  // The run kept under exactly this key. A file that is damaged or of another key counts as none.
  std::optional<StudyRun> find(const RunKey& key) const;
  void keep(const RunKey& key, const StudyRun& run) const;

 private:
  std::filesystem::path path_of(const RunKey& key) const;
  std::filesystem::path folder_;
};

}  // namespace vdwmesh::apps

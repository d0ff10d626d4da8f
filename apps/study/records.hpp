// Keeps the finished runs of a study, each in a JSON file of its own with everything that the run
// depends on. A file appears complete or not at all.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "study/describe_study.hpp"

namespace vdwmesh::apps {

// Everything that a run depends on; the store adds the program itself.
struct RunKey {
  std::string spheres;  // their hash
  StudySetting setting;
  std::optional<double> samples = {};  // per Å²; this and the seed are empty without distances
  std::optional<std::uint64_t> seed = {};
  int self_intersections;
  std::optional<std::string> device;
  int threads;
};

// FNV-1a, 64 bits, as sixteen hexadecimal digits.
std::string hash_text(std::string_view bytes);

class StudyStore {
 public:
  // Makes the folder if it does not exist. Throws InvalidInput if that fails: its parent must
  // exist.
  explicit StudyStore(const std::filesystem::path& folder);

  // The run kept under exactly this key; empty if there is none, or if its file is damaged or
  // belongs to another key.
  std::optional<StudyRun> find(const RunKey& key) const;
  void keep(const RunKey& key, const StudyRun& run) const;

 private:
  std::filesystem::path path_of(const RunKey& key) const;
  std::filesystem::path folder_;
};

}  // namespace vdwmesh::apps

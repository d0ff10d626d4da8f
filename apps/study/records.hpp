// Finished runs of a study as they are kept: JSON with everything that a run depends on beside it.
#pragma once

#include <optional>
#include <string>

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

std::string key_json(const RunKey& key);
std::string record_json(const RunKey& key, const StudyRun& run);

// The run of a record; nothing where the text is damaged or of another key.
std::optional<StudyRun> run_of_record(const std::string& record, const RunKey& key);

}  // namespace vdwmesh::apps

// What a study varies, and how long it may take.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "options.hpp"

namespace vdwmesh::apps {

// The files of a study's folder.
inline constexpr const char *kStudyTable = "study.csv", *kStudyDocument = "study.json",
                            *kStudyPage = "index.html";

// What vertices are moved to after a subdivision, told per field.
enum class StudyProjection { own, vdw, field, none };

// Every combination is a run. The command line has the defaults.
struct StudyAxes {
  std::vector<Mesher> meshers;
  std::vector<double> spacings;      // Å, of marching cubes, longest first
  std::vector<double> edge_lengths;  // Å, of the exact mesher, longest first
  std::vector<int> subdivisions;     // rising
  std::vector<FieldKind> fields;
  std::vector<StudyProjection> projections;
  std::vector<Backend> backends;
};

struct StudyOptions {
  ExactSurface surface = ExactSurface::vdw;  // of all meshes; `excluded` by Mesher::exact alone
  StudyAxes axes;
  DistanceChoice distances;
  SelfIntersections self_intersections = SelfIntersections::count;
  MachineOptions machine;
  std::filesystem::path folder;
  Switch resume = Switch::on;                // whether finished runs are taken from the folder
  std::optional<double> time_limit;          // s after which no further run begins
  std::uint64_t page_triangles = 1'000'000;  // of all meshes that the page shows
};

}  // namespace vdwmesh::apps

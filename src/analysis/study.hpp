// The records of a study: meshes of one molecule made in many ways, and what those that differ in
// resolution alone show together.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "analysis/comparison.hpp"
#include "analysis/convergence.hpp"
#include "analysis/mesh_measures.hpp"
#include "analysis/quality_histograms.hpp"
#include "extract/field.hpp"
#include "refine/refiner.hpp"

namespace vdwmesh {

enum class Mesher : std::uint8_t { marching_cubes, exact };

// How a mesh was made, but for its resolution.
struct StudyKey {
  Mesher mesher = Mesher::marching_cubes;
  FieldKind field = FieldKind::vdw;
  Projection projection = Projection::none;  // none without subdivisions
  int subdivisions = 0;
  std::string backend;  // the one that ran

  auto operator<=>(const StudyKey&) const = default;
};

struct StudySetting {
  StudyKey key;
  double resolution = 0;  // Å: spacing of the grid, or edge length of the exact mesher

  auto operator<=>(const StudySetting&) const = default;
};

// Wall-clock seconds of the stages that lead to this mesh, all levels up to it included.
struct StudySeconds {
  std::optional<double> field, extract, refine;  // refine: of subdivided meshes only
  double mesh = 0;                               // all of them
  std::optional<double> distances;
};

struct StudyMemory {
  std::uint64_t mesh = 0;             // bytes of the mesh's arrays
  std::optional<std::uint64_t> peak;  // largest resident size of the process while it was made
};

struct StudyRun {
  StudySetting setting;
  MeshTopology topology{};
  MeshMeasures measures{};
  MeshQuality quality{};
  QualityHistograms histograms;
  std::optional<std::uint64_t> self_intersections;
  Comparison comparison;
  StudySeconds seconds;
  StudyMemory memory;
};

// Fits over the runs of a series; empty where fewer than two of them say anything.
struct StudyOrders {
  std::optional<PowerLaw> area_error, volume_error;  // relative, by magnitude
  std::optional<PowerLaw> mesh_to_surface_rms, surface_to_mesh_rms, hausdorff;
};

struct StudySeries {
  StudyKey key;
  std::vector<std::size_t> runs;  // indices, finest resolution first
  StudyOrders by_resolution;      // order p: error ~ resolution^p
  StudyOrders by_triangles;       // order p: error ~ (number of triangles)^p, so p < 0 converges
  std::optional<Extrapolation> area, volume;  // Å², Å³ at resolution 0, of the three finest runs
};

// Runs that differ in resolution alone, series by series in the order of their keys. Precondition:
// all runs are of one molecule, no two have the same setting.
std::vector<StudySeries> find_series(std::span<const StudyRun> runs);

}  // namespace vdwmesh

// Records of a study: many meshes of one molecule with their measures, and the orders of
// convergence of each series of meshes.
//
// A run is one mesh with its measures. A setting says how the mesh was made; it consists of a key
// and a resolution. A series consists of the runs with the same key.
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

// How a mesh was made, without its resolution.
struct StudyKey {
  Mesher mesher = Mesher::marching_cubes;
  FieldKind field = FieldKind::vdw;
  Projection projection = Projection::none;  // always `none` if there are no subdivisions
  int subdivisions = 0;
  std::string backend;  // the backend that ran, which may differ from the requested one

  auto operator<=>(const StudyKey&) const = default;
};

struct StudySetting {
  StudyKey key;
  double resolution = 0;  // Å: grid spacing, or edge length of the crease-exact mesher

  auto operator<=>(const StudySetting&) const = default;
};

// Wall-clock seconds of the stages that made the mesh, including all coarser refinement levels that
// it was made from.
struct StudySeconds {
  std::optional<double> field, extract, refine;  // refine has a value for subdivided meshes only
  double mesh = 0;                               // all stages together
  std::optional<double> distances;
};

struct StudyMemory {
  std::uint64_t mesh = 0;             // bytes of the mesh's arrays
  std::optional<std::uint64_t> peak;  // bytes: largest resident size while the mesh was made
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

// One fit for each kind of error. A fit is empty if fewer than two runs have a usable error.
struct StudyOrders {
  std::optional<PowerLaw> area_error, volume_error;  // absolute values of the relative errors
  std::optional<PowerLaw> mesh_to_surface_rms, surface_to_mesh_rms, hausdorff;  // in Å
};

struct StudySeries {
  StudyKey key;
  std::vector<std::size_t> runs;  // indices into the runs of the study, finest resolution first
  StudyOrders by_resolution;      // order p in error ~ resolution^p
  StudyOrders by_triangles;  // order p in error ~ (number of triangles)^p; p < 0 means convergence
  std::optional<Extrapolation> area, volume;  // Å², Å³ at resolution 0, from the three finest runs
};

// Groups the runs into series, in the order of their keys. Precondition: all runs are of one
// molecule, and no two have the same setting.
std::vector<StudySeries> find_series(std::span<const StudyRun> runs);

}  // namespace vdwmesh

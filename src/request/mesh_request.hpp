// What is asked of a mesh, and the checked options that follow from it. The program, its ranks and
// Python ask in this form, so that one option means the same to all of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "refine/refiner.hpp"
#include "request/measure_request.hpp"

namespace vdwmesh {

inline constexpr double kUsualEdgeLength = 0.35;  // Å, of Mesher::exact
// Å. With longer edges the mesh along the curves of the excluded surface gets next to no coarser.
inline constexpr double kLongestAlongCurves = 0.7;

// Edge lengths of Mesher::exact that differ from atom to atom.
struct EdgeGrading {
  std::optional<double> relative;   // as a share of the sphere's radius
  std::string table;                // path of a table of atoms with their edge lengths
  std::vector<std::string> groups;  // "SELECTION=LENGTH" as it was given
  std::vector<double> of_groups;    // Å, of the groups of ReadOptions::groups
  bool is_uniform() const { return !relative && table.empty() && groups.empty(); }
};

// What was not said is empty.
struct MeshRequest {
  Door door = Door::program;
  SurfaceChoice surface = SurfaceChoice::vdw;
  std::optional<Mesher> mesher;
  Mesher usual_mesher = Mesher::exact;  // where nothing that is asked for tells
  std::optional<double> edge_length;    // Å
  std::optional<double> density;        // triangles per Å², of the excluded surface
  std::optional<double> max_distance;   // Å, between that and its mesh
  EdgeGrading grading;
  std::vector<double> edge_lengths;  // Å, by atom
  std::optional<double> min_angle;   // degrees
  FieldKind field = FieldKind::vdw;
  std::optional<FieldPreset> preset;  // radius_aware, if none was said
  std::optional<double> isovalue, blobbiness;
  std::optional<double> spacing, padding;  // Å
  bool fixed_grid = false;                 // nodes at multiples of the spacing
  std::optional<int> subdivisions;
  int subdivisions_of_cubes = 0;  // of marching cubes, where none are asked for
  std::optional<Projection> projection;
  std::optional<Crossings> crossings;
};

struct SurfaceOptions {
  ExactSurface kind = ExactSurface::vdw;  // `excluded` by Mesher::exact alone
  Mesher mesher = Mesher::marching_cubes;
  // What decided that: "default", or an option such as --mesher or --spacing; empty where a verb
  // has one mesher.
  std::string mesher_reason;
  // Å, of Mesher::exact; empty: the grading gives all lengths.
  std::optional<double> edge_length;
  std::optional<double> density;  // that was asked for, triangles per Å²; it gives the edge length
  // That was asked for, Å; the edge length is then the first that is tried.
  std::optional<double> max_distance;
  // The mesh of the excluded surface does not follow the curves between its patches, so it can have
  // fewer triangles: if a density or a distance is asked for, or edges longer than
  // kLongestAlongCurves.
  bool remeshed = false;
  EdgeGrading grading;
  std::vector<double> edge_lengths;  // Å, by sphere, once the structure is read; empty: all alike
  std::optional<double> min_angle;   // degrees, of Mesher::exact
  FieldOptions field;
  GridOptions grid;
  int subdivisions = 0;
  Projection projection = Projection::none;
  Crossings crossings = Crossings::undo;
  std::vector<std::string> notes;  // for people: options that have no effect

  // Whether `crossings` has an effect. Nothing can cross if no vertex moves, and meshes of the
  // exact mesher are refined without a search (refine/refiner.hpp).
  bool looks_for_crossings() const {
    return mesher == Mesher::marching_cubes && projection != Projection::none;
  }
};

// Throws InvalidInput where what is asked for does not go together. What has no effect is a note,
// and refused where the door has no place for notes (Python).
SurfaceOptions settle(const MeshRequest& request);

}  // namespace vdwmesh

// Summits of the clearance and the passes between them: for the library's own use.
//
// A pass is the centre of a circle that touches three balls from outside, none of which is nearer
// than any other ball, and that lies within the triangle of their centres. From there the clearance
// rises to both sides, to two summits or without end. All places where a probe fits that is larger
// than some radius, and how they hang together, follow from summits and passes alone (Morse theory
// of the distance function).
#pragma once

#include <array>
#include <map>
#include <span>
#include <vector>

#include "complex/power_triangulation.hpp"
#include "pockets/clearance.hpp"

namespace vdwmesh {

inline constexpr std::uint32_t kOutsideNode = 0;

struct ClearancePass {
  ClearPlace at;
  std::array<std::uint32_t, 3> balls;  // ascending; as in `base`
  Vec3d normal;                        // unit normal of their triangle
  std::array<std::uint32_t, 2> nodes;  // the summits along the normal, and against it
};

// Lengths are scaled as in `base`.
struct ClearanceGraph {
  PowerTriangulation base;  // the triangulation of the balls as they are
  // Summits. Node 0 is the outside; nodes 1 to `large` are components above the ceiling, with the
  // highest summits that are known in each.
  std::vector<ClearPlace> nodes;
  std::uint32_t large = 0;
  std::vector<ClearancePass> passes;  // between 0 and the ceiling, by falling clearance
  // For each length by which balls were grown, the number of enclosed components of what is outside
  // them; by exact predicates.
  std::map<double, std::uint64_t> enclosed;
  std::vector<std::uint32_t> start_nodes;  // by start: where the climb from there ends
  bool is_complete = true;                 // summits and passes explain the numbers at all levels
};

// Finds summits and passes with clearances between 0 and the ceiling (Å). Their triangles and cells
// come from triangulations of balls that are grown by several lengths. The numbers of components at
// these lengths are exact; where summits and passes do not explain them, more lengths are taken in
// between. `starts`: places (Å) of clearance 0 or more.
ClearanceGraph clearance_graph(const SphereSet& balls, double ceiling,
                               std::span<const Vec3d> starts, Monitor* monitor,
                               std::uint64_t memory_limit);

// The way up from a pass, along its normal (side 0) or against it (1), to a summit or the ceiling
// (scaled); empty if it does not rise.
std::vector<ClearPlace> way_up(const std::vector<Sphere>& balls, const ClearancePass& pass,
                               std::size_t side, double ceiling);

}  // namespace vdwmesh

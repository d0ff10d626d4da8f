// First derivatives of the exact area and volume of a union of balls, by centres and radii.
//
// A_i is the exposed area of sphere i, V_i the volume of ball i ∩ its power cell. Given weights w
// and u, union_gradients() differentiates Σ w_i A_i and Σ u_i V_i: forces of a solvation energy, or
// the backward pass of a loss. The derivatives are exact, in closed form from the arcs and faces of
// each ball (Edelsbrunner and Koehl 2003, "The weighted-volume derivative of a space-filling
// diagram"; Bryant, Edelsbrunner, Koehl and Levitt 2004, "The area derivative of a space-filling
// diagram").
//
// Where no derivative exists. A pair of spheres that touch has a kink: its one-sided derivatives
// differ. So has a pair of equal balls, and with unequal weights a ball that just vanishes in
// another one. There the result is that of the pair without contact; 0 for a ball within another
// one; and for equal balls that of the lowest index alone, with 0 for the others. Everywhere else
// the result is the derivative, however degenerate the set is; it is never NaN.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec3.hpp"
#include "measures/exact_union.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class Monitor;
class Workspace;

// Derivatives by one ball: eight doubles without gaps.
struct BallGradient {
  Vec3d area_center;     // Å: of Σ w A by the centre
  double area_radius;    // Å: of Σ w A by the radius
  Vec3d volume_center;   // Å²: of Σ u V by the centre
  double volume_radius;  // Å²: of Σ u V by the radius
};

struct GradientOptions {
  // w and u: one for each sphere, of any sign; without them (empty) all are 1.
  std::span<const double> area_weights = {}, volume_weights = {};
  Monitor* monitor = nullptr;
  Workspace* workspace = nullptr;  // if not null, keeps memory and cell list for later calls
};

struct UnionGradients {
  double area, volume;  // Å², Å³: of the union, without weights
  // In the order of the SphereSet.
  std::vector<SphereMeasures> per_sphere;
  std::vector<BallGradient> gradients;
  std::uint64_t fallback_spheres = 0;  // from the triangulation, as in ExactUnion
  // Spheres that touch another one, from outside or inside, or all but do (within 1e-9 of their
  // size), and balls that equal one of a lower index. They may have no derivative.
  std::uint64_t kink_spheres = 0;
};

// The measures, with the same bits as exact_union() by arcs, and their gradients, in one pass. Each
// ball gathers its derivatives from its own power cell, so the result is the same, bit for bit, for
// any number of threads, and follows the balls if they are numbered otherwise.
// Throws InvalidInput for an empty set, an array of weights of another length, a weight that is not
// finite, or a result that is not finite in double; and Cancelled.
UnionGradients union_gradients(const SphereSet& spheres, const GradientOptions& options = {});

// The same, written into an existing result, whose arrays are reused.
void union_gradients_into(UnionGradients& result, const SphereSet& spheres,
                          const GradientOptions& options);

// The product the other way: by how much each A_i (Å²) and V_i (Å³) changes, to first order, if
// centres move and radii grow by so much (Å). One for each sphere; none (empty) for no change.
std::vector<SphereMeasures> measure_rates(const SphereSet& spheres, std::span<const Vec3d> centers,
                                          std::span<const double> radii,
                                          Monitor* monitor = nullptr);

// All derivatives of every A_i and V_i, as a sparse matrix in compressed rows (CSR). Row i has
// entries first[i] to first[i + 1] - 1, by ascending columns: ball i itself, and the balls that
// bound its power cell within the ball. Entry e holds the derivatives of A_i and V_i by ball
// columns[e].
struct UnionJacobian {
  std::vector<std::size_t> first;
  std::vector<SphereId> columns;
  std::vector<BallGradient> blocks;
};
UnionJacobian union_jacobian(const SphereSet& spheres, Monitor* monitor = nullptr);

}  // namespace vdwmesh

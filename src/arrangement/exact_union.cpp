// Runs the method of the exact union that the caller chose, and translates lengths and order.
//
// The triangulation works on balls in its own order (power_triangulation.hpp), whose lengths are
// divided by 2^scale_exponent. unscaled() and scale() bring its results back to Å and to the order
// of the SphereSet. The power of two makes this exact, short of overflow and underflow.
//
// The arcs work on the SphereSet itself. Where they mark a sphere as suspect, the measures of a
// triangulation replace theirs.
#include "arrangement/exact_union.hpp"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "arrangement/arcs/arcs.hpp"
#include "arrangement/complex/dual_complex.hpp"
#include "arrangement/complex/measures.hpp"
#include "arrangement/complex/power_triangulation.hpp"
#include "arrangement/complex/topology.hpp"
#include "core/errors.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {
namespace {

// A factor of 2^exponent on lengths is one of 2^(2 exponent) on areas, 2^(3 exponent) on volumes.
double scaled_area(double area, int exponent) { return std::ldexp(area, 2 * exponent); }
double scaled_volume(double volume, int exponent) { return std::ldexp(volume, 3 * exponent); }

void scale(UnionTopology& topology, int exponent) {
  for (Shell& shell : topology.shells) {
    shell = {scaled_area(shell.area, exponent), scaled_volume(shell.volume, exponent)};
  }
  topology.outer_area = scaled_area(topology.outer_area, exponent);
  topology.void_area = scaled_area(topology.void_area, exponent);
  topology.void_volume = scaled_volume(topology.void_volume, exponent);
}

// Returns the measures of the triangulation's balls in the order and the units of the SphereSet.
// Spheres that the triangulation leaves out, because a concentric one covers them, get 0.
std::vector<SphereMeasures> unscaled(const SphereSet& spheres, const PowerTriangulation& t,
                                     const std::vector<SphereMeasures>& measures) {
  std::vector<SphereMeasures> out(spheres.size(), SphereMeasures{0, 0});
  for (std::size_t i = 0; i < measures.size(); ++i) {
    out[t.ids[i]] = {scaled_area(measures[i].area, t.scale_exponent),
                     scaled_volume(measures[i].volume, t.scale_exponent)};
  }
  return out;
}

ExactUnion union_by_triangulation(const SphereSet& spheres, Monitor* monitor) {
  constexpr std::uint64_t kSteps = 3;
  begin_stage(monitor, "exact union", kSteps);
  const PowerTriangulation triangulation = triangulate(spheres, monitor);
  advance(monitor, 1);
  const DualComplex complex = dual_complex(triangulation);
  advance(monitor, 1);
  std::vector<SphereMeasures> measures;
  UnionTopology topology;
  SphereMeasures check;
  // The two computations share nothing but their inputs, so they run side by side.
  tbb::parallel_invoke(
      [&] {
        measures = inclusion_exclusion(triangulation, complex);
        topology = union_topology(triangulation, complex, measures);
      },
      [&] { check = total_measures(gauss_bonnet(triangulation, complex)); });
  scale(topology, triangulation.scale_exponent);
  // union_topology() knows the balls of the triangulation only; all other spheres are hidden.
  topology.hidden_spheres += spheres.size() - triangulation.balls.size();
  advance(monitor, 1);

  ExactUnion result{};
  result.method = UnionMethod::cgal;
  result.per_sphere = unscaled(spheres, triangulation, measures);
  const SphereMeasures total = total_measures(result.per_sphere);
  result.area = total.area;
  result.volume = total.volume;
  result.check_area = scaled_area(check.area, triangulation.scale_exponent);
  result.check_volume = scaled_volume(check.volume, triangulation.scale_exponent);
  result.topology = std::move(topology);
  return result;
}

// Returns the ids of the wanted spheres and of every sphere that may overlap one of them, ascending
// and without repetition.
std::vector<SphereId> neighborhood(const SphereSet& spheres, const std::vector<SphereId>& wanted) {
  const CellList list = make_ball_list(spheres);
  const CellListView& view = list.view();
  std::vector<SphereId> near(wanted);
  for (const SphereId id : wanted) {
    const Sphere& s = spheres[id];
    const Vec3d reach{s.radius, s.radius, s.radius};
    visit_near_box(view, s.center - reach, s.center + reach, [&](std::uint32_t place) {
      near.push_back(view.id[place]);
      return false;
    });
  }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  return near;
}

// Replaces the measures of suspect spheres by those of a triangulation of their neighbourhoods. The
// exposed area of a sphere and its ball ∩ power cell depend only on the balls that meet its ball,
// so a triangulation of these neighbourhoods is enough.
void replace_by_reference(const SphereSet& spheres, const std::vector<SphereId>& suspect,
                          std::vector<SphereMeasures>& per_sphere) {
  if (suspect.empty()) return;
  const std::vector<SphereId> near = neighborhood(spheres, suspect);
  std::vector<Sphere> subset;
  subset.reserve(near.size());
  for (const SphereId id : near) subset.push_back(spheres[id]);
  const SphereSet local(std::move(subset));
  const PowerTriangulation triangulation = triangulate(local);
  const auto measures = unscaled(local, triangulation,
                                 inclusion_exclusion(triangulation, dual_complex(triangulation)));
  for (const SphereId id : suspect) {
    const auto place = std::lower_bound(near.begin(), near.end(), id) - near.begin();
    per_sphere[id] = measures[static_cast<std::size_t>(place)];
  }
}

// Method arcs: no triangulation, except one of the neighbourhoods of suspect spheres.
void union_by_arcs(ExactUnion& result, const SphereSet& spheres, Monitor* monitor,
                   Workspace& workspace) {
  auto& arcs = workspace.get<ArcMeasures>();
  std::swap(arcs.per_sphere, result.per_sphere);  // so that the result's own memory is used
  arc_measures(arcs, spheres, monitor, workspace);
  replace_by_reference(spheres, arcs.suspect, arcs.per_sphere);
  const SphereMeasures total = total_measures(arcs.per_sphere);
  result = {UnionMethod::arcs, total.area, total.volume, {}, {}, {}, {}, arcs.suspect.size()};
  std::swap(arcs.per_sphere, result.per_sphere);
}

// Method both: the measures of the triangulation. The check is the sum over the arcs' measures, in
// which suspect spheres count with their measures from the triangulation.
ExactUnion union_by_both(const SphereSet& spheres, Monitor* monitor, Workspace& workspace) {
  ExactUnion result = union_by_triangulation(spheres, monitor);
  auto& arcs = workspace.get<ArcMeasures>();
  arc_measures(arcs, spheres, monitor, workspace);
  for (const SphereId id : arcs.suspect) arcs.per_sphere[id] = result.per_sphere[id];
  const SphereMeasures check = total_measures(arcs.per_sphere);
  result.method = UnionMethod::both;
  result.check_area = check.area;
  result.check_volume = check.volume;
  result.fallback_spheres = arcs.suspect.size();
  return result;
}

void measure_union(ExactUnion& result, const SphereSet& spheres, const UnionOptions& options,
                   Workspace& workspace) {
  switch (options.method) {
    case UnionMethod::cgal:
      result = union_by_triangulation(spheres, options.monitor);
      return;
    case UnionMethod::arcs:
      union_by_arcs(result, spheres, options.monitor, workspace);
      return;
    case UnionMethod::both:
      result = union_by_both(spheres, options.monitor, workspace);
      return;
  }
  throw InvalidInput("unknown method of the exact union");
}

}  // namespace

void exact_union_into(ExactUnion& result, const SphereSet& spheres, const UnionOptions& options) {
  if (spheres.empty()) throw InvalidInput("the union of an empty set of spheres is not defined");
  WorkspaceOfCall workspace(options.workspace);
  measure_union(result, spheres, options, workspace);
  require_finite({{result.area, result.volume},
                  {result.check_area.value_or(0), result.check_volume.value_or(0)}});
}

ExactUnion exact_union(const SphereSet& spheres, const UnionOptions& options) {
  ExactUnion result;
  exact_union_into(result, spheres, options);
  return result;
}

}  // namespace vdwmesh

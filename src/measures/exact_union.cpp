// exact_union(): runs the method that the caller chose, or for method automatic the faster one that
// answers what is wanted.
// - cgal: regular triangulation, dual complex, and inclusion-exclusion.
// - arcs: each sphere by itself, from the circular arcs on it (arcs/arcs.hpp). Spheres that
//   arc_measures() marks as suspect, because a check failed, get the measures of a small
//   triangulation instead.
// - both: the result of cgal, with the arcs as the check.
//
// The triangulation works on balls in its own order (power_triangulation.hpp), whose lengths are
// divided by 2^scale_exponent. in_order_of() brings measures of balls back to Å and to the order of
// the SphereSet, unscale() the measures of the topology back to Å. The power of two makes this
// exact, short of overflow and underflow. The arcs work on the SphereSet itself.
#include "measures/exact_union.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "complex/dual_complex.hpp"
#include "complex/power_triangulation.hpp"
#include "core/errors.hpp"
#include "core/monitor.hpp"
#include "core/workspace.hpp"
#include "measures/arcs/arcs.hpp"
#include "measures/certificate/certify.hpp"
#include "measures/measures.hpp"
#include "measures/reference_measures.hpp"
#include "measures/topology.hpp"
#include "measures/total_measures.hpp"
#include "spheres/box.hpp"
#include "spheres/kept_cell_lists.hpp"

namespace vdwmesh {
namespace {

// A factor of 2^exponent on lengths is one of 2^(2 exponent) on areas, 2^(3 exponent) on volumes.
double scaled_area(double area, int exponent) { return std::ldexp(area, 2 * exponent); }
double scaled_volume(double volume, int exponent) { return std::ldexp(volume, 3 * exponent); }

// Multiplies the lengths behind all areas and volumes by 2^exponent, and replaces balls of the
// triangulation by spheres of the set.
void unscale(UnionTopology& topology, const PowerTriangulation& triangulation) {
  const int exponent = triangulation.scale_exponent;
  for (Shell& shell : topology.shells) {
    shell = {scaled_area(shell.area, exponent), scaled_volume(shell.volume, exponent)};
  }
  topology.outer_area = scaled_area(topology.outer_area, exponent);
  topology.void_area = scaled_area(topology.void_area, exponent);
  topology.void_volume = scaled_volume(topology.void_volume, exponent);
  for (Void& v : topology.void_table) {
    v.area = scaled_area(v.area, exponent);
    v.volume = scaled_volume(v.volume, exponent);
    for (int axis = 0; axis < 3; ++axis) v.center[axis] = std::ldexp(v.center[axis], exponent);
    v.clearance = std::ldexp(v.clearance, exponent);
    for (SphereId& id : v.lining) id = triangulation.ids[id];
    std::ranges::sort(v.lining);
  }
}

// Sets the measures of all spheres but the measured ones to NaN.
void leave_measured(std::vector<SphereMeasures>& per_sphere, const MeasuredSpheres& measured) {
  if (measured.all()) return;
  constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < per_sphere.size(); ++i) {
    if (!measured.contains(static_cast<SphereId>(i))) per_sphere[i] = {kNotMeasured, kNotMeasured};
  }
}

// Method cgal. Progress has three steps, reported here; triangulate() uses the monitor only to ask
// for cancellation.
ExactUnion union_by_triangulation(const SphereSet& spheres, const MeasuredSpheres& measured,
                                  const UnionOptions& options) {
  Monitor* const monitor = options.monitor;
  constexpr std::uint64_t kSteps = 3;
  begin_stage(monitor, "exact union", kSteps);
  const PowerTriangulation triangulation =
      triangulate(spheres, monitor, std::nullopt, options.memory_limit);
  advance(monitor, 1);
  const DualComplex complex = dual_complex(triangulation, monitor);
  advance(monitor, 1);
  const std::vector<SphereMeasures> measures = inclusion_exclusion(triangulation, complex);
  UnionTopology topology = union_topology(triangulation, complex, measures);
  unscale(topology, triangulation);
  // union_topology() knows the balls of the triangulation only; all other spheres are hidden.
  topology.hidden_spheres += spheres.size() - triangulation.balls.size();
  advance(monitor, 1);

  ExactUnion result{};
  result.method = UnionMethod::cgal;
  result.per_sphere = in_order_of(spheres, triangulation, measures);
  leave_measured(result.per_sphere, measured);
  const SphereMeasures total = total_measures(result.per_sphere, measured);
  result.area = total.area;
  result.volume = total.volume;
  result.counts = {topology.components, topology.euler_characteristic, topology.hidden_spheres};
  result.topology = std::move(topology);
  if (options.certify)
    result.certificate = certify(spheres, triangulation, complex, measured, monitor);
  return result;
}

// The certificate for methods that have no triangulation.
UnionCertificate certificate_by_triangulation(const SphereSet& spheres,
                                              const MeasuredSpheres& measured, Monitor* monitor,
                                              std::uint64_t memory_limit) {
  const PowerTriangulation triangulation =
      triangulate(spheres, monitor, std::nullopt, memory_limit);
  return certify(spheres, triangulation, dual_complex(triangulation, monitor), measured, monitor);
}

// Replaces the measures of suspect spheres by those of a triangulation. The workspace still has the
// list of the balls.
void replace_by_reference(const SphereSet& spheres, Workspace& workspace, ArcMeasures& arcs) {
  if (arcs.suspect.empty()) return;
  const CellListView& list = ball_list(spheres, workspace);
  set_reference_measures(arcs.suspect, balls_near(list, spheres, arcs.suspect), arcs.per_sphere);
}

// The box of the measured balls, wider by far more than the rounding of coordinates.
Box box_of_measured(const SphereSet& spheres, const MeasuredSpheres& measured) {
  constexpr double kSlack = 1e-12;  // relative; two roundings of 2^-53 are 2.2e-16
  Box box = empty_box();
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    if (measured.contains(static_cast<SphereId>(i))) include(box, spheres[i]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double slack = kSlack * std::max(std::abs(box.lower[axis]), std::abs(box.upper[axis]));
    box.lower[axis] -= slack;
    box.upper[axis] += slack;
  }
  return box;
}

// The spheres that decide what is exposed of the measured ones, by ascending id, if they are at
// most half of all; else nothing. They are those whose bounding box meets the box of all measured
// balls: a ball that overlaps a measured one has a point in that box.
std::optional<std::vector<SphereId>> few_near(const SphereSet& spheres,
                                              const MeasuredSpheres& measured) {
  if (measured.all()) return std::nullopt;
  const Box box = box_of_measured(spheres, measured);
  std::vector<SphereId> near;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    if (meet(box, box_of(spheres[i]))) near.push_back(static_cast<SphereId>(i));
    if (2 * near.size() > spheres.size()) return std::nullopt;
  }
  return near;
}

// arc_measures() of the measured spheres, with the spheres `near` alone: a list of their cells
// costs what they cost, however many others there are. Measures do not depend on spheres that
// overlap none, nor on the order in which neighbours are found, so their bits are those of the
// whole set. Returns nothing if a sphere is suspect: the triangulation that replaces its measures
// may be rounded otherwise in a smaller set.
std::optional<std::vector<SphereMeasures>> measures_of_few(const SphereSet& spheres,
                                                           const MeasuredSpheres& measured,
                                                           const std::vector<SphereId>& near,
                                                           Monitor* monitor) {
  std::vector<Sphere> some;
  std::vector<SphereId> numbers;
  for (const SphereId id : near) {
    if (measured.contains(id)) numbers.push_back(static_cast<SphereId>(some.size()));
    some.push_back(spheres[id]);
  }
  const MeasuredSpheres chosen(some.size(), numbers);
  Workspace workspace;
  ArcMeasures arcs{};
  arc_measures(arcs, SphereSet(std::move(some)), {.measured = chosen, .monitor = monitor},
               workspace);
  if (!arcs.suspect.empty()) return std::nullopt;
  constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
  std::vector<SphereMeasures> all(spheres.size(), {kNotMeasured, kNotMeasured});
  for (const SphereId number : numbers) all[near[number]] = arcs.per_sphere[number];
  return all;
}

// Method arcs, where few spheres are measured and nothing is counted. Returns whether it is done.
bool union_of_few(ExactUnion& result, const SphereSet& spheres, const MeasuredSpheres& measured,
                  Monitor* monitor) {
  const auto near = few_near(spheres, measured);
  if (!near || near->empty()) return false;
  auto measures = measures_of_few(spheres, measured, *near, monitor);
  if (!measures) return false;
  const SphereMeasures total = total_measures(*measures, measured);
  result = {};
  result.method = UnionMethod::arcs;
  result.area = total.area;
  result.volume = total.volume;
  result.per_sphere = std::move(*measures);
  return true;
}

// Method arcs. arc_measures() reports progress as a stage of its own. To reuse the
// caller's array, result.per_sphere is swapped into `arcs` and filled there. Assigning `result`
// frees the array that it got in exchange, and the second swap puts the filled one back. The counts
// are those of the whole union, so all spheres are measured for them.
void union_by_arcs(ExactUnion& result, const SphereSet& spheres, const MeasuredSpheres& measured,
                   TopologyRequest topology, Monitor* monitor, Workspace& workspace) {
  const bool counts = topology == TopologyRequest::counts;
  if (!counts && union_of_few(result, spheres, measured, monitor)) return;
  const MeasuredSpheres all(spheres.size(), std::nullopt);
  auto& arcs = workspace.get<ArcMeasures>();
  std::swap(arcs.per_sphere, result.per_sphere);
  arc_measures(arcs, spheres,
               {.measured = counts ? all : measured,
                .topology = counts ? TopologyRequest::counts : TopologyRequest::none,
                .monitor = monitor},
               workspace);
  replace_by_reference(spheres, workspace, arcs);
  leave_measured(arcs.per_sphere, measured);
  const SphereMeasures total = total_measures(arcs.per_sphere, measured);
  result = {};
  result.method = UnionMethod::arcs;
  result.area = total.area;
  result.volume = total.volume;
  result.fallback_spheres = arcs.suspect.size();
  if (counts) {
    result.counts = counts_of(arcs.sums, arcs.connected->count());
    result.doubtful_spheres = arcs.sums.doubtful;
  }
  std::swap(arcs.per_sphere, result.per_sphere);
}

// Method both: the result of method cgal, with the sum of the arcs' measures as the check. A
// suspect sphere enters this sum with its measures from the triangulation, so it is not checked.
ExactUnion union_by_both(const SphereSet& spheres, const MeasuredSpheres& measured,
                         const UnionOptions& options, Workspace& workspace) {
  ExactUnion result = union_by_triangulation(spheres, measured, options);
  auto& arcs = workspace.get<ArcMeasures>();
  arc_measures(arcs, spheres, {.measured = measured, .monitor = options.monitor}, workspace);
  for (const SphereId id : arcs.suspect) arcs.per_sphere[id] = result.per_sphere[id];
  const SphereMeasures check = total_measures(arcs.per_sphere, measured);
  result.method = UnionMethod::both;
  result.check_area = check.area;
  result.check_volume = check.volume;
  result.fallback_spheres = arcs.suspect.size();
  return result;
}

// Throws InvalidInput for a number that is no enumerator of UnionMethod.
void measure_union(ExactUnion& result, const SphereSet& spheres, const UnionOptions& options,
                   Workspace& workspace) {
  const MeasuredSpheres measured(spheres.size(), options.measured);
  switch (method_for(options.method, options.topology)) {
    case UnionMethod::automatic:
      break;
    case UnionMethod::cgal:
      result = union_by_triangulation(spheres, measured, options);
      return;
    case UnionMethod::arcs:
      union_by_arcs(result, spheres, measured, options.topology, options.monitor, workspace);
      if (options.certify) {
        result.certificate =
            certificate_by_triangulation(spheres, measured, options.monitor, options.memory_limit);
      }
      return;
    case UnionMethod::both:
      result = union_by_both(spheres, measured, options, workspace);
      return;
  }
  throw InvalidInput("unknown method of the exact union");
}

}  // namespace

void exact_union_into(ExactUnion& result, const SphereSet& spheres, const UnionOptions& options) {
  if (spheres.empty()) throw InvalidInput("the union of an empty set of spheres is not defined");
  WorkspaceOfCall workspace(options.workspace);  // the caller's, or one for this call
  measure_union(result, spheres, options, workspace);
  // The totals and the check are tested like the measures of two spheres. A missing check counts
  // as 0.
  require_finite({{result.area, result.volume},
                  {result.check_area.value_or(0), result.check_volume.value_or(0)}});
}

ExactUnion exact_union(const SphereSet& spheres, const UnionOptions& options) {
  ExactUnion result;
  exact_union_into(result, spheres, options);
  return result;
}

}  // namespace vdwmesh

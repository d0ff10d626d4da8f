// The rules of the exact measures: which probe a surface has, which radii are those of no solvent,
// and which methods know the topology.
#include "request/measure_request.hpp"

#include "excluded/excluded_measures.hpp"
#include "request/names.hpp"

namespace vdwmesh {
namespace {

// The excluded surface has one method, which knows the whole topology or none.
void check_excluded(const MeasureRequest& r) {
  const std::string excluded = option_with(r.door, "surface", "ses");
  refuse_if(r.method.value_or(UnionMethod::automatic) != UnionMethod::automatic || r.certify,
            "{}: does not go with {}; leave one of them out",
            option_name(r.door, r.certify ? "certify" : "method"), excluded);
  refuse_if(r.topology == TopologyRequest::counts, "{}: {} knows full and off",
            refused_option(r.door, "topology", "counts"), excluded);
}

}  // namespace

double probe_of(SurfaceChoice choice, std::optional<double> given, Door door) {
  const double probe = given.value_or(choice == SurfaceChoice::vdw ? 0 : kWaterProbe);
  refuse_if(choice == SurfaceChoice::ses && !(probe > 0),
            "{}: the excluded surface needs a radius above 0",
            refused_option(door, "probe", fmt::format("{}", probe)));
  return probe;
}

std::string remark_on_probe(double probe, Door door) {
  constexpr double kSmallest = 0.5, kLargest = 5;  // Å; helium has 1.3, fullerenes 5
  if (probe == 0 || (probe >= kSmallest && probe <= kLargest)) return "";
  const bool is_in_nm = probe > 0.1 && probe < 0.3;
  return fmt::format("a probe of {:g} Å is no solvent{}; {} is water", probe,
                     is_in_nm ? ", as if in nm" : "", option_with(door, "probe", "1.4"));
}

// Arcs are quicker, and know no more of the topology than counts. A certificate needs the
// triangulation anyway.
ExactOptions settle(const MeasureRequest& r) {
  const UnionMethod asked = r.method.value_or(UnionMethod::automatic);
  const TopologyRequest wanted = r.topology.value_or(r.usual_topology);
  ExactOptions exact{.surface = surface_of(r.surface),
                     .probe = probe_of(r.surface, r.probe, r.door),
                     .method = method_for(asked, r.certify ? TopologyRequest::full : wanted),
                     .topology = wanted,
                     .certify = r.certify};
  if (exact.surface == ExactSurface::excluded) check_excluded(r);
  if (exact.method != UnionMethod::arcs) return exact;
  refuse_if(r.topology == TopologyRequest::full,
            "{}: needs the triangulation, which {} does without; choose {} or both",
            refused_option(r.door, "topology", "full"), option_with(r.door, "method", "arcs"),
            option_with(r.door, "method", "cgal"));
  exact.topology = r.topology.value_or(TopologyRequest::none);
  return exact;
}

double checked_samples(double per_area, std::string_view given, Door door) {
  constexpr double kMostSamples = 1e6;  // per Å²
  if (per_area > 0 && per_area <= kMostSamples) return per_area;
  refuse("{}: needs more than 0 and at most {} per Å²", refused_option(door, "samples", given),
         kMostSamples);
}

}  // namespace vdwmesh

// The blocks of the report that others show as well: the tables of its text, and the study.
#pragma once

#include <optional>

#include "core/errors.hpp"
#include "report/describe.hpp"
#include "report/report.hpp"

namespace vdwmesh::apps {

// A member of what may not be there.
template <class T, class Member>
std::optional<Member> of(const std::optional<T>& block, Member T::*member) {
  return block ? std::optional<Member>((*block).*member) : std::nullopt;
}

template <class A>
void describe(A& a, const ProjectionStats& level) {
  a("projected", level.projected), a("unconverged", level.unconverged);
  a("out_of_reach", level.out_of_reach);
  a("undone", level.undone), a("turned", level.turned);
  a("iterations_max", level.iterations_max), a("residual_max", level.residual_max);
}

template <class A>
void describe(A& a, const NewtonSummary& sum) {
  a("iterations_max", sum.iterations_max), a("residual_max", sum.residual_max);
  a("unconverged", sum.unconverged), a("out_of_reach", sum.out_of_reach);
  a("projected", sum.projected), a("undone", sum.undone), a("turned", sum.turned);
  a("levels", sum.levels);
}

template <class A>
void describe(A& a, const LevelReport& level) {
  a("level", level.level);
  a("vertices", level.topology.vertices), a("triangles", level.topology.triangles);
  a("area", level.measures.area), a("volume", level.measures.volume);
  a("self_intersections", level.self_intersections);
  a("min_angle_deg", level.quality.min_angle_deg);
  a("aspect_ratio", level.quality.aspect_ratio);
  a("edge_length", level.quality.edge_length);
}

template <class A>
void describe(A& a, const ExactMeshStats& stats) {
  a("arcs", stats.arcs), a("corners", stats.corners);
  a("points", stats.points), a("contacts", stats.contacts), a("joins", stats.joins);
  a("euler_difference", stats.euler_difference), a("shell_difference", stats.shell_difference);
  a("pieces", stats.pieces), a("split", stats.split);
  a("device_looks", stats.device_looks), a("left_looks", stats.left_looks);
  a("device_patches", stats.device_patches), a("left_patches", stats.left_patches);
  a("device_batches", stats.device_batches), a("returned_patches", stats.returned_patches);
  a("triangulated_balls", stats.triangulated_balls);
  a("below_floor", stats.below_floor), a("below_min_angle", stats.below_min_angle);
  a("below_min_angle_at_corners", stats.below_min_angle_at_corners),
      a("seconds", stats.arrangement_seconds);
}

template <class A>
void describe(A& a, const CgalMeasures& cgal) {
  a("closed", cgal.closed), a("valid", cgal.valid), a("shells", cgal.shells);
  a("area", cgal.area), a("volume", cgal.volume);
}

template <class A>
void describe(A& a, const PatchCount& count) {
  a("patches", count.patches), a("triangles", count.triangles), a("area", count.area);
}

template <class A>
void describe(A& a, const RemeshStats& stats) {
  a("exact_triangles", stats.exact_triangles);
  a("crease_edges", stats.crease_edges), a("corners", stats.corners);
  a("joined_features", stats.joined);
  a("below_20_degrees", stats.below_20_degrees);
  a("below_20_degrees_at_features", stats.below_20_at_features);
  a("runs", stats.runs);
  a("edge_length", stats.edge_length);
  a("farthest", stats.farthest > 0 ? std::optional(stats.farthest) : std::nullopt);
}

template <class A>
void describe(A& a, const PatchReport& patches) {
  a("contact", patches.contact), a("saddle", patches.saddle), a("concave", patches.concave);
}

template <class A>
void describe(A& a, const MeshReport& mesh) {
  const MeshTopology& topology = mesh.topology;
  a("path", mesh.path);
  a("vertices", topology.vertices), a("edges", topology.edges), a("triangles", topology.triangles);
  a("area", mesh.measures.area), a("volume", mesh.measures.volume);
  a("outer_area", mesh.measures.outer_area), a("void_area", mesh.measures.void_area);
  a("shells", topology.shells), a("components", topology.components);
  a("voids", topology.voids), a("genus", topology.genus);
  a("euler_characteristic", topology.euler_characteristic);
  a("grid_clipped", mesh.grid_clipped), a("clamped_vertices", mesh.clamped_vertices);
  a("closed", topology.closed), a("manifold", topology.manifold), a("oriented", topology.oriented);
  a("degenerate_triangles", mesh.quality.degenerate_triangles);
  a("self_intersections", mesh.self_intersections);
  a("min_angle_deg", mesh.quality.min_angle_deg);
  a("aspect_ratio", mesh.quality.aspect_ratio);
  a("edge_length", mesh.quality.edge_length);
  a("newton", mesh.projection.empty() ? std::nullopt : std::optional(summarize(mesh.projection)));
  a("levels", mesh.levels);
  a("arrangement", mesh.arrangement);
  a("patches", mesh.patches), a("remeshing", mesh.remeshing);
  a("extrapolated_area", mesh.extrapolated_area);
  a("extrapolated_volume", mesh.extrapolated_volume);
  a("cgal", mesh.cgal);
  a("notes", mesh.notes);
}

template <class A>
void describe(A& a, const Shell& shell) {
  a("area", shell.area), a("volume", shell.volume);
}

template <class A>
void describe(A& a, const Enclosure& interval) {
  a("lower", interval.lower), a("upper", interval.upper);
}

template <class A>
void describe(A& a, const UnionCertificate& certificate) {
  a("area", certificate.area), a("volume", certificate.volume);
  a("wide_spheres", certificate.wide_spheres), a("bits", certificate.bits);
}

template <class A>
void describe(A& a, const ExactUnion& exact) {
  const auto& topology = exact.topology;
  const auto& counts = exact.counts;
  using T = UnionTopology;
  using C = UnionCounts;
  a("method", exact.method);
  a("area", exact.area);
  a("outer_area", of(topology, &T::outer_area)), a("void_area", of(topology, &T::void_area));
  a("volume", exact.volume), a("void_volume", of(topology, &T::void_volume));
  a("shells", topology ? std::optional(topology->shells.size()) : std::nullopt);
  a("components", of(counts, &C::components)), a("tunnels", of(topology, &T::tunnels));
  a("voids", of(topology, &T::voids));
  a("euler_characteristic", of(counts, &C::euler_characteristic));
  a("point_contacts", of(topology, &T::point_contacts));
  a("hidden_atoms", of(counts, &C::hidden_spheres));
  a("shell_measures", of(topology, &T::shells));
  a("check_area", exact.check_area), a("check_volume", exact.check_volume);
  a("fallback_spheres", exact.fallback_spheres), a("doubtful_spheres", exact.doubtful_spheres);
  a("certificate", exact.certificate);
}

template <class A>
void describe(A& a, const ExactReport& exact) {
  using P = AreaByPolarity;
  describe(a, static_cast<const ExactUnion&>(exact));
  a("backend", exact.backend);
  a("polar_area", of(exact.by_polarity, &P::polar));
  a("apolar_area", of(exact.by_polarity, &P::apolar));
  a("unclassified_area", of(exact.by_polarity, &P::unclassified));
}

template <class A>
void describe(A& a, const ExcludedShell& shell) {
  a("area", shell.area), a("volume", shell.volume);
  a("euler_characteristic", shell.euler_characteristic), a("genus", shell.genus);
}

template <class A>
void describe(A& a, const AccessibleComponent& component) {
  a("accessible_area", component.accessible_area);
  a("accessible_volume", component.accessible_volume);
  a("is_cavity", component.is_cavity);
  a("excluded_area", component.excluded_area);
}

template <class A>
void describe(A& a, const ExcludedCounts& counts) {
  a("arcs", counts.arcs), a("whole_rings", counts.whole_rings);
  a("spindle_saddles", counts.spindle_saddles), a("cusps", counts.cusps);
  a("probes", counts.probes), a("low_probes", counts.low_probes);
  a("crowded_probes", counts.crowded_probes), a("gathered_corners", counts.gathered_corners);
  a("dropped_arcs", counts.dropped_arcs), a("crease_arcs", counts.crease_arcs);
}

template <class A>
void describe(A& a, const ExcludedSurface& s) {
  using T = ExcludedTopology;
  a("area", s.area), a("volume", s.volume);
  a("contact_area", s.area_by_kind.contact), a("saddle_area", s.area_by_kind.saddle);
  a("concave_area", s.area_by_kind.concave);
  a("contact_layer", s.layer_by_kind.contact), a("saddle_layer", s.layer_by_kind.saddle);
  a("concave_layer", s.layer_by_kind.concave);
  a("accessible_area", s.accessible_area), a("accessible_volume", s.accessible_volume);
  a("euler_characteristic", s.euler_characteristic);
  a("cavities", of(s.topology, &T::cavities));
  a("shells", of(s.topology, &T::shells)), a("components", of(s.topology, &T::components));
  a("gauss_bonnet_residual", of(s.topology, &T::gauss_bonnet_residual));
  a("counts", s.counts);
  a("closure", s.checks.closure), a("check_volume", s.checks.check_volume);
  a("extended_decisions", s.checks.extended_decisions), a("ties", s.checks.ties);
  a("uncertified_patches", s.checks.uncertified_patches);
}

template <class A>
void describe(A& a, const ExcludedMeasures& excluded) {
  a("probe", excluded.probe);
  a("complete", excluded.complete), a("exterior", excluded.exterior);
}

template <class A>
void describe(A& a, const AssumedRadius& assumed) {
  const auto unless_empty = [](const std::string& name) {
    return name.empty() ? std::nullopt : std::optional(name);
  };
  a("element", assumed.element), a("radius", assumed.radius), a("count", assumed.count);
  a("residue", unless_empty(assumed.residue_name)), a("atom", unless_empty(assumed.atom_name));
}

template <class A>
void describe(A& a, const GuessedElement& guessed) {
  a("element", guessed.element);
  a("residue", guessed.residue_name);
  a("atom", guessed.atom_name);
  a("count", guessed.count);
}

template <class A>
void describe(A& a, const InputReport& input) {
  a("path", input.path), a("format", input.format);
  a("model", input.model), a("assembly", input.assembly);
  a("atoms_read", input.atoms_read), a("atoms_used", input.atoms_used);
  a("spheres", input.spheres);
  a("measure", input.measure), a("spheres_measured", input.measured);
  a("skipped", input.skipped);
  a("radius_set", input.radius_set);
  a("probe", input.probe);
  a("radii_assumed", input.radii_assumed);
  a("elements_guessed", input.elements_guessed);
  a("unusual_elements_guessed", input.unusual_elements_guessed);
}

template <class A>
void describe(A& a, const BackendReport& backend) {
  a("requested", backend.requested), a("used", backend.used);
  a("device", backend.device), a("driver", backend.driver);
  a("reason", backend.reason);
  a("devices", backend.devices), a("threads", backend.threads);
}

template <class A>
void describe(A& a, const Complementarity& fit) {
  a("sc", fit.sc), a("error", fit.error);
  a("median_a", fit.median_a), a("median_b", fit.median_b);
  a("fitted_a", fit.fitted_a), a("fitted_b", fit.fitted_b);
  a("excluded_buried_a", fit.buried_a), a("excluded_buried_b", fit.buried_b);
  a("contact_surface_a", fit.contact_a), a("contact_surface_b", fit.contact_b);
  a("samples_per_area", fit.density);
}

template <class A>
void describe(A& a, const ExcludedBurial& excluded) {
  a("buried_area", excluded.buried_a + excluded.buried_b);
  a("buried_a", excluded.buried_a), a("buried_b", excluded.buried_b);
  a("area_a", excluded.area_a), a("area_b", excluded.area_b);
  a("area_in_pair", excluded.area_in_pair), a("gap_volume", excluded.gap_volume);
}

template <class A>
void describe(A& a, const SideReport& side) {
  a("area", side.area), a("area_in_pair", side.area_in_pair);
  a("area_in_whole", side.area_in_whole), a("buried_area", side.buried_area);
  a("atoms", side.atoms), a("residues", side.residues);
}

template <class A>
void describe(A& a, const ResidueContact& contact) {
  a("a", contact.a), a("b", contact.b), a("area", contact.area);
}

template <class A>
void describe(A& a, const InterfaceReport& interface) {
  a("a", interface.a), a("b", interface.b);
  a("buried_area", interface.buried_area);
  a("buried_a", interface.side_a.buried_area), a("buried_b", interface.side_b.buried_area);
  a("buried_polar", of(interface.buried_by_polarity, &AreaByPolarity::polar));
  a("buried_apolar", of(interface.buried_by_polarity, &AreaByPolarity::apolar));
  a("buried_unclassified", of(interface.buried_by_polarity, &AreaByPolarity::unclassified));
  a("contact_area", interface.contact_area);
  a("side_a", interface.side_a), a("side_b", interface.side_b);
  a("contacts", interface.contacts);
  a("complementarity", interface.complementarity);
  a("excluded", interface.excluded);
}

// Nothing where memory is not limited.
inline std::optional<std::uint64_t> limit_of(std::uint64_t memory_limit) {
  return memory_limit == kNoMemoryLimit ? std::nullopt : std::optional(memory_limit);
}

}  // namespace vdwmesh::apps

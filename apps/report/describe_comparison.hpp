// The blocks of a report that hold a mesh against the exact surface.
#pragma once

#include "report/describe_report.hpp"

namespace vdwmesh::apps {

template <class A>
void describe(A& a, const AtomErrors& errors) {
  a("max", errors.max), a("rms", errors.rms);
  a("atoms", errors.atoms), a("worst", errors.worst);
}

template <class A>
void describe(A& a, const MeshProof& proof) {
  a("topology_is_exact", proof.topology_is_exact);
  a("atom_area_error", proof.atoms), a("below_floor", proof.below_floor);
  a("extrapolated_area_error", proof.extrapolated_area_error);
  a("extrapolated_volume_error", proof.extrapolated_volume_error);
}

template <class A>
void describe_errors(A& a, const Comparison& comparison) {
  a("area_relative_error", comparison.area_relative_error);
  a("volume_relative_error", comparison.volume_relative_error);
  a("euler_characteristic_difference", comparison.euler_characteristic_difference);
}

// Distances may be left out while the rest is there, so each of their members is null by itself.
template <class A>
void describe_distances(A& a, const std::optional<MeshDistances>& distances) {
  using D = MeshDistances;
  a("mesh_to_surface", of(distances, &D::mesh_to_surface));
  a("surface_to_mesh", of(distances, &D::surface_to_mesh));
  a("hausdorff_lower_bound", of(distances, &D::hausdorff_lower_bound));
  a("samples", of(distances, &D::samples)), a("seed", of(distances, &D::seed));
}

template <class A>
void describe(A& a, const Comparison& comparison) {
  describe_errors(a, comparison);
  describe_distances(a, comparison.distances);
}

template <class A>
void describe(A& a, const DistanceBounds& bounds) {
  a("lower", bounds.lower), a("upper", bounds.upper);
}

template <class A>
void describe(A& a, const HausdorffBounds& bounds) {
  a("mesh_to_surface", bounds.mesh_to_surface), a("surface_to_mesh", bounds.surface_to_mesh);
  a("points", bounds.points);
}

template <class A>
void describe(A& a, const ComparisonReport& comparison) {
  const auto& distances = comparison.distances;
  a("surface", comparison.surface);
  describe_errors(a, comparison);
  a("proof", comparison.proof);
  a("exterior", comparison.exterior);
  describe_distances(a, distances);
  a("bounds", comparison.bounds);
  a("distances_backend", distances ? std::optional(comparison.distances_backend) : std::nullopt);
  a("distances_reason", comparison.distances_reason);
}

}  // namespace vdwmesh::apps

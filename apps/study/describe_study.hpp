// The records of a study, described: what is known of a run and of a series of runs. Finished runs
// are kept and read back by the same description that prints them.
#pragma once

#include "analysis/study.hpp"
#include "report/describe.hpp"

namespace vdwmesh::apps {

template <class A, Of<MeshDistances> T>
void describe(A& a, T& d) {
  a("mesh_to_surface", d.mesh_to_surface), a("surface_to_mesh", d.surface_to_mesh);
  a("hausdorff_lower_bound", d.hausdorff_lower_bound), a("samples", d.samples), a("seed", d.seed);
}

template <class A, Of<MeshTopology> T>
void describe(A& a, T& t) {
  a("vertices", t.vertices), a("edges", t.edges), a("triangles", t.triangles);
  a("isolated_vertices", t.isolated_vertices), a("shells", t.shells);
  a("components", t.components), a("voids", t.voids), a("genus", t.genus);
  a("euler_characteristic", t.euler_characteristic);
  a("closed", t.closed), a("manifold", t.manifold), a("oriented", t.oriented);
}

template <class A, Of<MeshMeasures> T>
void describe(A& a, T& m) {
  a("area", m.area), a("volume", m.volume);
  a("outer_area", m.outer_area), a("void_area", m.void_area);
}

template <class A, Of<MeshQuality> T>
void describe(A& a, T& q) {
  a("min_angle_deg", q.min_angle_deg), a("aspect_ratio", q.aspect_ratio);
  a("edge_length", q.edge_length), a("degenerate_triangles", q.degenerate_triangles);
}

template <class A, Of<Histogram> T>
void describe(A& a, T& h) {
  a("scale", h.scale), a("lower", h.lower), a("upper", h.upper);
  a("below", h.below), a("above", h.above), a("counts", h.counts);
}

template <class A, Of<QualityHistograms> T>
void describe(A& a, T& h) {
  a("min_angle_deg", h.min_angle_deg), a("aspect_ratio", h.aspect_ratio);
  a("edge_length", h.edge_length);
}

template <class A, Of<StudySeconds> T>
void describe(A& a, T& s) {
  a("field", s.field), a("extract", s.extract), a("refine", s.refine), a("mesh", s.mesh);
  a("distances", s.distances);
}

template <class A, Of<StudyMemory> T>
void describe(A& a, T& m) {
  a("mesh", m.mesh), a("peak", m.peak);
}

template <class A, Of<StudyKey> T>
void describe(A& a, T& k) {
  a("mesher", k.mesher), a("field", k.field), a("project", k.projection);
  a("subdivide", k.subdivisions), a("backend", k.backend);
}

template <class A, Of<StudySetting> T>
void describe(A& a, T& s) {
  describe(a, s.key);
  a("resolution", s.resolution);
}

template <class A, Of<PowerLaw> T>
void describe(A& a, T& p) {
  a("order", p.order), a("scale", p.scale);
  a("rms_residual", p.rms_residual), a("points", p.points);
}

template <class A, Of<Extrapolation> T>
void describe(A& a, T& e) {
  a("limit", e.limit), a("order", e.order);
}

template <class A, Of<StudyOrders> T>
void describe(A& a, T& o) {
  a("area_error", o.area_error), a("volume_error", o.volume_error);
  a("mesh_to_surface_rms", o.mesh_to_surface_rms);
  a("surface_to_mesh_rms", o.surface_to_mesh_rms), a("hausdorff", o.hausdorff);
}

// Topology, measures and quality in one block, as in the report.
template <class Run>
struct MeshBlock {
  Run& run;
};
template <class A, class Run>
void describe(A& a, const MeshBlock<Run>& block) {
  Run& run = block.run;
  describe(a, run.topology), describe(a, run.measures), describe(a, run.quality);
  a("self_intersections", run.self_intersections);
}

// Unlike that of the report, it has the distances in a block of their own.
template <class Run>
struct ComparisonBlock {
  Run& run;
};
template <class A, class Run>
void describe(A& a, const ComparisonBlock<Run>& block) {
  auto& c = block.run.comparison;
  a("area_relative_error", c.area_relative_error);
  a("volume_relative_error", c.volume_relative_error);
  a("euler_characteristic_difference", c.euler_characteristic_difference);
  a("distances", c.distances);
}

template <class A, Of<StudyRun> T>
void describe(A& a, T& run) {
  MeshBlock<T> mesh{run};
  ComparisonBlock<T> comparison{run};
  a("parameters", run.setting);
  a("mesh", mesh);
  a("histograms", run.histograms), a("comparison", comparison);
  a("timing", run.seconds), a("memory", run.memory);
}

template <class A>
void describe(A& a, const StudySeries& series) {
  describe(a, series.key);
  a("runs", series.runs);
  a("by_resolution", series.by_resolution), a("by_triangles", series.by_triangles);
  a("area_extrapolated", series.area), a("volume_extrapolated", series.volume);
}

}  // namespace vdwmesh::apps

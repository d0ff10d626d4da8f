// The steps of quality(), for callers that survey the edges of the mesh at the same time, or that
// have only a part of it.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "analysis/survey/mesh_part.hpp"

namespace vdwmesh {

// The smallest angles and aspect ratios of some triangles.
struct TriangleShapes {
  std::span<const double> min_angles_deg;  // one per triangle, 0 for degenerate triangles
  std::span<const double> aspect_ratios;   // of the triangles with an area above 0 only
};

// Calls visit(first, shapes) for blocks of own triangles, of which `first` is the first one's
// index, from any number of threads. The shapes are valid during the call.
void visit_shapes(
    const MeshPart& part,
    const std::function<void(std::size_t first, const TriangleShapes& shapes)>& visit);

// All values of fewer triangles are kept, which is less work than a sample.
inline constexpr std::size_t kFewTriangles = std::size_t{1} << 16;

// Values of every step-th own triangle: in all much like a random sample of the part's values.
// Empty for a part of few triangles, so that all of their values are kept.
struct QualitySample {
  std::vector<double> min_angles_deg, aspect_ratios, edge_lengths;
};
QualitySample sample_quality(const MeshPart& part, std::size_t step);
// The step that makes a sample large enough to expect percentiles in narrow brackets. It is odd,
// because the triangles of a divided mesh come in fours that are alike.
std::size_t usual_sample_step(std::uint64_t triangles);

// Fills all members of MeshQuality but the edge lengths.
MeshQuality quality_of_triangles(const IndexedMesh& mesh, QualitySample sample);

}  // namespace vdwmesh

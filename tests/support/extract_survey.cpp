#include "support/extract_survey.hpp"

#include "core/errors.hpp"
#include "reference/mesh_checks.hpp"
#include "support/plain_extractor.hpp"
#include "support/reference_mesh.hpp"

namespace vdwmesh::testing {
namespace {

// Nodes times spheres up to which nothing is left out: about ten milliseconds.
constexpr double kPlainWork = 2e6;

std::string unsound(const ExtractSet& set, const IndexedMesh& mesh) {
  const reference::MeshFacts facts = reference::inspect(to_reference(mesh));
  const std::uint64_t shells = facts.positive_shells + facts.negative_shells;
  if (set.separated > 0 && (shells != set.separated || facts.negative_shells > 0)) {
    return std::to_string(set.separated) + " balls apart: " + facts.summary();
  }
  // Balls smaller than the grid may pass between its nodes.
  if (mesh.triangles.empty() && mesh.positions.empty()) return "";
  if (!facts.closed_oriented_manifold()) return "not closed: " + facts.summary();
  if (facts.degenerate_triangles > 0) return "degenerate: " + facts.summary();
  return "";
}

std::string difference(const ExtractResult& a, const ExtractResult& b) {
  if (!(hash(a.mesh) == hash(b.mesh))) {
    return std::to_string(a.mesh.triangle_count()) + " triangles, " +
           std::to_string(b.mesh.triangle_count()) + " there";
  }
  if (a.stats.surface_bricks != b.stats.surface_bricks ||
      a.stats.clamped_vertices != b.stats.clamped_vertices ||
      a.stats.grid_clipped != b.stats.grid_clipped) {
    return "other counts of bricks, clamped vertices or clipped cells";
  }
  return "";
}

std::string prefixed(const char* what, const std::string& complaint) {
  return complaint.empty() ? "" : what + complaint;
}

std::string examine(const ExtractSet& set, Backend backend, SurveyCounts& counts) {
  const ExtractResult result = make_extractor(backend)->extract(set.spheres, set.options);
  ++counts.sets;
  counts.triangles += result.mesh.triangle_count();
  counts.separated += set.separated > 0 ? 1 : 0;
  if (backend == Backend::cuda) {
    const ExtractResult cpu = make_extractor(Backend::cpu)->extract(set.spheres, set.options);
    return prefixed("not as on the CPU: ", difference(result, cpu));
  }
  std::string wrong = unsound(set, result.mesh);
  if (!wrong.empty()) return wrong;
  wrong = difference(result, extract_all_bricks(set.spheres, set.options));
  if (!wrong.empty()) return "not as of all bricks: " + wrong;
  const auto nodes = static_cast<double>(result.grid.node_count());
  if (nodes * static_cast<double>(set.spheres.size()) > kPlainWork) return "";
  ++counts.plain;
  return prefixed("not as without shortcuts: ",
                  difference(result, extract_plainly(set.spheres, set.options)));
}

}  // namespace

std::string complaint(const ExtractSet& set, Backend backend, SurveyCounts& counts) {
  try {
    return examine(set, backend, counts);
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace vdwmesh::testing

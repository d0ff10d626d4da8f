// The Refiner on the CPU: checks and prepares the mesh (preparation.hpp), projects the given
// vertices, subdivides and projects level by level (level.hpp), and computes the normals at the
// end. The time that the caller's observer takes is not counted.
#include <chrono>
#include <utility>

#include "core/blocks.hpp"
#include "core/monitor.hpp"
#include "core/workspace.hpp"
#include "refine/crossings/constraint_formulas.hpp"
#include "refine/crossings/preparation.hpp"
#include "refine/level.hpp"
#include "refine/refiner.hpp"

namespace vdwmesh {
namespace {

// Computes the normals of all vertices from the target surface or, if triangles are labelled, from
// the spheres of the vertex labels. Without projection the mesh keeps the normals that the levels
// have interpolated, if any.
void compute_normals(const SphereSet& spheres, const SurfaceView& surface, IndexedMesh& mesh) {
  if (surface.projection == Projection::none) return;
  const bool constrained = mesh.triangle_labels() == TriangleLabels::spheres;
  mesh.normals.resize(mesh.vertex_count());
  for_all(mesh.vertex_count(), [&](std::size_t v) {
    const Vec3d& p = mesh.positions[v];
    const VertexSpheres label = mesh.vertex_spheres[v];
    mesh.normals[v] = constrained ? constrained_normal(spheres.spheres().data(), label.data(), p)
                                  : surface.normal(p, label.data());
  });
}

// Of the mesh that subdivision `level` makes of `parent`. A further one needs half-edges.
Connectivity connectivity_of(int level, const IndexedMesh& parent, const RefineOptions& options) {
  const bool is_last = level == options.subdivisions;
  return is_last && 4 * parent.triangle_count() > options.half_edges_up_to
             ? Connectivity::triangles
             : Connectivity::half_edges;
}

class CpuRefiner final : public Refiner {
 public:
  RefineResult refine(const SphereSet& spheres, IndexedMesh&& mesh,
                      const RefineOptions& options) const override {
    const auto begin = std::chrono::steady_clock::now();
    check_refinement(spheres, mesh, options);
    begin_stage(options.monitor, "refine", static_cast<std::uint64_t>(options.subdivisions) + 1);
    WorkspaceOfCall workspace(options.workspace);
    const SurfaceView surface = target_surface(spheres, options, mesh.triangle_labels(), workspace);
    RefineResult result;
    result.mesh = prepare_mesh(std::move(mesh), options);
    std::chrono::steady_clock::duration observed{};
    const auto observe = [&](int level) {
      if (!options.on_level) return;
      const auto start = std::chrono::steady_clock::now();
      options.on_level(level, result.mesh);
      observed += std::chrono::steady_clock::now() - start;
    };
    observe(0);
    result.levels.push_back(project_given(spheres, surface, result.mesh, options));
    advance(options.monitor, 1);
    for (int l = 1; l <= options.subdivisions; ++l) {
      const ParentOrigin origin = l == 1 ? ParentOrigin::given : ParentOrigin::subdivided;
      SubdividedMesh next = subdivide(spheres, surface, result.mesh, origin,
                                      connectivity_of(l, result.mesh, options), options);
      result.mesh = std::move(next.mesh);
      result.levels.push_back(next.stats);
      observe(l);
      advance(options.monitor, 1);
    }
    if (options.normals == Normals::gradients) compute_normals(spheres, surface, result.mesh);
    const auto end = std::chrono::steady_clock::now();
    result.seconds = std::chrono::duration<double>(end - begin - observed).count();
    return result;
  }
};

}  // namespace

RefineResult Refiner::refine(const SphereSet& spheres, const IndexedMesh& mesh,
                             const RefineOptions& options) const {
  check_refinement_size(spheres.size(), mesh.vertex_count(), mesh.triangle_count(), options,
                        mesh.triangle_labels());
  return refine(spheres, IndexedMesh(mesh), options);
}

std::unique_ptr<Refiner> make_cpu_refiner() { return std::make_unique<CpuRefiner>(); }

}  // namespace vdwmesh

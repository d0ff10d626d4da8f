// Half-edge mesh, measures and mesh files: triangles and bytes per second on one core, beside the
// floor (OpenMesh's own resize) and OpenMesh's add_face. One torus of 4 million triangles, whose
// vertices and triangles follow each other as those of marching cubes do.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <vector>

#include "analysis/mesh_measures.hpp"
#include "mesh/mesh_io.hpp"
#include "mesh/surface_mesh.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

const IndexedMesh& bare_mesh() {
  static const IndexedMesh mesh = [] {
    IndexedMesh made = testing::torus(2000, 1000);
    made.normals.resize(made.vertex_count());
    made.vertex_spheres.resize(made.vertex_count(), LabelWidth::one);
    for (std::size_t v = 0; v < made.vertex_count(); ++v) {
      const Vec3d& p = made.positions[v];
      made.normals[v] = cast<float>((1 / norm(p)) * p);
      made.vertex_spheres.atoms[v] = static_cast<SphereId>(v / 1000);
    }
    return made;
  }();
  return mesh;
}

const IndexedMesh& mesh_with_opposites() {
  static const IndexedMesh mesh = [] {
    IndexedMesh made = bare_mesh();
    made.opposite = opposite_half_edges(made.triangles, made.vertex_count());
    return made;
  }();
  return mesh;
}

// Every figure is per core: one thread throughout.
class OneThread {
  tbb::global_control control_{tbb::global_control::max_allowed_parallelism, 1};
};

void count_triangles(benchmark::State& state) {
  state.SetItemsProcessed(state.iterations() *
                          static_cast<std::int64_t>(bare_mesh().triangle_count()));
}

void resize_only(benchmark::State& state) {
  const IndexedMesh& mesh = bare_mesh();
  for (auto _ : state) {
    SurfaceMesh result;
    VertexSpheresProperty spheres;
    result.add_property(spheres, kVertexSpheresName);
    result.resize(mesh.vertex_count(), 3 * mesh.triangle_count() / 2, mesh.triangle_count());
    benchmark::DoNotOptimize(result.n_faces());
  }
  count_triangles(state);
}

void build_with_add_face(benchmark::State& state) {
  const IndexedMesh& mesh = bare_mesh();
  for (auto _ : state) {
    SurfaceMesh result;
    result.reserve(mesh.vertex_count(), 3 * mesh.triangle_count() / 2, mesh.triangle_count());
    for (const Vec3d& p : mesh.positions) result.add_vertex({p.x, p.y, p.z});
    const auto handle = [](std::uint32_t v) { return OpenMesh::VertexHandle(static_cast<int>(v)); };
    for (const auto& [a, b, c] : mesh.triangles) result.add_face(handle(a), handle(b), handle(c));
    benchmark::DoNotOptimize(result.n_faces());
  }
  count_triangles(state);
}

template <const IndexedMesh& (*Source)()>
void build(benchmark::State& state) {
  const IndexedMesh& mesh = Source();
  const OneThread one;
  for (auto _ : state) benchmark::DoNotOptimize(to_surface_mesh(mesh).n_faces());
  count_triangles(state);
}

void opposites(benchmark::State& state) {
  const IndexedMesh& mesh = bare_mesh();
  const OneThread one;
  for (auto _ : state)
    benchmark::DoNotOptimize(opposite_half_edges(mesh.triangles, mesh.vertex_count()).data());
  count_triangles(state);
}

void summary(benchmark::State& state) {
  const OneThread one;
  for (auto _ : state) benchmark::DoNotOptimize(summarize(bare_mesh()));
  count_triangles(state);
}

void quality_of_triangles(benchmark::State& state) {
  const OneThread one;
  for (auto _ : state) benchmark::DoNotOptimize(quality(bare_mesh()));
  count_triangles(state);
}

void self_intersections_of_triangles(benchmark::State& state) {
  const IndexedMesh mesh = testing::torus(500, 400);
  const OneThread one;
  for (auto _ : state) benchmark::DoNotOptimize(self_intersections(mesh));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(mesh.triangle_count()));
}

const SurfaceMesh& surface_mesh() {
  static const SurfaceMesh mesh = to_surface_mesh(mesh_with_opposites());
  return mesh;
}

void write_file(benchmark::State& state, MeshFormat format) {
  const SurfaceMesh& mesh = surface_mesh();
  const OneThread one;
  std::int64_t bytes = 0;
  for (auto _ : state) bytes += static_cast<std::int64_t>(encode_mesh(mesh, format).bytes.size());
  state.SetBytesProcessed(bytes);
}

void read_file(benchmark::State& state, MeshFormat format) {
  const OneThread one;
  const std::string bytes = encode_mesh(surface_mesh(), format).bytes;
  for (auto _ : state) benchmark::DoNotOptimize(decode_mesh(bytes, format).mesh.triangles.data());
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes.size()));
}

BENCHMARK(resize_only)->Unit(benchmark::kMillisecond);
BENCHMARK(build<mesh_with_opposites>)->Name("build_from_opposites")->Unit(benchmark::kMillisecond);
BENCHMARK(build<bare_mesh>)->Name("build_from_indices")->Unit(benchmark::kMillisecond);
BENCHMARK(opposites)->Unit(benchmark::kMillisecond);
BENCHMARK(build_with_add_face)->Unit(benchmark::kMillisecond);
BENCHMARK(summary)->Unit(benchmark::kMillisecond);
BENCHMARK(quality_of_triangles)->Unit(benchmark::kMillisecond);
BENCHMARK(self_intersections_of_triangles)->Unit(benchmark::kMillisecond);

#define VDWMESH_BENCHMARK_FORMAT(format)                                                    \
  BENCHMARK_CAPTURE(write_file, format, MeshFormat::format)->Unit(benchmark::kMillisecond); \
  BENCHMARK_CAPTURE(read_file, format, MeshFormat::format)->Unit(benchmark::kMillisecond)
VDWMESH_BENCHMARK_FORMAT(ply);
VDWMESH_BENCHMARK_FORMAT(stl);
VDWMESH_BENCHMARK_FORMAT(obj);
VDWMESH_BENCHMARK_FORMAT(off);
VDWMESH_BENCHMARK_FORMAT(glb);

}  // namespace
}  // namespace vdwmesh

BENCHMARK_MAIN();

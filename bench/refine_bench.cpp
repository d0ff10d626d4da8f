// Subdivision and projection of ubiquitin's marching-cubes mesh (0.5 Å), and of a mesh of two balls
// whose triangles name their spheres: million triangles made per CPU second, so per core, which
// should not depend on the level.
//
//   refine_bench [Google Benchmark options]
#include <benchmark/benchmark.h>

#include <utility>
#include <vector>

#include "extract/extractor.hpp"
#include "refine/refiner.hpp"
#include "structure/reader.hpp"
#include "support/crease_meshes.hpp"

namespace vdwmesh {
namespace {

SphereSet ubiquitin() {
  std::vector<Sphere> balls;
  for (const Atom& atom : read_sample("ubiquitin").atoms) {
    balls.push_back({atom.position, atom.radius});
  }
  return SphereSet(std::move(balls));
}

void run(benchmark::State& state, const SphereSet& spheres, const IndexedMesh& mesh,
         RefineOptions options) {
  options.subdivisions = static_cast<int>(state.range(0));
  double triangles = 0;
  for (auto _ : state) {
    const RefineResult result = make_cpu_refiner()->refine(spheres, mesh, options);
    triangles = static_cast<double>(result.mesh.triangle_count());
  }
  state.counters["Mtriangles"] = triangles * 1e-6;
  // A rate is per CPU second of the whole process.
  state.counters["Mtriangles/s/core"] =
      benchmark::Counter(triangles * 1e-6, benchmark::Counter::kIsIterationInvariantRate);
}

void refine(benchmark::State& state, FieldKind kind, Projection projection) {
  const SphereSet spheres = ubiquitin();
  ExtractOptions extract;
  extract.field.kind = kind;
  extract.connectivity = Connectivity::half_edges;
  const ExtractResult extracted = make_cpu_extractor()->extract(spheres, extract);
  RefineOptions options;
  options.projection = projection;
  options.field.kind = kind;
  options.grid = extracted.grid;
  run(state, spheres, extracted.mesh, options);
}

// 80,000 triangles, half-edges given.
void refine_constrained(benchmark::State& state, Projection projection) {
  const testing::CreaseMesh coarse =
      testing::two_balls_mesh({{0, 0, 0}, 17}, {{12, 9, 5}, 14}, 100, 50);
  RefineOptions options;
  options.subdivisions = 1;
  const IndexedMesh mesh = make_cpu_refiner()->refine(coarse.spheres, coarse.mesh, options).mesh;
  options.projection = projection;
  run(state, coarse.spheres, mesh, options);
}

#define VDWMESH_REFINE_BENCHMARK(name, kind, projection)                   \
  BENCHMARK_CAPTURE(refine, name, FieldKind::kind, Projection::projection) \
      ->DenseRange(1, 3)                                                   \
      ->MeasureProcessCPUTime()                                            \
      ->Unit(benchmark::kMillisecond)

VDWMESH_REFINE_BENCHMARK(subdivision_only, vdw, none);
VDWMESH_REFINE_BENCHMARK(vdw, vdw, vdw);
VDWMESH_REFINE_BENCHMARK(blinn, blinn, field);
VDWMESH_REFINE_BENCHMARK(soft_object, soft_object, field);
VDWMESH_REFINE_BENCHMARK(inverse_squared, inverse_squared, field);
BENCHMARK_CAPTURE(refine_constrained, spheres_and_circles, Projection::vdw)
    ->DenseRange(1, 3)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace vdwmesh

BENCHMARK_MAIN();

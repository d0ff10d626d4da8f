// Subdivision and projection of ubiquitin's marching-cubes mesh (0.5 Å): million triangles made per
// CPU second, so per core, which should not depend on the level.
//
//   refine_bench [Google Benchmark options]
#include <benchmark/benchmark.h>

#include <utility>
#include <vector>

#include "extract/extractor.hpp"
#include "refine/refiner.hpp"
#include "structure/reader.hpp"

namespace vdwmesh {
namespace {

SphereSet ubiquitin() {
  std::vector<Sphere> balls;
  for (const Atom& atom : read_sample("ubiquitin").atoms) {
    balls.push_back({atom.position, atom.radius});
  }
  return SphereSet(std::move(balls));
}

void refine(benchmark::State& state, FieldKind kind, Projection projection) {
  const SphereSet spheres = ubiquitin();
  ExtractOptions extract;
  extract.field.kind = kind;
  extract.connectivity = Connectivity::half_edges;
  const ExtractResult extracted = make_cpu_extractor()->extract(spheres, extract);
  RefineOptions options;
  options.subdivisions = static_cast<int>(state.range(0));
  options.projection = projection;
  options.field.kind = kind;
  options.grid = extracted.grid;
  double triangles = 0;
  for (auto _ : state) {
    const RefineResult result = make_cpu_refiner()->refine(spheres, extracted.mesh, options);
    triangles = static_cast<double>(result.mesh.triangle_count());
  }
  state.counters["Mtriangles"] = triangles * 1e-6;
  // A rate is per CPU second of the whole process.
  state.counters["Mtriangles/s/core"] =
      benchmark::Counter(triangles * 1e-6, benchmark::Counter::kIsIterationInvariantRate);
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

}  // namespace
}  // namespace vdwmesh

BENCHMARK_MAIN();

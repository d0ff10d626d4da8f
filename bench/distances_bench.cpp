// Times the distances between a mesh and the exact surface on both backends, stage by stage, and
// says whether their figures are the same bits.
//
//   distances_bench FILE.xyzr[.gz] [SPACING [SUBDIVISIONS [RUNS]]]     default 0.5 Å, none, 5
#include <fmt/format.h>
#include <tbb/info.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "core/monitor.hpp"
#include "cuda/backend.hpp"
#include "support/xyzr.hpp"

namespace {

using namespace vdwmesh;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Notes when stages begin. What is done before the first one is the stage "begin".
class StageTimes final : public Monitor {
 public:
  StageTimes() { begins_.emplace_back("begin", now()); }
  void begin_stage(std::string_view name, std::uint64_t) override {
    begins_.emplace_back(name, now());
  }
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return false; }
  std::string text() {
    std::string all;
    const double end = now();
    for (std::size_t i = 0; i < begins_.size(); ++i) {
      const double next = i + 1 < begins_.size() ? begins_[i + 1].second : end;
      all += fmt::format("  {} {:.4f}", begins_[i].first, next - begins_[i].second);
    }
    return all;
  }

 private:
  std::vector<std::pair<std::string, double>> begins_;
};

MeshDistances time_backend(Backend backend, const IndexedMesh& mesh, const SphereSet& spheres,
                           int runs) {
  const auto measurer = make_distance_measurer(backend);
  double least = 1e9;
  std::string stages;
  MeshDistances result{};
  for (int run = 0; run < runs; ++run) {
    StageTimes times;
    const double start = now();
    result = measurer->measure(mesh, spheres, {.monitor = &times}).result;
    const double seconds = now() - start;
    if (seconds < least) stages = times.text();
    least = std::min(least, seconds);
  }
  fmt::print("{:<5}{:.4f} s, {:.1f} million samples a second\n      {}\n",
             backend == Backend::cpu ? "cpu" : "cuda", least,
             1e-6 * static_cast<double>(result.samples) / least, stages);
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "distances_bench FILE.xyzr[.gz] [SPACING [SUBDIVISIONS [RUNS]]]\n");
    return 1;
  }
  const SphereSet spheres = vdwmesh::testing::read_xyzr(argv[1]);
  ExtractOptions extract;
  extract.grid.spacing = argc > 2 ? std::atof(argv[2]) : 0.5;
  extract.connectivity = Connectivity::half_edges;
  RefineOptions refine;
  refine.subdivisions = argc > 3 ? std::atoi(argv[3]) : 0;
  const int runs = argc > 4 ? std::atoi(argv[4]) : 5;
  const IndexedMesh mesh = make_pipeline(Backend::automatic)->run(spheres, extract, refine).mesh;
  fmt::print("{}: {} balls, {} triangles; {} threads\n", argv[1], spheres.size(),
             mesh.triangle_count(), tbb::info::default_concurrency());
  const MeshDistances cpu = time_backend(Backend::cpu, mesh, spheres, runs);
  if (cuda_devices().devices.empty()) return 0;
  const MeshDistances cuda = time_backend(Backend::cuda, mesh, spheres, runs);
  const bool same = std::memcmp(&cpu, &cuda, sizeof cpu) == 0;
  fmt::print("{} samples; {}\n", cpu.samples, same ? "the same bits" : "OTHER BITS");
  return same ? 0 : 1;
}

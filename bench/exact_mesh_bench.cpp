// Speed of the crease-exact mesher, and CGAL's Union_of_balls_3 beside it.
//
//   exact_mesh_bench [--edge-length H]... [--threads N]... [--backend cpu|cuda|device]...
//   [--levels L] [--rounds] [--cgal] STRUCTURE...
//
// A line per structure, edge length and number of threads: wall and CPU seconds (the least of three
// runs), triangles per CPU second, the arrangement's part, and the growth of the peak memory. With
// CUDA also the patches that the device meshed and that it left to the host, the boundaries that it
// looked at and that it left, and whether the mesh has the bits of the backend before it in the
// list. `device` is the CUDA backend with balls and mesh in the device's memory
// (exact_mesh_on_device()). --levels refines the mesh as well.
// --rounds says how long each round of meshing took, --cgal meshes the first structure with CGAL
// and one subdivision as well.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polyhedron_3.h>
#include <CGAL/Union_of_balls_3.h>
#include <CGAL/mesh_union_of_balls_3.h>
#include <CGAL/subdivide_union_of_balls_mesh_3.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <iterator>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "creases/exact_mesher.hpp"
#include "cuda/backend.hpp"
#include "cuda/on_device.hpp"
#include "structure/reader.hpp"

namespace vdwmesh {
namespace {

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

double peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

struct Seconds {
  double wall, cpu;
};

template <class Work>
Seconds timed(const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  const double cpu = cpu_seconds();
  work();
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
          cpu_seconds() - cpu};
}

// Says for each round of meshing how many patches it had, how long they took, and how long what
// came after them did: the splits of the round, or the assembly of the mesh.
class RoundClock final : public Monitor {
 public:
  void begin_stage(std::string_view name, std::uint64_t steps) override {
    rounds_.emplace_back(std::string(name), steps, seconds(), seconds());
  }
  void advance(std::uint64_t) override {
    if (!rounds_.empty()) rounds_.back().last = seconds();
  }
  bool cancelled() const override { return false; }

  void print() const {
    const double end = seconds();
    fmt::print("{:>24} {:.3f}\n", "before the rounds",
               rounds_.empty() ? end : rounds_.front().begin);
    for (auto r = rounds_.begin(); r != rounds_.end(); ++r) {
      const double next = std::next(r) == rounds_.end() ? end : std::next(r)->begin;
      fmt::print("{:>24} {:.3f} and {:.3f} after: {} patches\n", r->name, r->last - r->begin,
                 next - r->last, r->patches);
    }
  }

 private:
  struct Round {
    std::string name;
    std::uint64_t patches;
    double begin;
    std::atomic<double> last;
    Round(std::string n, std::uint64_t p, double b, double l)
        : name(std::move(n)), patches(p), begin(b), last(l) {}
  };
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::list<Round> rounds_;
};

SphereSet read(const std::string& path) {
  std::vector<Sphere> spheres;
  for (const Atom& atom : read_structure(path).atoms)
    spheres.push_back({atom.position, atom.radius});
  return SphereSet(std::move(spheres));
}

// Meshes and refines the spheres, each time by the same way.
class Mesher {
 public:
  Mesher(const std::string& backend, const SphereSet& spheres, int levels) : spheres_(spheres) {
    refine_.subdivisions = levels;
    const Backend chosen = backend == "cpu" ? Backend::cpu : Backend::cuda;
    mesher_ = make_exact_mesher(chosen);
    refiner_ = make_refiner(chosen);
    if (backend == "device") balls_.emplace(spheres);
  }

  void mesh(const ExactMeshOptions& options) {
    if (balls_) {
      there_.reset();  // as whoever has one mesh after the other
      there_.emplace(exact_mesh_on_device(*balls_, options, refine_));
      return;
    }
    made_ = {};
    made_ = mesher_->mesh(spheres_, options);
    if (refine_.subdivisions == 0) return;
    made_.mesh = std::move(refiner_->refine(spheres_, std::move(made_.mesh), refine_).mesh);
  }
  const ExactMeshStats& stats() const { return there_ ? there_->stats : made_.stats; }
  // Of the mesh made last, on the host, without half-edges.
  IndexedMesh take() {
    IndexedMesh mesh = there_ ? there_->mesh.download() : std::move(made_.mesh);
    mesh.opposite = {};
    return mesh;
  }

 private:
  const SphereSet& spheres_;
  RefineOptions refine_;
  std::unique_ptr<ExactMesher> mesher_;
  std::unique_ptr<Refiner> refiner_;
  ExactMesh made_;
  std::optional<DeviceFrames> balls_;
  std::optional<CudaExactMesh> there_;
};

struct How {
  double edge_length;
  int threads, levels;
  std::string backend;
  bool with_rounds;
};

IndexedMeshHash run(const std::string& path, const SphereSet& spheres, const How& how) {
  constexpr int kRuns = 3;
  Mesher mesher(how.backend, spheres, how.levels);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(how.threads));
  Seconds best{1e300, 1e300};
  double arrangement = 1e300;
  const double before = peak_bytes();
  for (int i = 0; i < kRuns; ++i) {
    RoundClock clock;
    ExactMeshOptions options{.edge_length = how.edge_length};
    if (how.with_rounds) options.monitor = &clock;
    const Seconds seconds = timed([&] { mesher.mesh(options); });
    if (how.with_rounds && i + 1 == kRuns) clock.print();
    arrangement = std::min(arrangement, mesher.stats().arrangement_seconds);
    best = {std::min(best.wall, seconds.wall), std::min(best.cpu, seconds.cpu)};
  }
  const double peak = peak_bytes();
  const IndexedMesh mesh = mesher.take();
  const auto triangles = static_cast<double>(mesh.triangle_count());
  fmt::print("{:<12} {:>5} {:>3} {:>10.0f} {:>8.3f} {:>8.3f} {:>10.0f} {:>10.1f} {:>8.1f}",
             path.substr(path.find_last_of('/') + 1), how.edge_length, how.threads, triangles,
             best.wall, best.cpu, triangles / best.cpu, 100 * arrangement / best.wall,
             (peak - before) / triangles);
  const ExactMeshStats& stats = mesher.stats();
  if (how.backend != "cpu") {
    fmt::print(" {}: {} patches, {} left, {} looks, {} left", how.backend, stats.device_patches,
               stats.left_patches, stats.device_looks, stats.left_looks);
  }
  return hash(mesh);
}

void run_cgal(const SphereSet& spheres) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Union = CGAL::Union_of_balls_3<CGAL::Skin_surface_traits_3<Kernel>>;
  std::list<Union::Weighted_point> balls;
  for (const Sphere& s : spheres.spheres()) {
    balls.emplace_back(Union::Bare_point(s.center.x, s.center.y, s.center.z), s.radius * s.radius);
  }
  CGAL::Polyhedron_3<Kernel> mesh;
  const Seconds seconds = timed([&] {
    const Union surface(balls.begin(), balls.end());
    CGAL::mesh_union_of_balls_3(surface, mesh);
    CGAL::subdivide_union_of_balls_mesh_3(surface, mesh);
  });
  const auto triangles = static_cast<double>(mesh.size_of_facets());
  fmt::print("CGAL Union_of_balls_3, one subdivision: {:.0f} triangles, {:.3f} s, {:.0f} per s\n",
             triangles, seconds.cpu, triangles / seconds.cpu);
}

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) {
  std::vector<double> edge_lengths;
  std::vector<int> threads;
  std::vector<std::string> paths;
  std::vector<std::string> backends;
  int levels = 0;
  bool with_cgal = false, with_rounds = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--edge-length" && i + 1 < argc) {
      edge_lengths.push_back(std::stod(argv[++i]));
    } else if (argument == "--threads" && i + 1 < argc) {
      threads.push_back(std::stoi(argv[++i]));
    } else if (argument == "--backend" && i + 1 < argc) {
      backends.emplace_back(argv[++i]);
    } else if (argument == "--levels" && i + 1 < argc) {
      levels = std::stoi(argv[++i]);
    } else if (argument == "--rounds") {
      with_rounds = true;
    } else if (argument == "--cgal") {
      with_cgal = true;
    } else {
      paths.emplace_back(argument);
    }
  }
  if (edge_lengths.empty()) edge_lengths = {0.35};
  if (threads.empty()) threads = {1, 2};
  if (backends.empty()) backends = {"cpu"};
  fmt::print("{:<12} {:>5} {:>3} {:>10} {:>8} {:>8} {:>10} {:>10} {:>8}\n", "structure", "Å", "thr",
             "triangles", "wall s", "CPU s", "tri/CPU s", "arrange %", "bytes/t");
  for (const std::string& path : paths) {
    const vdwmesh::SphereSet spheres = vdwmesh::read(path);
    for (const double edge_length : edge_lengths) {
      for (const int n : threads) {
        std::optional<vdwmesh::IndexedMeshHash> before;
        for (const std::string& backend : backends) {
          const vdwmesh::IndexedMeshHash bits =
              vdwmesh::run(path, spheres, {edge_length, n, levels, backend, with_rounds});
          fmt::print("{}\n", !before ? "" : (bits == *before ? " same bits" : " OTHER BITS"));
          before = bits;
        }
      }
    }
    if (with_cgal && path == paths.front()) vdwmesh::run_cgal(spheres);
  }
  return 0;
}

// Field and extraction, OpenMesh build and PLY writing of van der Waals meshes, with peak memory.
//
//   extract_bench [--spacing H,H...] [--repeat N] [--backend auto|cpu|cuda] [--stages extract|all]
//   FILE...
//
// FILE: any structure file; the reference .xyzr sets are what docs and README quote. Each case runs
// in a process of its own, so that its peak memory is its own. Times are the least of the repeats;
// CPU seconds count user and system time of all threads.
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "cuda/backend.hpp"
#include "mesh/mesh_io.hpp"
#include "mesh/surface_mesh.hpp"
#include "parse_list.hpp"
#include "structure/reader.hpp"

namespace vdwmesh {
namespace {

enum class Stages { extract, all };

struct Options {
  std::vector<std::string> files;
  std::vector<double> spacings{0.5, 0.25};  // Å
  int repeat = 3;
  Backend backend = Backend::automatic;
  Stages stages = Stages::all;
};

struct Cost {
  double cpu = 0, wall = 0;  // s
};

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// What has passed since its construction.
class Clock {
 public:
  Cost cost() const { return {cpu_seconds() - cpu_, wall_seconds() - wall_}; }

 private:
  double cpu_ = cpu_seconds(), wall_ = wall_seconds();
};

Cost least(bool first, const Cost& best, const Cost& cost) {
  return first ? cost : Cost{std::min(best.cpu, cost.cpu), std::min(best.wall, cost.wall)};
}

// Runs `work` and keeps the lesser cost.
template <class Work>
void measure(Cost& best, bool first, Work&& work) {
  const Clock clock;
  work();
  best = least(first, best, clock.cost());
}

SphereSet read_spheres(const std::string& file) {
  std::vector<Sphere> spheres;
  for (const Atom& atom : read_structure(file).atoms) {
    spheres.push_back({atom.position, atom.radius});
  }
  return SphereSet(std::move(spheres));
}

// Peak memory is read between stages: the build starts while the IndexedMesh is alive.
void build_and_write(const IndexedMesh& indexed, const Options& options) {
  Cost build, write;
  double build_peak = 0;
  const auto path = std::filesystem::temp_directory_path() /
                    ("extract_bench_" + std::to_string(getpid()) + ".ply");
  for (int run = 0; run < options.repeat; ++run) {
    // Made in place: an OpenMesh mesh that is assigned is copied.
    const Clock clock;
    const SurfaceMesh mesh = to_surface_mesh(indexed);
    build = least(run == 0, build, clock.cost());
    if (run == 0) build_peak = peak_megabytes();
    measure(write, run == 0, [&] { write_mesh(mesh, path); });
  }
  fmt::print(" {:>8.3f} {:>8.3f} {:>7.0f} {:>8.3f} {:>8.3f} {:>7.1f}", build.cpu, build.wall,
             build_peak, write.cpu, write.wall,
             static_cast<double>(std::filesystem::file_size(path)) / 1e6);
  std::filesystem::remove(path);
}

void run_case(const std::string& file, double spacing, const Options& options) {
  const SphereSet spheres = read_spheres(file);
  const auto extractor = make_extractor(options.backend);
  const double before = peak_megabytes();
  ExtractOptions extract_options;
  extract_options.grid.spacing = spacing;
  Cost cost;
  ExtractResult result;
  for (int run = 0; run < options.repeat; ++run) {
    result = {};
    measure(cost, run == 0, [&] { result = extractor->extract(spheres, extract_options); });
  }
  fmt::print(
      "{:<14} {:>7} {:>5.3g} {:>9} {:>9} {:>8.3f} {:>8.3f} {:>8.3f} {:>8.3f} {:>6.0f} {:>6.0f}",
      std::filesystem::path(file).filename().string(), spheres.size(), spacing,
      result.mesh.vertex_count(), result.mesh.triangle_count(), cost.cpu, cost.wall,
      result.stats.field_seconds, result.stats.extract_seconds, before, peak_megabytes());
  if (options.stages == Stages::all) build_and_write(result.mesh, options);
  fmt::print("\n");
  std::fflush(stdout);
}

void print_header() {
  fmt::print(
      "{:<14} {:>7} {:>5} {:>9} {:>9} {:>8} {:>8} {:>8} {:>8} {:>6} {:>6} {:>8} {:>8} {:>7} "
      "{:>8} {:>8} {:>7}\n",
      "", "", "", "", "", "extract", "extract", "field", "triang.", "read", "extr.", "build",
      "build", "build", "write", "write", "file");
  fmt::print(
      "{:<14} {:>7} {:>5} {:>9} {:>9} {:>8} {:>8} {:>8} {:>8} {:>6} {:>6} {:>8} {:>8} {:>7} "
      "{:>8} {:>8} {:>7}\n",
      "set", "atoms", "h/A", "vertices", "triangles", "CPU s", "wall s", "wall s", "wall s", "MB",
      "MB", "CPU s", "wall s", "MB", "CPU s", "wall s", "MB");
  std::fflush(stdout);
}

Backend parse_backend(const std::string& name) {
  if (name == "cpu") return Backend::cpu;
  return name == "cuda" ? Backend::cuda : Backend::automatic;
}

Options parse(int argc, char** argv) {
  Options options;
  const auto value = [&](int& i) { return i + 1 < argc ? std::string(argv[++i]) : std::string(); };
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--spacing")
      options.spacings = parse_list(value(i));
    else if (argument == "--repeat")
      options.repeat = std::max(1, std::stoi(value(i)));
    else if (argument == "--backend")
      options.backend = parse_backend(value(i));
    else if (argument == "--stages")
      options.stages = value(i) == "extract" ? Stages::extract : Stages::all;
    else
      options.files.push_back(argument);
  }
  return options;
}

// The status of the child that ran the case.
int run_apart(const std::string& file, double spacing, const Options& options) {
  const pid_t child = fork();
  if (child == 0) {
    try {
      run_case(file, spacing, options);
      std::_Exit(0);
    } catch (const std::exception& error) {
      fmt::print(stderr, "{} at {} A: {}\n", file, spacing, error.what());
      std::_Exit(1);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) {
  const vdwmesh::Options options = vdwmesh::parse(argc, argv);
  if (options.files.empty()) {
    fmt::print(stderr,
               "usage: extract_bench [--spacing H,H...] [--repeat N] [--backend NAME] "
               "[--stages extract|all] FILE...\n");
    return 1;
  }
  vdwmesh::print_header();
  int failures = 0;
  for (const std::string& file : options.files) {
    for (const double spacing : options.spacings) {
      failures += vdwmesh::run_apart(file, spacing, options) != 0;
    }
  }
  return failures > 0;
}

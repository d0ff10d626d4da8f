// Times the exact union by arcs: per atom against size, against the number of threads, and of a few
// atoms in the presence of all.
//
//   arcs_bench [SPHERES.xyzr [PROBE]]     tables; without a file, a synthetic packing of atoms
//   arcs_bench SPHERES.xyzr PROBE PDB     writes the same spheres as PDB, radii as occupancies, for
//     freesasa --lee-richards -n 20 -t 1 -p 1e-9 --radius-from-occupancy PDB
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <exception>
#include <limits>
#include <optional>
#include <random>
#include <span>
#include <string>

#include "core/errors.hpp"
#include "measures/arcs/arcs.hpp"
#include "measures/exact_union.hpp"
#include "read_xyzr.hpp"

namespace {

using vdwmesh::Sphere;
using vdwmesh::SphereSet;

constexpr int kRepeats = 3;

// About as dense as heavy atoms in a protein (0.05 per Å³) and as crowded.
std::vector<Sphere> synthetic_spheres(double probe) {
  constexpr int kSide = 8;
  constexpr double kSpacing = 2.7, kJitter = 0.7;  // Å
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> jitter(-kJitter, kJitter), radius(1.5, 1.8);
  std::vector<Sphere> spheres;
  for (int z = 0; z < kSide; ++z) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        spheres.push_back({{kSpacing * x + jitter(random), kSpacing * y + jitter(random),
                            kSpacing * z + jitter(random)},
                           radius(random) + probe});
      }
    }
  }
  return spheres;
}

// `count` spheres: the first of `base`, or copies of all of it side by side.
std::vector<Sphere> tile(const std::vector<Sphere>& base, std::size_t count) {
  const vdwmesh::Box box = bounding_box(SphereSet(base));
  std::vector<Sphere> spheres;
  spheres.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    Sphere s = base[i % base.size()];
    s.center.x += static_cast<double>(i / base.size()) * (box.upper.x - box.lower.x);
    spheres.push_back(s);
  }
  return spheres;
}

struct Seconds {
  double wall, cpu;
};

// Least of a few runs of work().
template <class Work>
Seconds least_of(const Work& work) {
  Seconds best{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  for (int i = 0; i < kRepeats; ++i) {
    const auto wall = std::chrono::steady_clock::now();
    const std::clock_t cpu = std::clock();
    work();
    const double cpu_seconds = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
    const std::chrono::duration<double> wall_seconds = std::chrono::steady_clock::now() - wall;
    best = {std::min(best.wall, wall_seconds.count()), std::min(best.cpu, cpu_seconds)};
  }
  return best;
}

Seconds time_arcs(const SphereSet& spheres, std::size_t threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  return least_of([&] {
    if (arc_measures(spheres).per_sphere.size() != spheres.size())
      throw vdwmesh::Error("no measures");
  });
}

void print_scaling(const std::vector<Sphere>& base) {
  std::printf("%10s %12s %14s\n", "atoms", "cpu s", "atoms/cpu s");
  for (const std::size_t count : {500u, 5000u, 20000u, 80000u, 165175u, 290000u}) {
    const SphereSet spheres(tile(base, count));
    const Seconds t = time_arcs(spheres, 1);
    std::printf("%10zu %12.5f %14.0f\n", count, t.cpu, static_cast<double>(count) / t.cpu);
  }
}

void print_threads(const std::vector<Sphere>& base) {
  const SphereSet spheres(base);
  const double alone = time_arcs(spheres, 1).wall;
  std::printf("\n%10s %12s %14s   (%zu atoms)\n", "threads", "wall s", "speed-up", spheres.size());
  const auto cores = static_cast<std::size_t>(tbb::info::default_concurrency());
  for (std::size_t threads = 1; threads <= cores; threads *= 2) {
    const double wall = time_arcs(spheres, threads).wall;
    std::printf("%10zu %12.5f %14.2f\n", threads, wall, alone / wall);
  }
}

// Some spheres among all, by exact_union().
void print_some(const std::vector<Sphere>& base) {
  constexpr std::size_t kSome = 40;
  const SphereSet spheres(base);
  std::vector<vdwmesh::SphereId> some;
  for (std::size_t i = spheres.size() / 2; i < spheres.size() && some.size() < kSome; ++i) {
    some.push_back(static_cast<vdwmesh::SphereId>(i));
  }
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  vdwmesh::UnionOptions options{vdwmesh::UnionMethod::arcs};
  options.topology = vdwmesh::TopologyRequest::none;
  const double all = least_of([&] { exact_union(spheres, options); }).cpu;
  options.measured = some;
  const double few = least_of([&] { exact_union(spheres, options); }).cpu;
  std::printf("\n%zu of %zu atoms: %.6f cpu s, 1/%.0f of all\n", some.size(), spheres.size(), few,
              all / few);
}

void write_pdb(const std::vector<Sphere>& spheres, const char* path) {
  std::FILE* file = std::fopen(path, "w");
  if (!file) throw vdwmesh::InvalidInput(std::string("cannot write ") + path);
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const Sphere& s = spheres[i];
    std::fprintf(file, "ATOM  %5zu  C   ALA %c%4zu    %8.3f%8.3f%8.3f%6.2f  0.00           C\n",
                 i % 100000, static_cast<char>('A' + i / 9999 % 26), i % 9999, s.center.x,
                 s.center.y, s.center.z, s.radius);
  }
  std::fclose(file);
}

}  // namespace

int main(int argc, char** argv) try {
  const double probe = argc > 2 ? std::stod(argv[2]) : 0;
  const std::vector<Sphere> base =
      argc > 1 ? vdwmesh::read_xyzr(argv[1], probe) : synthetic_spheres(probe);
  if (argc > 3) {
    write_pdb(base, argv[3]);
    return 0;
  }
  print_scaling(base);
  print_threads(base);
  print_some(base);
} catch (const std::exception& error) {
  std::fprintf(stderr, "arcs_bench: %s\n", error.what());
  return 1;
}

// Times the exact union by triangulation, stage by stage, on one core, against the number of balls.
//
//   exact_union_bench SPHERES.xyzr[.gz] [PROBE]
//
// The certificate is timed beside the total, which is without it. Sizes from 500 up are the first
// balls of the file, then copies of all of it side by side. To compare with freesasa in one run,
// write the same balls with arcs_bench (see there).
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <utility>
#include <vector>

#include "complex/dual_complex.hpp"
#include "complex/power_triangulation.hpp"
#include "core/errors.hpp"
#include "measures/certificate/certify.hpp"
#include "measures/exact_union.hpp"
#include "measures/measures.hpp"
#include "measures/topology.hpp"
#include "structure/reader.hpp"

namespace {

using vdwmesh::Sphere;
using vdwmesh::SphereSet;

constexpr int kRepeats = 3;
constexpr std::size_t kStages = 5, kCertify = 4;  // the last is not part of the total
constexpr std::array<const char*, kStages> kNames{"triangulate", "complex", "measures", "topology",
                                                  "certify"};

// `count` balls: the first of `base`, or copies of all of it side by side.
SphereSet tile(const SphereSet& base, std::size_t count) {
  const vdwmesh::Box box = bounding_box(base);
  std::vector<Sphere> spheres;
  spheres.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    Sphere s = base[i % base.size()];
    s.center.x += static_cast<double>(i / base.size()) * (box.upper.x - box.lower.x);
    spheres.push_back(s);
  }
  return SphereSet(std::move(spheres));
}

SphereSet read_balls(const char* path, double probe) {
  vdwmesh::ReadOptions options;
  options.format = vdwmesh::StructureFormat::xyzr;
  std::vector<Sphere> spheres;
  for (const vdwmesh::Atom& atom : vdwmesh::read_structure(path, options).atoms) {
    spheres.push_back({atom.position, atom.radius + probe});
  }
  return SphereSet(std::move(spheres));
}

double seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::array<double, kStages> time_stages(const SphereSet& spheres) {
  std::array<double, kStages + 1> at{seconds()};
  const auto triangulation = vdwmesh::triangulate(spheres);
  at[1] = seconds();
  const auto complex = vdwmesh::dual_complex(triangulation);
  at[2] = seconds();
  const auto measures = vdwmesh::inclusion_exclusion(triangulation, complex);
  at[3] = seconds();
  const auto topology = vdwmesh::union_topology(triangulation, complex, measures);
  at[4] = seconds();
  const auto certificate = vdwmesh::certify(spheres, triangulation, complex,
                                            vdwmesh::MeasuredSpheres(spheres.size(), std::nullopt));
  at[5] = seconds();
  if (topology.components == 0 || certificate.bits == 0) {
    throw vdwmesh::Error("no union");
  }
  std::array<double, kStages> spent;
  for (std::size_t k = 0; k < kStages; ++k) spent[k] = at[k + 1] - at[k];
  return spent;
}

// Least total of a few runs.
void print_row(const SphereSet& spheres) {
  std::array<double, kStages> best{};
  double least = 0;
  for (int run = 0; run < kRepeats; ++run) {
    const auto spent = time_stages(spheres);
    double total = 0;
    for (std::size_t k = 0; k < kCertify; ++k) total += spent[k];
    if (run > 0 && total >= least) continue;
    least = total;
    best = spent;
  }
  std::printf("%9zu", spheres.size());
  for (const double s : best) std::printf(" %11.4f", s);
  std::printf(" %9.4f %12.0f\n", least, static_cast<double>(spheres.size()) / least);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: exact_union_bench SPHERES.xyzr[.gz] [PROBE]\n");
    return 1;
  }
  try {
    const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
    const SphereSet base = read_balls(argv[1], argc > 2 ? std::atof(argv[2]) : 0);
    std::printf("CPU seconds on one core, least of %d runs\n%9s", kRepeats, "balls");
    for (const char* name : kNames) std::printf(" %11s", name);
    std::printf(" %9s %12s\n", "total", "balls/s");
    for (const std::size_t count : {500u, 5000u, 50000u, 145000u, 290000u}) {
      print_row(tile(base, count));
    }
    if (base.size() > 500) print_row(base);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "exact_union_bench: %s\n", error.what());
    return 1;
  }
}

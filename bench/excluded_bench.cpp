// Times area and volume of the excluded surface with the shares of all atoms on a CUDA device, and
// compares them with those of the CPU.
//
//   excluded_bench FILE.xyzr[.gz] [PROBE [COPIES [RUNS [cpu]]]]
//
// default: 1.4 Å, one copy, 10 runs. Copies stand beside each other in one set; with a negative
// number they are sets of a batch. With `cpu` the CPU's figures stand beside.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "cuda/backend.hpp"
#include "support/xyzr.hpp"

namespace {

using namespace vdwmesh;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct Copies {
  std::vector<Sphere> atoms;
  std::vector<std::size_t> offsets;
};

Copies copies_of(const SphereSet& set, int count) {
  Copies out;
  double lower = 1e300, upper = -1e300, reach = 0;
  for (const Sphere& s : set.spheres()) {
    lower = std::min(lower, s.center.x);
    upper = std::max(upper, s.center.x);
    reach = std::max(reach, s.radius);
  }
  const double step = upper - lower + 2 * reach + 20;
  if (count < 0) out.offsets.push_back(0);
  for (int k = 0; k < std::abs(count); ++k) {
    for (Sphere s : set.spheres()) {
      s.center.x += k * step;
      out.atoms.push_back(s);
    }
    if (count < 0) out.offsets.push_back(out.atoms.size());
  }
  return out;
}

void print(const char* name, const ExcludedTotals& t) {
  fmt::print(
      "{:4} area {:.9f} volume {:.9f} chi {} closure {:.1e} check {:.1e} probes {} low {} "
      "creases {}\n",
      name, t.area, t.volume, t.euler_characteristic, t.closure, t.check_volume / t.volume - 1,
      t.counts.probes, t.counts.low_probes, t.counts.crease_arcs);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "excluded_bench FILE.xyzr[.gz] [PROBE [COPIES [RUNS [cpu]]]]\n");
    return 1;
  }
  const double probe = argc > 2 ? std::atof(argv[2]) : 1.4;
  const int count = argc > 3 ? std::atoi(argv[3]) : 1, runs = argc > 4 ? std::atoi(argv[4]) : 10;
  const bool compare = argc > 5;
  const Copies copies = copies_of(testing::read_xyzr(argv[1]), count);
  const SphereBatch batch{
      .spheres = copies.atoms.data(), .size = copies.atoms.size(), .offsets = copies.offsets};
  const auto measurer = make_excluded_measurer(Backend::cuda);
  ExcludedBatch found;
  std::vector<double> seconds;
  for (int i = 0; i < runs; ++i) {
    const double begin = now();
    measurer->measure_into(found, batch, probe);
    seconds.push_back(now() - begin);
  }
  std::sort(seconds.begin(), seconds.end());
  fmt::print(
      "{} probe {}: {} atoms, {} sets: median {:.2f} ms, least {:.2f}; on the host {} balls, "
      "{} circles, {} corners, {} patches, {} sets\n",
      argv[1], probe, batch.size, batch.set_count(), 1e3 * seconds[seconds.size() / 2],
      1e3 * seconds[0], found.host_balls, found.host_circles, found.host_corners,
      found.host_patches, found.host_sets);
  print("cuda", found.totals[0]);
  if (!compare) return 0;
  const double begin = now();
  const ExcludedBatch cpu = make_excluded_measurer(Backend::cpu)->measure(batch, probe);
  const double took = now() - begin;
  print("cpu", cpu.totals[0]);
  double area = 0, volume = 0;
  for (std::size_t i = 0; i < batch.size; ++i) {
    area = std::max(area, std::abs(found.per_atom[i].area.sum() - cpu.per_atom[i].area.sum()));
    volume = std::max(volume, std::abs(found.per_atom[i].volume - cpu.per_atom[i].volume));
  }
  fmt::print(
      "     CPU {:.3f} s; relative: area {:.1e}, volume {:.1e}; atoms: area {:.1e} Å², volume "
      "{:.1e} Å³\n",
      took, found.totals[0].area / cpu.totals[0].area - 1,
      found.totals[0].volume / cpu.totals[0].volume - 1, area, volume);
  return 0;
}

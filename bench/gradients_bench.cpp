// Times derivatives of area and volume beside the measures alone, on one thread: of the union of
// the balls grown by the probe, and of the excluded surface.
//
//   gradients_bench SPHERES.xyzr [PROBE [RUNS]]
//
// default: 1.4 Å, 20 runs. Runs with and without derivatives take turns, and the least CPU time of
// each counts, with the median of the ratios of neighbours. The union is measured anew each time
// with memory of the run before, as by a molecular dynamics program.
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <exception>
#include <string>
#include <vector>

#include "core/workspace.hpp"
#include "excluded/excluded_measures.hpp"
#include "measures/union_gradients.hpp"
#include "read_xyzr.hpp"

namespace {

using namespace vdwmesh;

template <class Work>
double milliseconds(const Work& work) {
  const std::clock_t begin = std::clock();
  work();
  return 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

template <class Measures, class Gradients>
void compare(const char* name, int runs, const Measures& measures, const Gradients& gradients) {
  measures();
  gradients();
  std::vector<double> alone, with, ratios;
  for (int i = 0; i < runs; ++i) {
    alone.push_back(milliseconds(measures));
    with.push_back(milliseconds(gradients));
    ratios.push_back(with.back() / alone.back());
  }
  const double least_alone = *std::ranges::min_element(alone);
  const double least_with = *std::ranges::min_element(with);
  std::ranges::sort(ratios);
  std::printf("%-17s measures %8.2f ms, with derivatives %8.2f ms (%.3f times; pairs %.3f)\n", name,
              least_alone, least_with, least_with / least_alone, ratios[ratios.size() / 2]);
}

void compare_union(const std::vector<Sphere>& grown, int runs) {
  Workspace measures_space, gradients_space;
  UnionOptions options{UnionMethod::arcs};
  options.topology = TopologyRequest::none;
  options.workspace = &measures_space;
  UnionGradients found{};
  compare(
      "union", runs, [&] { exact_union(SphereSet::view(grown), options); },
      [&] {
        union_gradients_into(found, SphereSet::view(grown), {.workspace = &gradients_space});
      });
}

void compare_excluded(const std::vector<Sphere>& atoms, double probe, int runs) {
  const SphereSet set(atoms);
  const auto measure = [&](bool gradients) {
    excluded_measures(set, {.probe = probe, .shells = false, .gradients = gradients});
  };
  compare(
      "excluded surface", runs, [&] { measure(false); }, [&] { measure(true); });
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "gradients_bench SPHERES.xyzr [PROBE [RUNS]]\n");
    return 1;
  }
  const double probe = argc > 2 ? std::stod(argv[2]) : kWaterProbe;
  const int runs = argc > 3 ? std::stoi(argv[3]) : 20;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const std::vector<Sphere> grown = read_xyzr(argv[1], probe);
  std::printf("%zu balls, probe %g, one thread, least of %d\n", grown.size(), probe, runs);
  compare_union(grown, runs);
  if (probe > 0) compare_excluded(read_xyzr(argv[1]), probe, runs);
} catch (const std::exception& error) {
  std::fprintf(stderr, "gradients_bench: %s\n", error.what());
  return 1;
}

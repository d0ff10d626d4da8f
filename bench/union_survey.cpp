// The exact union by arcs against that by triangulation, on seeded sets of balls unlike proteins.
//
//   union_survey COUNT [SEED]
//
// Takes COUNT sets of the families of tests/support/ball_families.hpp in turn, from SEED on (1), on
// all cores. It prints how many counts of the topology were decided, how many of these are wrong,
// how many balls were measured, how many of these went to the triangulation, and the largest
// difference of the others, relative to the ball. Names each wrong set on standard error and ends
// with 1 if there is one, or if a ball differs by more than 1e-9.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iterator>
#include <mutex>

#include "measures/arcs/arcs.hpp"
#include "measures/exact_union.hpp"
#include "support/ball_families.hpp"

namespace vdwmesh {
namespace {

struct Survey {
  unsigned long long sets = 0, decided = 0, wrong = 0, balls = 0, suspect = 0;
  double difference = 0;
};

bool counts_are_right(const UnionCounts& counts, const UnionTopology& topology) {
  return counts.components == topology.components &&
         counts.euler_characteristic == topology.euler_characteristic &&
         counts.hidden_spheres == topology.hidden_spheres;
}

// The largest difference of a trusted ball, in units of its radius squared or cubed.
double largest_difference(const SphereSet& spheres, const ArcMeasures& arcs,
                          const ExactUnion& exact) {
  double largest = 0;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    if (std::binary_search(arcs.suspect.begin(), arcs.suspect.end(), i)) continue;
    const double r = spheres[i].radius;
    const SphereMeasures &a = arcs.per_sphere[i], &b = exact.per_sphere[i];
    largest = std::max({largest, std::abs(a.area - b.area) / (r * r),
                        std::abs(a.volume - b.volume) / (r * r * r)});
  }
  return largest;
}

void survey_one(unsigned seed, std::mutex& mutex, Survey& sum) {
  const testing::BallFamily& family =
      testing::kBallFamilies[seed % std::size(testing::kBallFamilies)];
  testing::Dice dice(seed);
  const SphereSet spheres(family.make(dice));
  UnionOptions options;
  options.topology = TopologyRequest::counts;
  const ExactUnion quick = exact_union(spheres, options), exact = exact_union(spheres);
  const ArcMeasures arcs = arc_measures(spheres);
  const bool wrong = quick.counts && !counts_are_right(*quick.counts, *exact.topology);
  const double difference = largest_difference(spheres, arcs, exact);
  const std::lock_guard lock(mutex);
  if (wrong) std::fprintf(stderr, "seed %u, %s: wrong counts\n", seed, family.name);
  if (!(difference <= 1e-9)) std::fprintf(stderr, "seed %u: a ball by %.1e\n", seed, difference);
  ++sum.sets;
  sum.decided += quick.counts.has_value();
  sum.wrong += wrong;
  sum.balls += spheres.size();
  sum.suspect += arcs.suspect.size();
  sum.difference = std::max(sum.difference, difference);
}

int survey(unsigned count, unsigned first) {
  Survey sum;
  std::mutex mutex;
  tbb::parallel_for(0u, count, [&](unsigned k) { survey_one(first + k, mutex, sum); });
  std::printf("%llu sets: counts of %llu decided, %llu of these wrong\n", sum.sets, sum.decided,
              sum.wrong);
  std::printf("%llu balls: %llu by the triangulation, the others within %.1e\n", sum.balls,
              sum.suspect, sum.difference);
  return sum.wrong == 0 && sum.difference <= 1e-9 ? 0 : 1;
}

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) try {
  if (argc < 2 || argc > 3) {
    std::fprintf(stderr, "usage: union_survey COUNT [SEED]\n");
    return 2;
  }
  const auto number = [](const char* word) {
    return static_cast<unsigned>(std::strtoul(word, nullptr, 10));
  };
  return vdwmesh::survey(number(argv[1]), argc > 2 ? number(argv[2]) : 1);
} catch (const std::exception& error) {
  std::fprintf(stderr, "union_survey: %s\n", error.what());
  return 1;
}

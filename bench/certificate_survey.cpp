// Certificates of seeded sets of balls against an evaluation with 60 digits: the figures of
// docs/certificates.md.
//
//   certificate_survey COUNT SEED [--most-balls N]
//
// Takes the sets SEED to SEED + COUNT - 1 of tests/support/certificate_sets.hpp, without those of
// more than N balls, on all cores. It prints how many certificates contain the true area and
// volume, how many would if the processor rounded to nearest, and the widest intervals.
// Each set that is missed is named on standard error. Ends with 1 if a certificate is wrong.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <mutex>

#include "support/certificate_sets.hpp"

namespace vdwmesh {
namespace {

struct Survey {
  std::uint64_t sets = 0, inside = 0, inside_to_nearest = 0, wide = 0;
  double area_width = 0, volume_width = 0;  // relative, the largest
  int bits = 0;
};

void survey_one(unsigned seed, std::size_t most_balls, std::mutex& mutex, Survey& sum) {
  const SphereSet spheres = testing::certificate_set(seed);
  if (spheres.size() > most_balls) return;
  const UnionCertificate certificate = testing::certificate_of(spheres);
  const auto truth = testing::true_measures(spheres);
  const bool inside = testing::contains(certificate, truth);
  const bool to_nearest = testing::contains(
      testing::certificate_of(spheres, certificate::RoundingMode::to_nearest), truth);
  const std::lock_guard lock(mutex);
  if (!inside) std::fprintf(stderr, "set %u, %zu balls: missed\n", seed, spheres.size());
  ++sum.sets;
  sum.inside += inside;
  sum.inside_to_nearest += to_nearest;
  sum.wide += certificate.wide_spheres > 0;
  sum.area_width = std::max(sum.area_width, testing::relative_width(certificate.area));
  sum.volume_width = std::max(sum.volume_width, testing::relative_width(certificate.volume));
  sum.bits = std::max(sum.bits, certificate.bits);
}

int survey(unsigned count, unsigned first, std::size_t most_balls) {
  Survey sum;
  std::mutex mutex;
  tbb::parallel_for(0u, count, [&](unsigned k) { survey_one(first + k, most_balls, mutex, sum); });
  std::printf(
      "%llu sets: %llu inside; if rounded to nearest %llu; widest area %.2e, volume %.2e; "
      "%llu sets needed more than double, at most %d bits\n",
      static_cast<unsigned long long>(sum.sets), static_cast<unsigned long long>(sum.inside),
      static_cast<unsigned long long>(sum.inside_to_nearest), sum.area_width, sum.volume_width,
      static_cast<unsigned long long>(sum.wide), sum.bits);
  return sum.inside == sum.sets ? 0 : 1;
}

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) {
  if (argc != 3 && !(argc == 5 && std::strcmp(argv[3], "--most-balls") == 0)) {
    std::fprintf(stderr, "usage: certificate_survey COUNT SEED [--most-balls N]\n");
    return 1;
  }
  try {
    const std::size_t most = argc == 5 ? std::strtoull(argv[4], nullptr, 10) : SIZE_MAX;
    return vdwmesh::survey(static_cast<unsigned>(std::strtoul(argv[1], nullptr, 10)),
                           static_cast<unsigned>(std::strtoul(argv[2], nullptr, 10)), most);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "certificate_survey: %s\n", error.what());
    return 1;
  }
}

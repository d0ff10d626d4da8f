// total_measures(): blocks of entries are summed side by side, then the blocks' sums are added.
#include "measures/total_measures.hpp"

#include <vector>

#include "core/fixed_blocks.hpp"
#include "measures/exact_sum.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kEntriesPerBlock = std::size_t{1} << 14;

struct ExactTotals {
  ExactSum area, volume;
};

ExactTotals sum_of(std::span<const SphereMeasures> per_sphere, std::size_t first, std::size_t end,
                   const MeasuredSpheres& measured) {
  ExactTotals sum;
  for (std::size_t i = first; i < end; ++i) {
    if (!measured.contains(static_cast<SphereId>(i))) continue;
    sum.area.add(per_sphere[i].area);
    sum.volume.add(per_sphere[i].volume);
  }
  return sum;
}

}  // namespace

SphereMeasures total_measures(std::span<const SphereMeasures> per_sphere,
                              const MeasuredSpheres& measured) {
  std::vector<ExactTotals> parts(block_count(per_sphere.size(), kEntriesPerBlock));
  for_each_block(per_sphere.size(), kEntriesPerBlock,
                 [&](std::size_t block, std::size_t first, std::size_t end) {
                   parts[block] = sum_of(per_sphere, first, end, measured);
                 });
  if (parts.empty()) return {0, 0};
  ExactTotals& sum = parts[0];
  for (const ExactTotals& part : std::span(parts).subspan(1)) {
    sum.area.add(part.area);
    sum.volume.add(part.volume);
  }
  return {sum.area.nearest(), sum.volume.nearest()};
}

SphereMeasures total_measures(std::span<const SphereMeasures> per_sphere) {
  return total_measures(per_sphere, MeasuredSpheres(per_sphere.size(), std::nullopt));
}

}  // namespace vdwmesh

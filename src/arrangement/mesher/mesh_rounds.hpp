// What the rounds of union_mesher.cpp ask of patches. There are three series: the first looks at
// boundaries alone, which is quick, the second makes triangles, and the third makes those patches
// anew that have an angle below its floor (angle_floors.hpp), with the patches beside what it
// splits. Meshes without such an angle have no third series, and do not depend on it.
#pragma once

#include <cstdint>
#include <span>

#include "arrangement/exact_mesher.hpp"
#include "arrangement/mesher/patch_mesher.hpp"
#include "core/blocks.hpp"

namespace vdwmesh {

// All count the rounds of one series. In the first kQualityRounds rounds, or kAngleRounds if the
// angles have a bound or floors, pieces are split for the quality of triangles as well, afterwards
// only for their validity. If there are still requests in round kMostRounds, the mesher gives up.
inline constexpr int kQualityRounds = 12, kAngleRounds = 30;
inline constexpr int kMostRounds = 60;

enum class RoundSeries : std::uint8_t { boundaries, patches, floors };

struct RoundDemands {
  PatchStage stage;
  Demand demand;
  bool raises_angles = false;  // above their floors
};

// `leaves_room`: whether no arc has so many pieces that splits for a bound on the angles must end.
inline RoundDemands demands_of(RoundSeries series, int round, const ExactMeshOptions& options,
                               bool leaves_room) {
  const bool raises = series == RoundSeries::floors && round <= kAngleRounds;
  const bool bounds = options.min_angle > 0 && leaves_room && round <= kAngleRounds;
  const bool has_quality = round <= kQualityRounds || bounds || raises;
  return {series == RoundSeries::boundaries ? PatchStage::boundary : PatchStage::triangles,
          has_quality ? Demand::quality : Demand::validity, raises};
}

inline std::uint64_t angles_below_floor(std::span<const PatchMesh> patches) {
  return sum_all(patches.size(),
                 [&](std::size_t i, std::uint64_t& count) { count += patches[i].below_floor; });
}

}  // namespace vdwmesh

// What counting keeps of each brick of a field over spheres until its vertices are written: the
// spheres near it, so that they need not be searched for again, and the values of a blended field.
#pragma once

#include <cstdint>

#include "extract/bricks/brick.hpp"
#include "extract/field.hpp"
#include "spheres/list_place.hpp"

namespace vdwmesh {

// The number of nodes that the cells of a brick touch, 9 x 9 x 9: its own and its halo.
inline constexpr int kBrickValues = kBrickReach * kBrickReach * kBrickReach;

// The spheres near a brick, in list order. If `count` is more than kPlaces, only the first are
// there.
template <std::uint32_t kPlaces>
struct NearPlaces {
  std::uint32_t count;
  ListPlace place[kPlaces];
};

// The most balls of a brick that the kernels keep in shared memory: a set of them is the bits of
// one 64-bit word.
inline constexpr std::uint32_t kMostSharedBalls = 64;

// Of blended fields, the most atoms of a brick whose places are kept.
inline constexpr std::uint32_t kKeptAtoms = 128;

struct KeptUnion {
  NearPlaces<kMostSharedBalls> near;
};
// values: of the field at the 9 x 9 x 9 nodes, x fastest. Set, as `near` is, if the brick holds
// surface.
struct KeptBlended {
  float values[kBrickValues];
  NearPlaces<kKeptAtoms> near;
};

// Bytes of each brick: the size of a KeptUnion, or of a KeptBlended.
inline std::uint64_t kept_bytes(FieldKind kind) {
  return kind == FieldKind::vdw ? sizeof(KeptUnion) : sizeof(KeptBlended);
}

}  // namespace vdwmesh

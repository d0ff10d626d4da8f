// Many sets of spheres, one after another, for calls that work on all of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Where an array lies: in memory of the host, or of the CUDA device that is current when it is
// used.
enum class MemorySpace : std::uint8_t { host, device };

// Sets of spheres that stand one after another, in memory of the caller. Balls of different sets do
// not see each other.
struct SphereBatch {
  // Rows of four doubles: centre and radius, Å. A SphereSet must accept them.
  const Sphere* spheres = nullptr;
  std::size_t size = 0;  // number of spheres in all sets
  // Set i has the spheres offsets[i] up to offsets[i + 1]. Begins with 0, rises, ends with `size`.
  // Always in host memory. Empty: all spheres are one set.
  std::span<const std::size_t> offsets{};
  MemorySpace memory = MemorySpace::host;  // of `spheres`

  std::size_t set_count() const { return offsets.empty() ? 1 : offsets.size() - 1; }
  std::size_t set_begin(std::size_t set) const { return offsets.empty() ? 0 : offsets[set]; }
  std::size_t set_end(std::size_t set) const { return offsets.empty() ? size : offsets[set + 1]; }
  // The spheres of a set. Precondition: they lie in host memory.
  std::span<const Sphere> set(std::size_t number) const {
    return {spheres + set_begin(number), set_end(number) - set_begin(number)};
  }
};

// The spheres as a batch of one set. The batch looks at them.
SphereBatch batch_of(const SphereSet& spheres);

// For implementations. Throws InvalidInput unless the offsets keep the rule above and no set is
// empty.
void check_sets(const SphereBatch& batch);

}  // namespace vdwmesh

// Vertices merged where all three coordinates are equal, in order of first appearance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/buffer.hpp"
#include "core/vec3.hpp"

namespace vdwmesh::formats {

class VertexWelder {
 public:
  // `expected` vertices or fewer take no growing.
  explicit VertexWelder(Buffer<Vec3d>& positions, std::size_t expected = 0);

  // Index of the vertex at p, which is added where it is new. 0 and -0 are equal.
  std::uint32_t index(const Vec3d& p);

  // The same for many points, at most kMost of them; memory is asked for all of them at once.
  static constexpr std::size_t kMost = 96;
  void index(std::span<const Vec3d> points, std::span<std::uint32_t> result);

 private:
  // The tag is part of the hash: another vertex is told apart without looking at its position.
  struct Slot {
    std::uint32_t index, tag;
  };
  std::uint32_t index(const Vec3d& p, std::uint64_t hash);
  std::uint32_t find_or_add(const Vec3d& p, std::uint64_t hash);
  void insert_all(std::size_t slots);

  Buffer<Vec3d>& positions_;
  Buffer<std::uint32_t> recent_;  // by hash: most vertices come again soon
  Buffer<Slot> slots_;            // open addressing, at most half full
};

}  // namespace vdwmesh::formats

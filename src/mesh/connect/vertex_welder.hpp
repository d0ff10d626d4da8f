// Collects points into a list without duplicates, in the order of first appearance. Two points are
// duplicates if all three coordinates are equal as numbers; there is no tolerance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/buffer.hpp"
#include "core/vec3.hpp"

namespace vdwmesh::formats {

class VertexWelder {
 public:
  // Will append to `positions`, which must be empty and outlive the welder. `expected` is a hint:
  // memory for that many vertices is taken at once, and more is taken when it is needed.
  explicit VertexWelder(Buffer<Vec3d>& positions, std::size_t expected = 0);

  // Returns the index of p among the positions, after adding p if it is new. 0 and -0 are equal.
  // Precondition: p is finite. Throws LimitExceeded if the mesh has too many vertices.
  std::uint32_t index(const Vec3d& p);

  // The same for up to kMost points: result[i] is the index of points[i]. It prefetches the table's
  // slots of all points before it looks up the first, so that their cache misses overlap.
  static constexpr std::size_t kMost = 96;  // points; the corners of 32 triangles
  void index(std::span<const Vec3d> points, std::span<std::uint32_t> result);

 private:
  // A slot holds the index of a vertex and the upper 32 bits of its hash, the tag. If two tags
  // differ, so do the points, and no position has to be read.
  struct Slot {
    std::uint32_t index, tag;
  };
  // The common part of both functions above. `p` has no negative zeros, and `hash` is its hash. The
  // first function asks the cache, then the second, which asks the table.
  std::uint32_t index(const Vec3d& p, std::uint64_t hash);
  std::uint32_t find_or_add(const Vec3d& p, std::uint64_t hash);
  void rebuild_table(std::size_t slots);

  Buffer<Vec3d>& positions_;
  // A small direct-mapped cache in front of the table: the last vertex found for each value of some
  // hash bits. Neighbouring triangles repeat their corners soon, so it answers most look-ups.
  Buffer<std::uint32_t> recent_;
  Buffer<Slot> slots_;  // open addressing; its size is a power of two; at most half full
};

}  // namespace vdwmesh::formats

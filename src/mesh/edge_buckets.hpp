// Half-edges of a triangle soup grouped by the edge they run along: counting sorts by ranges of the
// smaller vertex and by that vertex, then a small sort inside each bucket, so the time is linear in
// the triangles; on all cores.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/buffer.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// OpenMesh handles are int, so 2^31 - 1 half-edges are the most a mesh can have.
inline constexpr std::uint64_t kMaxSurfaceHalfEdges = 0x7fffffffu;

// Half-edges 3t + k of one triangle, the one after and the one before.
constexpr std::uint32_t next_in_triangle(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
constexpr std::uint32_t previous_in_triangle(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

// One half-edge in the bucket of its smaller vertex. Comparison sorts by larger vertex, then
// half-edge.
class EdgeEntry {
 public:
  EdgeEntry() = default;
  EdgeEntry(std::uint32_t larger, std::uint32_t half_edge, std::uint32_t descending)
      : bits_(std::uint64_t{larger} << 32 | std::uint64_t{half_edge} << 1 | descending) {}

  std::uint32_t larger() const { return static_cast<std::uint32_t>(bits_ >> 32); }
  std::uint32_t half_edge() const { return static_cast<std::uint32_t>(bits_) >> 1; }
  // Whether the half-edge runs from the larger vertex to the smaller.
  bool descending() const { return (bits_ & 1u) != 0; }
  friend bool operator<(EdgeEntry a, EdgeEntry b) { return a.bits_ < b.bits_; }

 private:
  std::uint64_t bits_;
};

class EdgeBuckets {
 public:
  // Half-edges whose two ends are one vertex are left out; repeated_index() names the first
  // triangle that has one. Throws InvalidInput for an index of no vertex, LimitExceeded beyond
  // 2^31 - 1 half-edges.
  EdgeBuckets(std::span<const Triangle> triangles, std::size_t vertex_count);

  std::size_t vertex_count() const { return end_.size(); }
  // The half-edges of all edges whose smaller vertex is v, those of one edge side by side.
  std::span<const EdgeEntry> at(std::size_t v) const {
    const std::size_t begin = v == 0 ? 0 : end_[v - 1];
    return {entries_.data() + begin, end_[v] - begin};
  }
  std::optional<std::size_t> repeated_index() const { return repeated_index_; }

 private:
  Buffer<std::uint32_t> end_;
  Buffer<EdgeEntry> entries_;
  std::optional<std::size_t> repeated_index_;
};

// Calls visit(span of EdgeEntry) for every edge of a bucket.
template <class Visit>
void for_each_edge(std::span<const EdgeEntry> bucket, Visit&& visit) {
  for (std::size_t first = 0; first < bucket.size();) {
    std::size_t last = first + 1;
    while (last < bucket.size() && bucket[last].larger() == bucket[first].larger()) ++last;
    visit(bucket.subspan(first, last - first));
    first = last;
  }
}

}  // namespace vdwmesh

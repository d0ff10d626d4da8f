// Groups the half-edges of any triangles by the edge that they run along. The triangles need not be
// a manifold: an edge may have any number of half-edges. The smaller vertex of an edge is its
// vertex of smaller index. There is one bucket per vertex v, which holds the half-edges of all
// edges whose smaller vertex is v. The work is done on all cores. Its time is linear in the number
// of triangles as long as buckets are short, because each bucket is sorted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/buffer.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// The most half-edges that a SurfaceMesh can have, because OpenMesh's handles are of type int.
inline constexpr std::uint64_t kMaxSurfaceHalfEdges = 0x7fffffffu;

// Throws LimitExceeded for triangles that have more half-edges than that.
void check_triangle_count(std::size_t triangles);

// The half-edges after and before h = 3t + k in its triangle t.
constexpr std::uint32_t next_in_triangle(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
constexpr std::uint32_t previous_in_triangle(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

// One half-edge in the bucket of its smaller vertex. Entries are ordered by the larger vertex, then
// by half-edge. Both are packed into 64 bits, from the top: 32 bits of larger vertex, 31 bits of
// half-edge, 1 bit of direction (`descending`). One integer comparison therefore compares entries.
class EdgeEntry {
 public:
  EdgeEntry() = default;  // leaves bits_ uninitialised
  // `descending` is 0 or 1.
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
  // Leaves out half-edges that start and end at the same vertex. Throws InvalidInput if a triangle
  // has an index of vertex_count or more, and LimitExceeded beyond 2^31 - 1 half-edges.
  EdgeBuckets(std::span<const Triangle> triangles, std::size_t vertex_count);

  std::size_t vertex_count() const { return end_.size(); }
  // The bucket of vertex v: the half-edges of all edges whose smaller vertex is v, in the order of
  // EdgeEntry. So the half-edges of one edge stand side by side.
  std::span<const EdgeEntry> at(std::size_t v) const {
    const std::size_t begin = v == 0 ? 0 : end_[v - 1];
    return {entries_.data() + begin, end_[v] - begin};
  }
  // The number of the first triangle that names a vertex twice, if there is one. This is no error
  // here: the analysis says that such a mesh is no manifold, and opposite_half_edges() refuses it.
  std::optional<std::size_t> repeated_index() const { return repeated_index_; }

 private:
  Buffer<std::uint32_t> end_;  // vertex -> end of its bucket in entries_
  Buffer<EdgeEntry> entries_;  // all buckets, by vertex
  std::optional<std::size_t> repeated_index_;
};

// Calls visit(edge) for every edge of a bucket; `edge` is the span of the edge's entries.
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

// Groups half-edges by edge with counting sorts, so without hashing and without a sort of all
// edges. The smaller vertex of a half-edge is its end of lower index. Four steps: check the indices
// and count the half-edges; group the half-edges by range of 8192 smaller vertices (a parallel
// counting sort); within each range, sort by smaller vertex (a counting sort that stays in cache),
// which makes a bucket of the half-edges of one smaller vertex; sort each bucket by larger vertex.
// The result is in compressed-sparse-row form: all entries in one array, and the end of each
// vertex's bucket in another. opposite_half_edges() pairs half-edges with it; the analysis counts
// edges and their faces with it.
#include "mesh/connect/edge_buckets.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

#include "core/errors.hpp"
#include "core/large_pages.hpp"
#include "mesh/connect/groups_by_range.hpp"
#include "surface/triangle_check.hpp"

namespace vdwmesh {
namespace {

// One half-edge of a triangle in 32 bits: 30 bits of triangle and 2 bits of side. The number 3t + k
// would also fit, but then reading the triangle back would cost a division.
class HalfEdge {
 public:
  // Leaves code_ uninitialised, so that resize_untouched() can enlarge an array without writing it.
  HalfEdge() = default;
  HalfEdge(std::size_t triangle, unsigned side)
      : code_(static_cast<std::uint32_t>(triangle) << 2 | side) {}

  std::uint32_t triangle() const { return code_ >> 2; }
  unsigned side() const { return code_ & 3u; }
  std::uint32_t number() const { return 3 * triangle() + side(); }  // 3t + k

 private:
  std::uint32_t code_;
};
static_assert(kMaxSurfaceHalfEdges / 3 < std::uint64_t{1} << 30);

constexpr unsigned next_corner(unsigned k) { return k == 2 ? 0 : k + 1; }

// Calls visit(side, from, to) for the sides of a triangle whose ends are two different vertices.
template <class Visit>
void for_each_side(const Triangle& triangle, Visit&& visit) {
  for (unsigned k = 0; k < 3; ++k) {
    const std::uint32_t from = triangle[k], to = triangle[next_corner(k)];
    if (from != to) visit(k, from, to);
  }
}

// Fills the buckets of end.size() vertices, from `first_vertex` on. This is a counting sort by
// smaller vertex, then a sort of each bucket. The first of these buckets begins at entries[begin].
// for_each_half_edge(visit) calls visit(number, from, to) for each half-edge whose smaller vertex
// is one of these vertices; its number is 3t + k. It runs twice, to count and to write.
//
// end[i] belongs to vertex first_vertex + i, and its meaning changes on the way. After counting it
// is the size of the bucket. The exclusive prefix sum makes it the index in `entries` at which the
// bucket begins. Each write moves it on by one, so that it ends as the end of the bucket.
template <class ForEach>
void fill_buckets(ForEach&& for_each_half_edge, std::uint32_t begin, std::size_t first_vertex,
                  std::span<std::uint32_t> end, EdgeEntry* entries) {
  std::fill(end.begin(), end.end(), 0u);
  for_each_half_edge([&](std::uint32_t, std::uint32_t from, std::uint32_t to) {
    ++end[std::min(from, to) - first_vertex];
  });
  std::uint32_t next = begin;
  // `e` becomes `next`, then its old value, the size, is added: += evaluates its right side first.
  for (std::uint32_t& e : end) next += std::exchange(e, next);
  for_each_half_edge([&](std::uint32_t number, std::uint32_t from, std::uint32_t to) {
    // The third argument is the direction: whether the half-edge descends to the smaller vertex.
    entries[end[std::min(from, to) - first_vertex]++] =
        EdgeEntry(std::max(from, to), number, from > to);
  });
  for (const std::uint32_t e : end) {
    std::sort(entries + begin, entries + e);
    begin = e;
  }
}

}  // namespace

void check_triangle_count(std::size_t triangles) {
  if (triangles <= kMaxSurfaceHalfEdges / 3) return;
  throw LimitExceeded(fmt::format(
      "{} triangles have more than the {} half-edges a mesh can hold; a coarser spacing "
      "makes fewer",
      triangles, kMaxSurfaceHalfEdges));
}

EdgeBuckets::EdgeBuckets(std::span<const Triangle> triangles, std::size_t vertex_count) {
  check_triangle_count(triangles.size());
  const TriangleCheck found = check_triangles(triangles, vertex_count);
  repeated_index_ = found.repeated_index;
  resize_untouched(end_, vertex_count);
  resize_untouched(entries_, found.half_edges);
  // Each range is a task of its own, whose buckets no other task writes. Both the list and the
  // entries are sorted by range, so the entries of a range begin at the index of its first
  // half-edge in the list.
  const GroupsByRange<HalfEdge> listed(
      triangles.size(), end_.size(), [&](std::size_t t, const auto& emit) {
        for_each_side(triangles[t], [&](unsigned side, std::uint32_t from, std::uint32_t to) {
          emit(HalfEdge(t, side), std::min(from, to) / kVerticesPerRange);
        });
      });
  tbb::parallel_for(std::size_t{0}, listed.ranges(), [&](std::size_t r) {
    const auto of_range = [&](const auto& visit) {
      for (const HalfEdge h : listed.of(r)) {
        const Triangle& triangle = triangles[h.triangle()];
        visit(h.number(), triangle[h.side()], triangle[next_corner(h.side())]);
      }
    };
    const std::size_t first = r * kVerticesPerRange;
    const std::span end(end_.data() + first, std::min(kVerticesPerRange, end_.size() - first));
    fill_buckets(of_range, listed.first(r), first, end, entries_.data());
  });
}

}  // namespace vdwmesh

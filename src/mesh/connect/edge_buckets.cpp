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
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

#include "core/errors.hpp"
#include "core/large_pages.hpp"
#include "mesh/connect/groups_by_range.hpp"
#include "surface/triangle_check.hpp"

namespace vdwmesh {
namespace {

// Buckets up to this size are sorted by insertion, which beats std::sort on short arrays. Closed
// meshes have about six half-edges per vertex, so nearly every bucket is that short.
constexpr std::size_t kInsertionSortLimit = 32;

// Sorts [first, last) by insertion if it is short. An empty bucket is left at once, since its
// pointers may be null, and first + 1 would not be defined.
void sort_bucket(EdgeEntry* first, EdgeEntry* last) {
  if (first == last) return;
  if (static_cast<std::size_t>(last - first) > kInsertionSortLimit) {
    std::sort(first, last);
    return;
  }
  for (EdgeEntry* i = first + 1; i < last; ++i) {
    const EdgeEntry entry = *i;
    EdgeEntry* hole = i;
    for (; hole > first && entry < hole[-1]; --hole) *hole = hole[-1];
    *hole = entry;
  }
}

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
    sort_bucket(entries + begin, entries + e);
    begin = e;
  }
}

// One counting sort over all vertices: the buckets begin with vertex 0, at entries[0].
void fill_on_one_core(std::span<const Triangle> triangles, std::span<std::uint32_t> end,
                      EdgeEntry* entries) {
  const auto all = [&](const auto& visit) {
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for_each_side(triangles[t], [&](unsigned side, std::uint32_t from, std::uint32_t to) {
        visit(static_cast<std::uint32_t>(3 * t + side), from, to);
      });
  };
  fill_buckets(all, 0, 0, end, entries);
}

// Groups half-edges by range of smaller vertices first (`listed`). Then each range is a task of its
// own, whose buckets no other task writes. Both the list and the entries are sorted by range, so
// the entries of a range begin at the index of its first half-edge in the list.
void fill_on_all_cores(std::span<const Triangle> triangles, std::span<std::uint32_t> end,
                       EdgeEntry* entries) {
  const GroupsByRange<HalfEdge> listed(
      triangles.size(), end.size(), [&](std::size_t t, const auto& emit) {
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
    fill_buckets(of_range, listed.first(r), first,
                 end.subspan(first, std::min(kVerticesPerRange, end.size() - first)), entries);
  });
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
  // Both functions give the same buckets, because the order of EdgeEntry has no ties. Grouping by
  // range is an extra pass, which does not pay on a single thread.
  const bool single_threaded =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism) == 1;
  (single_threaded ? fill_on_one_core : fill_on_all_cores)(triangles, end_, entries_.data());
}

}  // namespace vdwmesh

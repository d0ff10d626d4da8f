// Groups half-edges by edge with counting sorts, so without hashing and without a sort of all
// edges. The smaller vertex of a half-edge is its end of lower index. Four steps: check the indices
// and count the half-edges; group the half-edges by range of 8192 smaller vertices (a parallel
// counting sort); within each range, sort by smaller vertex (a counting sort that stays in cache),
// which makes a bucket of the half-edges of one smaller vertex; sort each bucket by larger vertex.
// The result is in compressed-sparse-row form: all entries in one array, and the end of each
// vertex's bucket in another. opposite_half_edges() pairs half-edges with it; the analysis counts
// edges and their faces with it.
#include "mesh/edge_buckets.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/large_pages.hpp"

namespace vdwmesh {
namespace {

// Buckets up to this size are sorted by insertion, which beats std::sort on short arrays. Closed
// meshes have about six half-edges per vertex, so nearly every bucket is that short.
constexpr std::size_t kInsertionSortLimit = 32;
// A range of 8192 vertices has about 49,000 half-edges in a closed mesh: with 3 edges per vertex,
// two half-edges each. As HalfEdge (4 bytes) and as EdgeEntry (8 bytes) they take 600 kB together,
// which the second-level cache of a core can hold.
constexpr std::size_t kVerticesPerRange = 1 << 13;
// Triangles of a block, unless that makes more than kMostBlocks blocks: then blocks are larger.
// The limit bounds the table of counters, which has one counter per range and block.
constexpr std::size_t kTrianglesPerBlock = 1 << 16;
constexpr std::size_t kMostBlocks = 256;

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

// What a first look at the triangles finds. The first two members are indices of triangles. The sum
// of two surveys keeps the left one's index if it has one, because the left survey is of earlier
// triangles. The sum is associative, so a parallel reduction finds the first index of all for any
// number of threads.
struct IndexSurvey {
  std::optional<std::size_t> invalid_index;   // first triangle with an index too large: an error
  std::optional<std::size_t> repeated_index;  // first that names a vertex twice: no error here
  std::size_t half_edges = 0;                 // half-edges whose ends differ

  IndexSurvey operator+(const IndexSurvey& later) const {
    return {invalid_index ? invalid_index : later.invalid_index,
            repeated_index ? repeated_index : later.repeated_index, half_edges + later.half_edges};
  }
};

IndexSurvey survey_indices(std::span<const Triangle> triangles, std::size_t vertex_count) {
  using Range = tbb::blocked_range<std::size_t>;
  return tbb::parallel_reduce(
      Range(0, triangles.size(), kTrianglesPerBlock), IndexSurvey{},
      [&](const Range& range, IndexSurvey found) {
        for (std::size_t t = range.begin(); t < range.end(); ++t) {
          const auto [i, j, k] = triangles[t];
          if (std::max({i, j, k}) >= vertex_count && !found.invalid_index) found.invalid_index = t;
          const unsigned sides = (i != j) + (j != k) + (k != i);
          if (sides < 3 && !found.repeated_index) found.repeated_index = t;
          found.half_edges += sides;
        }
        return found;
      },
      std::plus<>());
}

// An array of counters, one per range. The counter of the range used last is kept outside of the
// array, in value_: neighbouring triangles mostly fall into the same range, and a value in a
// register counts faster than one that goes through memory each time.
class Counters {
 public:
  explicit Counters(std::vector<std::uint32_t> values)
      : values_(std::move(values)), value_(values_.empty() ? 0 : values_[0]) {}

  // Adds one to the counter of a range and returns its value before that.
  std::uint32_t take(std::size_t range) {
    if (range != range_) {
      values_[range_] = value_;
      range_ = range;
      value_ = values_[range];
    }
    return value_++;
  }
  std::uint32_t operator[](std::size_t range) const {
    return range == range_ ? value_ : values_[range];
  }

 private:
  std::vector<std::uint32_t> values_;  // by range; the value for range_ is out of date
  std::size_t range_ = 0;              // the range used last
  std::uint32_t value_;                // counter of range_
};

// The half-edges grouped by the range of their smaller vertex, and in input order within a range.
// It is a parallel counting sort in two passes over blocks of triangles. The first pass counts the
// half-edges of each block and range. An exclusive prefix sum over (range, block) turns the counts
// into positions in the sorted list. The second pass writes each half-edge to its position. The
// blocks depend on the number of triangles alone and the positions on the counts alone, so the
// result does not depend on the number of threads.
class HalfEdgesByRange {
 public:
  HalfEdgesByRange(std::span<const Triangle> triangles, std::size_t vertex_count)
      : triangles_(triangles),
        per_block_(std::max(kTrianglesPerBlock, triangles.size() / kMostBlocks + 1)),
        blocks_((triangles.size() + per_block_ - 1) / per_block_),
        ranges_((vertex_count + kVerticesPerRange - 1) / kVerticesPerRange),
        count_or_position_(ranges_ * blocks_, 0),
        first_of_range_(ranges_ + 1, 0) {
    for_blocks([&](std::size_t b) { count(b); });
    // The prefix sum. exchange() replaces a count by the sum before it and returns the count.
    std::uint32_t sum = 0;
    for (std::size_t r = 0; r < ranges_; ++r) {
      first_of_range_[r] = sum;
      for (std::size_t b = 0; b < blocks_; ++b)
        sum += std::exchange(count_or_position_[r * blocks_ + b], sum);
    }
    first_of_range_[ranges_] = sum;
    resize_untouched(half_edges_, sum);
    for_blocks([&](std::size_t b) { write(b); });
  }

  std::size_t ranges() const { return ranges_; }
  // Index of the range's first half-edge in the sorted list. The EdgeEntry objects of the range
  // begin at the same index in EdgeBuckets::entries_, because both arrays are sorted by range.
  std::uint32_t first(std::size_t range) const { return first_of_range_[range]; }
  std::span<const HalfEdge> of(std::size_t range) const {
    return {half_edges_.data() + first(range), first(range + 1) - first(range)};
  }

 private:
  template <class Body>
  void for_blocks(Body&& body) const {
    tbb::parallel_for(std::size_t{0}, blocks_, body);
  }

  // Calls visit(half-edge, range of its smaller vertex) for the half-edges of block b.
  template <class Visit>
  void visit_half_edges(std::size_t b, Visit&& visit) const {
    const std::size_t end = std::min((b + 1) * per_block_, triangles_.size());
    for (std::size_t t = b * per_block_; t < end; ++t)
      for_each_side(triangles_[t], [&](unsigned side, std::uint32_t from, std::uint32_t to) {
        visit(HalfEdge(t, side), std::min(from, to) / kVerticesPerRange);
      });
  }

  // First pass over block b: counts its half-edges by range.
  void count(std::size_t b) {
    Counters counts(std::vector<std::uint32_t>(ranges_, 0));
    visit_half_edges(b, [&](HalfEdge, std::size_t range) { counts.take(range); });
    for (std::size_t r = 0; r < ranges_; ++r) count_or_position_[r * blocks_ + b] = counts[r];
  }

  // Second pass over block b, after the prefix sum: writes its half-edges to the sorted list.
  void write(std::size_t b) {
    // For each range, the position in the sorted list of the block's next half-edge.
    std::vector<std::uint32_t> positions(ranges_);
    for (std::size_t r = 0; r < ranges_; ++r) positions[r] = count_or_position_[r * blocks_ + b];
    Counters next(std::move(positions));
    visit_half_edges(b, [&](HalfEdge h, std::size_t range) { half_edges_[next.take(range)] = h; });
  }

  std::span<const Triangle> triangles_;
  std::size_t per_block_, blocks_, ranges_;
  // [range][block]: the number of half-edges, later the position of the first of them.
  std::vector<std::uint32_t> count_or_position_;
  std::vector<std::uint32_t> first_of_range_;  // index in half_edges_; the last value is the end
  Buffer<HalfEdge> half_edges_;                // the sorted list
};

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

// Sorts half-edges by range of vertices first (`listed`). Then each range is a task of its own,
// whose buckets no other task writes.
void fill_on_all_cores(std::span<const Triangle> triangles, std::span<std::uint32_t> end,
                       EdgeEntry* entries) {
  const HalfEdgesByRange listed(triangles, end.size());
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

EdgeBuckets::EdgeBuckets(std::span<const Triangle> triangles, std::size_t vertex_count) {
  if (triangles.size() > kMaxSurfaceHalfEdges / 3)
    throw LimitExceeded(
        fmt::format("{} triangles have more than the {} half-edges a mesh can hold; a coarser "
                    "spacing makes fewer",
                    triangles.size(), kMaxSurfaceHalfEdges));
  const IndexSurvey found = survey_indices(triangles, vertex_count);
  // The vertex that the message names is the largest of the triangle, hence one that is too large.
  if (found.invalid_index)
    throw InvalidInput(
        fmt::format("triangle {} names vertex {}, but there are {} vertices", *found.invalid_index,
                    std::ranges::max(triangles[*found.invalid_index]), vertex_count));
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

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

constexpr std::size_t kInsertionSortLimit = 32;
// A range's half-edges, and where they go, stay in the cache of a core.
constexpr std::size_t kVerticesPerRange = 1 << 13;
constexpr std::size_t kTrianglesPerBlock = 1 << 16;  // or more, where that makes too many
constexpr std::size_t kMostBlocks = 256;

void sort_bucket(EdgeEntry* first, EdgeEntry* last) {
  if (first == last) return;  // null where no triangle has an edge
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

// One half-edge of a triangle.
class HalfEdge {
 public:
  HalfEdge() = default;
  HalfEdge(std::size_t triangle, unsigned side)
      : code_(static_cast<std::uint32_t>(triangle) << 2 | side) {}

  std::uint32_t triangle() const { return code_ >> 2; }
  unsigned side() const { return code_ & 3u; }
  std::uint32_t number() const { return 3 * triangle() + side(); }

 private:
  std::uint32_t code_;
};
static_assert(kMaxSurfaceHalfEdges / 3 < std::uint64_t{1} << 30);

constexpr unsigned next_corner(unsigned k) { return k == 2 ? 0 : k + 1; }

// Calls visit(side, from, to) for the sides of a triangle that have two ends.
template <class Visit>
void for_each_side(const Triangle& triangle, Visit&& visit) {
  for (unsigned k = 0; k < 3; ++k) {
    const std::uint32_t from = triangle[k], to = triangle[next_corner(k)];
    if (from != to) visit(k, from, to);
  }
}

struct Findings {
  std::optional<std::size_t> stranger;        // the first triangle that names no vertex
  std::optional<std::size_t> repeated_index;  // and the first that names one twice
  std::size_t half_edges = 0;                 // with two ends

  Findings operator+(const Findings& later) const {
    return {stranger ? stranger : later.stranger,
            repeated_index ? repeated_index : later.repeated_index, half_edges + later.half_edges};
  }
};

Findings look_at(std::span<const Triangle> triangles, std::size_t vertex_count) {
  using Range = tbb::blocked_range<std::size_t>;
  return tbb::parallel_reduce(
      Range(0, triangles.size(), kTrianglesPerBlock), Findings{},
      [&](const Range& range, Findings found) {
        for (std::size_t t = range.begin(); t < range.end(); ++t) {
          const auto [i, j, k] = triangles[t];
          if (std::max({i, j, k}) >= vertex_count && !found.stranger) found.stranger = t;
          const unsigned sides = (i != j) + (j != k) + (k != i);
          if (sides < 3 && !found.repeated_index) found.repeated_index = t;
          found.half_edges += sides;
        }
        return found;
      },
      std::plus<>());
}

// Numbers that count up, one for each range. That of the last range is held apart: it is used many
// times in a row.
class Counters {
 public:
  explicit Counters(std::vector<std::uint32_t> values)
      : values_(std::move(values)), value_(values_.empty() ? 0 : values_[0]) {}

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
  std::vector<std::uint32_t> values_;
  std::size_t range_ = 0;
  std::uint32_t value_;
};

// The half-edges of each range of smaller vertices, in their order: two passes over blocks of
// triangles, each with places of its own.
class HalfEdgesByRange {
 public:
  HalfEdgesByRange(std::span<const Triangle> triangles, std::size_t vertex_count)
      : triangles_(triangles),
        per_block_(std::max(kTrianglesPerBlock, triangles.size() / kMostBlocks + 1)),
        blocks_((triangles.size() + per_block_ - 1) / per_block_),
        ranges_((vertex_count + kVerticesPerRange - 1) / kVerticesPerRange),
        next_(ranges_ * blocks_, 0),
        first_of_range_(ranges_ + 1, 0) {
    for_blocks([&](std::size_t b) { count(b); });
    std::uint32_t sum = 0;
    for (std::size_t r = 0; r < ranges_; ++r) {
      first_of_range_[r] = sum;
      for (std::size_t b = 0; b < blocks_; ++b) sum += std::exchange(next_[r * blocks_ + b], sum);
    }
    first_of_range_[ranges_] = sum;
    resize_untouched(half_edges_, sum);
    for_blocks([&](std::size_t b) { list(b); });
  }

  std::size_t ranges() const { return ranges_; }
  std::uint32_t first(std::size_t range) const { return first_of_range_[range]; }
  std::span<const HalfEdge> of(std::size_t range) const {
    return {half_edges_.data() + first(range), first(range + 1) - first(range)};
  }

 private:
  template <class Body>
  void for_blocks(Body&& body) const {
    tbb::parallel_for(std::size_t{0}, blocks_, body);
  }

  // Calls visit(half-edge, its range) for the half-edges of a block.
  template <class Visit>
  void for_block(std::size_t b, Visit&& visit) const {
    const std::size_t end = std::min((b + 1) * per_block_, triangles_.size());
    for (std::size_t t = b * per_block_; t < end; ++t)
      for_each_side(triangles_[t], [&](unsigned side, std::uint32_t from, std::uint32_t to) {
        visit(HalfEdge(t, side), std::min(from, to) / kVerticesPerRange);
      });
  }

  void count(std::size_t b) {
    Counters counts(std::vector<std::uint32_t>(ranges_, 0));
    for_block(b, [&](HalfEdge, std::size_t range) { counts.take(range); });
    for (std::size_t r = 0; r < ranges_; ++r) next_[r * blocks_ + b] = counts[r];
  }

  void list(std::size_t b) {
    std::vector<std::uint32_t> first(ranges_);
    for (std::size_t r = 0; r < ranges_; ++r) first[r] = next_[r * blocks_ + b];
    Counters next(std::move(first));
    for_block(b, [&](HalfEdge h, std::size_t range) { half_edges_[next.take(range)] = h; });
  }

  std::span<const Triangle> triangles_;
  std::size_t per_block_, blocks_, ranges_;
  std::vector<std::uint32_t> next_;  // [range][block]: how many, then where the next one goes
  std::vector<std::uint32_t> first_of_range_;
  Buffer<HalfEdge> half_edges_;
};

// Buckets of some vertices, from `first_vertex` on; their entries begin at `place`.
// for_each_half_edge(visit) calls visit(number, from, to) for all of theirs. `end` is first how
// many entries each has, then where its next one goes, and so its end when all are there.
template <class ForEach>
void fill_buckets(ForEach&& for_each_half_edge, std::uint32_t place, std::size_t first_vertex,
                  std::span<std::uint32_t> end, EdgeEntry* entries) {
  std::fill(end.begin(), end.end(), 0u);
  for_each_half_edge([&](std::uint32_t, std::uint32_t from, std::uint32_t to) {
    ++end[std::min(from, to) - first_vertex];
  });
  std::uint32_t next = place;
  for (std::uint32_t& e : end) next += std::exchange(e, next);
  for_each_half_edge([&](std::uint32_t number, std::uint32_t from, std::uint32_t to) {
    entries[end[std::min(from, to) - first_vertex]++] =
        EdgeEntry(std::max(from, to), number, from > to);
  });
  std::uint32_t begin = place;
  for (const std::uint32_t e : end) sort_bucket(entries + std::exchange(begin, e), entries + e);
}

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
  const Findings found = look_at(triangles, vertex_count);
  if (found.stranger)
    throw InvalidInput(fmt::format("triangle {} names vertex {}, but there are {} vertices",
                                   *found.stranger, std::ranges::max(triangles[*found.stranger]),
                                   vertex_count));
  repeated_index_ = found.repeated_index;
  resize_untouched(end_, vertex_count);
  resize_untouched(entries_, found.half_edges);
  // Parting the vertices first pays where there is somebody to share with.
  const bool alone =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism) == 1;
  (alone ? fill_on_one_core : fill_on_all_cores)(triangles, end_, entries_.data());
}

}  // namespace vdwmesh

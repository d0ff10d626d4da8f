#include "mesh/edge_buckets.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "core/errors.hpp"
#include "core/large_pages.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kInsertionSortLimit = 32;
constexpr std::size_t kVerticesPerTask = 1 << 14;

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

}  // namespace

EdgeBuckets::EdgeBuckets(std::span<const Triangle> triangles, std::size_t vertex_count) {
  if (triangles.size() > kMaxSurfaceHalfEdges / 3)
    throw LimitExceeded(
        fmt::format("{} triangles have more than the {} half-edges a mesh can hold; a coarser "
                    "spacing makes fewer",
                    triangles.size(), kMaxSurfaceHalfEdges));
  end_.assign(vertex_count, 0);
  count(triangles);
  std::uint32_t sum = 0;
  for (std::uint32_t& end : end_) {
    const std::uint32_t size = end;
    end = sum;
    sum += size;
  }
  entries_.resize(sum);
  advise_large_pages(entries_.data(), entries_.size());
  fill(triangles);
  sort();
}

void EdgeBuckets::count(std::span<const Triangle> triangles) {
  const std::size_t vertex_count = end_.size();
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto [a, b, c] = triangles[t];
    if (std::max({a, b, c}) >= vertex_count)
      throw InvalidInput(fmt::format("triangle {} names vertex {}, but there are {} vertices", t,
                                     std::max({a, b, c}), vertex_count));
    end_[std::min(a, b)] += a != b;
    end_[std::min(b, c)] += b != c;
    end_[std::min(c, a)] += c != a;
    if ((a == b || b == c || c == a) && !repeated_index_) repeated_index_ = t;
  }
}

void EdgeBuckets::fill(std::span<const Triangle> triangles) {
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint32_t from = triangles[t][k];
      const std::uint32_t to = triangles[t][(k + 1) % 3];
      if (from == to) continue;
      entries_[end_[std::min(from, to)]++] =
          EdgeEntry(std::max(from, to), static_cast<std::uint32_t>(3 * t + k), from > to);
    }
  }
}

void EdgeBuckets::sort() {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, end_.size(), kVerticesPerTask),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t v = range.begin(); v < range.end(); ++v) {
                        const std::size_t begin = v == 0 ? 0 : end_[v - 1];
                        sort_bucket(entries_.data() + begin, entries_.data() + end_[v]);
                      }
                    });
}

}  // namespace vdwmesh

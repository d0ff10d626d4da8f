// Exact welding of points with a hash table (open addressing, linear probing) and a small cache in
// front of it. The readers of STL files, whose triangles have no indices, and welded() use it.
#include "mesh/connect/vertex_welder.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "core/large_pages.hpp"
#include "mesh/formats/formats.hpp"

namespace vdwmesh::formats {
namespace {

constexpr std::uint32_t kEmpty = 0xffffffffu;              // no vertex: see check_vertex_limit()
constexpr std::size_t kRecent = std::size_t{1} << 15;      // entries of the cache, 128 KiB
constexpr std::size_t kFirstSlots = std::size_t{1} << 16;  // initial table, 512 KiB

// Multiplicative hash of the bits of all three coordinates, with the constant 2^64 / golden ratio.
// The multiplication mixes bits upwards only. The shift brings the upper half down, because the
// lowest bits of the hash are the index into the table.
std::uint64_t hash_of(const Vec3d& p) {
  const auto mix = [](std::uint64_t h, double value) {
    h = (h ^ std::bit_cast<std::uint64_t>(value)) * 0x9e3779b97f4a7c15u;
    return h ^ (h >> 32);
  };
  return mix(mix(mix(0, p.x), p.y), p.z);
}

// -0 + 0 is 0, and any other number stays as it is. So points that are equal have equal bits, which
// the hash needs.
Vec3d without_negative_zeros(const Vec3d& p) { return {p.x + 0.0, p.y + 0.0, p.z + 0.0}; }

std::uint32_t tag_of(std::uint64_t hash) { return static_cast<std::uint32_t>(hash >> 32); }

}  // namespace

VertexWelder::VertexWelder(Buffer<Vec3d>& positions, std::size_t expected) : positions_(positions) {
  recent_.assign(kRecent, kEmpty);
  positions_.reserve(expected);
  advise_large_pages(positions_.data(), expected);
  rebuild_table(std::max(kFirstSlots, std::bit_ceil(2 * expected)));
}

std::uint32_t VertexWelder::index(const Vec3d& given) {
  const Vec3d p = without_negative_zeros(given);
  return index(p, hash_of(p));
}

// For at most kMost points. The first loop hashes them and prefetches their slots, the second looks
// them up. If the table grows in the second loop, the prefetches that are still pending were for
// the old table, which costs time only.
void VertexWelder::index(std::span<const Vec3d> points, std::span<std::uint32_t> result) {
  std::array<Vec3d, kMost> p;
  std::array<std::uint64_t, kMost> hash;
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    p[i] = without_negative_zeros(points[i]);
    hash[i] = hash_of(p[i]);
    __builtin_prefetch(&slots_[hash[i] & mask]);
  }
  for (std::size_t i = 0; i < points.size(); ++i) result[i] = index(p[i], hash[i]);
}

// Asks the cache first. The index into its 2^15 entries is bits 20 to 34 of the hash, which small
// tables do not use for their own index. The choice of the bits is a matter of speed only: the
// vertex found in the cache is compared with p.
std::uint32_t VertexWelder::index(const Vec3d& p, std::uint64_t hash) {
  std::uint32_t& recent = recent_[(hash >> 20) % kRecent];
  if (recent == kEmpty || !(positions_[recent] == p)) recent = find_or_add(p, hash);
  return recent;
}

// Linear probing. An empty slot always ends the search, because the table is at most half full. The
// table grows fourfold as soon as it is more than half full.
std::uint32_t VertexWelder::find_or_add(const Vec3d& p, std::uint64_t hash) {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = hash & mask;
  for (; slots_[slot].index != kEmpty; slot = (slot + 1) & mask)
    if (slots_[slot].tag == tag_of(hash) && positions_[slots_[slot].index] == p)
      return slots_[slot].index;
  check_vertex_limit(positions_.size() + 1);
  const auto index = static_cast<std::uint32_t>(positions_.size());
  slots_[slot] = {index, tag_of(hash)};
  positions_.push_back(p);
  if (2 * positions_.size() > slots_.size()) rebuild_table(4 * slots_.size());
  return index;
}

// Replaces the table by one of `slots` slots, a power of two that is at least twice the number of
// positions, and inserts all positions. They are all different, so nothing has to be compared.
void VertexWelder::rebuild_table(std::size_t slots) {
  slots_.clear();
  slots_.reserve(slots);
  advise_large_pages(slots_.data(), slots);
  slots_.assign(slots, Slot{kEmpty, 0});
  const std::size_t mask = slots_.size() - 1;
  for (std::uint32_t i = 0; i < positions_.size(); ++i) {
    const std::uint64_t hash = hash_of(positions_[i]);
    std::size_t slot = hash & mask;
    while (slots_[slot].index != kEmpty) slot = (slot + 1) & mask;
    slots_[slot] = {i, tag_of(hash)};
  }
}

}  // namespace vdwmesh::formats

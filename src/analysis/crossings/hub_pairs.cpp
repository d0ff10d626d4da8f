// Hubs are found from a sample of the triangles. The tree of a star divides its triangles by the
// middles of their arcs, in halves; a query walks through its nodes in order, and skips those below
// a node that the cone of the query or its box excludes.
#include "analysis/crossings/hub_pairs.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "analysis/crossings/facet_pair_exact.hpp"
#include "analysis/crossings/facet_tree.hpp"
#include "analysis/survey/mesh_area.hpp"
#include "core/blocks.hpp"
#include "core/monitor.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kSampled = 8;          // one triangle of so many is counted
constexpr std::uint32_t kLeastCounted = 32;  // triangles of a hub
constexpr std::uint32_t kLeafSize = 8;       // spokes
constexpr int kNodesPerQuestion = 256;

// By how much planes are turned away from a cone, and how far beyond them all is for certain.
// Directions are of length 1 and known to a few 2^-53, as are the products with them. A direction
// nearer than kLeastToAxis to 90° from the cone's axis would not be turned away far enough.
constexpr double kTurn = 0x1p-36, kMargin = 0x1p-46, kLeastToAxis = 0.25;

// The triangle of a block that is counted. Triangles may alternate, so it is a different one of
// each block.
std::size_t sampled_of(std::size_t block) {
  constexpr std::uint64_t kMix = 0x9e3779b97f4a7c15u;  // 2^64 over the golden ratio
  return kSampled * block + (block * kMix >> 61);
}

}  // namespace

Buffer<std::uint32_t> hubs_of_triangles(const IndexedMesh& mesh) {
  std::vector<std::uint32_t> counts(mesh.positions.size());
  std::atomic<bool> any = false;
  for_all(mesh.triangle_count() / kSampled, [&](std::size_t block) {
    for (const std::uint32_t v : mesh.triangles[sampled_of(block)]) {
      const std::uint32_t before =
          std::atomic_ref(counts[v]).fetch_add(1, std::memory_order_relaxed);
      if (before + 1 >= kLeastCounted) any.store(true, std::memory_order_relaxed);
    }
  });
  Buffer<std::uint32_t> hubs;
  if (!any) return hubs;
  hubs.resize(mesh.triangle_count());
  for_all(hubs.size(), [&](std::size_t t) {
    hubs[t] = kNoIndex;
    for (const std::uint32_t v : mesh.triangles[t])
      if (counts[v] >= kLeastCounted) hubs[t] = std::min(hubs[t], v);
  });
  return hubs;
}

// The product of b - a instead of b keeps the direction exact where they are near each other.
HubCone::HubCone(std::span<const Vec3d> ends) {
  Vec3d axis{0, 0, 0};
  for (const Vec3d& end : ends) axis = axis + end;
  for (const Vec3d& end : ends)
    if (!(dot(axis, end) >= kLeastToAxis)) return;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    for (std::size_t j = i + 1; j < ends.size(); ++j) {
      const Vec3d normal = unit(cross(ends[i], ends[j] - ends[i]));
      try_plane(normal, axis, ends);
      try_plane(-1.0 * normal, axis, ends);
      if (ends.size() > 2) continue;
      try_plane(cross(ends[i], normal), axis, ends);
      try_plane(cross(normal, ends[j]), axis, ends);
    }
  }
}

void HubCone::try_plane(const Vec3d& normal, const Vec3d& axis, std::span<const Vec3d> ends) {
  const Vec3d turned = normal - kTurn * axis;
  for (const Vec3d& end : ends)
    if (!(dot(turned, end) < -kMargin)) return;
  normals_[count_++] = turned;
}

bool HubCone::excludes(const Box& directions) const {
  for (std::size_t i = 0; i < count_; ++i) {
    double least = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double n = normals_[i][axis];
      least += n * (n > 0 ? directions.lower[axis] : directions.upper[axis]);
    }
    if (least > kMargin) return true;
  }
  return false;
}

HubStar::HubStar(const IndexedMesh& mesh, std::uint32_t hub,
                 std::span<const std::uint32_t> triangles)
    : mesh_(mesh), hub_(hub) {
  spokes_.reserve(triangles.size());
  for (const std::uint32_t t : triangles) {
    const Facet facet = facet_of(t);
    if (!has_area(facet) && is_flat_exactly(facet)) continue;
    Triangle v = mesh.triangles[t];
    std::rotate(v.begin(), std::find(v.begin(), v.end(), hub), v.end());
    spokes_.push_back({{direction_of(v[1]), direction_of(v[2])}, t});
    include(box_, box_of(mesh, t));
  }
  if (!spokes_.empty()) build(0, static_cast<std::uint32_t>(spokes_.size()));
}

// From the hub, of length 1. Not a number where the vertex lies there, or beyond all doubles.
Vec3d HubStar::direction_of(std::uint32_t vertex) const {
  const Vec3d d = mesh_.positions[vertex] - mesh_.positions[hub_];
  const double longest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
  return unit({d.x / longest, d.y / longest, d.z / longest});
}

Facet HubStar::facet_of(std::uint32_t triangle) const {
  const auto& [a, b, c] = corners_of(mesh_, triangle);
  return make_facet(mesh_.triangles[triangle], a, b, c);
}

// The box of directions of an arc is the whole cube where an end is not a number.
void HubStar::build(std::uint32_t first, std::uint32_t end) {
  const std::size_t place = nodes_.size();
  nodes_.emplace_back();
  const auto is_known = [](const Vec3d& v) { return dot(v, v) >= 0; };
  Box directions = empty_box(), box = empty_box(), middles = empty_box();
  for (std::uint32_t i = first; i < end; ++i) {
    const Spoke& spoke = spokes_[i];
    const Vec3d middle = spoke.ends[0] + spoke.ends[1];
    include(box, box_of(mesh_, spoke.triangle));
    include(directions, spoke.ends[0]);
    include(directions, spoke.ends[1]);
    if (is_known(middle))
      include(middles, middle);
    else
      include(directions, Box{{-1, -1, -1}, {1, 1, 1}});
  }
  if (end - first > kLeafSize) {
    const Vec3d side = middles.upper - middles.lower;
    const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    const auto key = [axis, is_known](const Spoke& spoke) {
      const Vec3d middle = spoke.ends[0] + spoke.ends[1];
      return std::pair(is_known(middle) ? middle[axis] : 3, spoke.triangle);
    };
    const std::uint32_t half = first + (end - first) / 2;
    std::nth_element(spokes_.begin() + first, spokes_.begin() + half, spokes_.begin() + end,
                     [key](const Spoke& a, const Spoke& b) { return key(a) < key(b); });
    build(first, half);
    build(half, end);
  }
  nodes_[place] = {.directions = directions,
                   .box = box,
                   .first = first,
                   .end = end,
                   .next = static_cast<std::uint32_t>(nodes_.size())};
}

void HubStar::join_own(std::size_t place, Monitor* monitor, TrianglePairs& found) const {
  const Spoke& spoke = spokes_[place];
  join(HubCone(spoke.ends), spoke.triangle, place + 1, monitor, found);
}

void HubStar::join_other(std::uint32_t triangle, Monitor* monitor, TrianglePairs& found) const {
  const Facet facet = facet_of(triangle);
  if (!has_area(facet) && is_flat_exactly(facet)) return;
  std::array<Vec3d, 3> ends;
  std::transform(facet.vertex.begin(), facet.vertex.end(), ends.begin(),
                 [this](std::uint32_t v) { return direction_of(v); });
  join(HubCone(ends), triangle, 0, monitor, found);
}

// Appends the pairs of the triangle, whose cone is given, and the spokes from `from` on.
void HubStar::join(const HubCone& cone, std::uint32_t triangle, std::size_t from, Monitor* monitor,
                   TrianglePairs& found) const {
  const Facet facet = facet_of(triangle);
  const Box box = box_of(mesh_, triangle);
  int visited = 0;
  for (std::size_t n = 0; n < nodes_.size();) {
    if (++visited % kNodesPerQuestion == 0) advance(monitor, 0);
    const StarNode& node = nodes_[n];
    const bool is_leaf = node.end - node.first <= kLeafSize;
    const bool is_out = node.end <= from || !meet(node.box, box) || cone.excludes(node.directions);
    n = is_out || is_leaf ? node.next : n + 1;
    if (is_out || !is_leaf) continue;
    for (std::size_t i = std::max<std::size_t>(node.first, from); i < node.end; ++i) {
      const std::uint32_t other = spokes_[i].triangle;
      if (meet(box_of(mesh_, other), box) && do_intersect(facet, facet_of(other)))
        found.push_back(std::minmax(triangle, other));
    }
  }
}

}  // namespace vdwmesh

// PowerCell::cut(): removes a half-space from the cell. Included by power_cell.hpp alone.
//
// 1. measure_depths() finds how far every vertex lies beyond the plane, some vertices at a time.
//    Most planes of a crowded ball cut nothing off, and end here.
// 2. find_removed() lists the vertices beyond the plane, and the border: the edges that lead from
//    one of them to one that stays. Each of these edges has one vertex of the new face.
// 3. make_vertices() computes the new vertices, in slots that were free before this cut, since what
//    is removed is still needed.
// 4. link_vertices() links them to a ring: two of them are neighbours if they share an old plane
//    beside the new one.
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <utility>

#include "arrangement/arcs/power_cell.hpp"

namespace vdwmesh::arcs {

// The x coordinate of free slots.
inline constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();

// The walls of the tetrahedron stand a little outside the unit ball. Their directions have no
// symmetry, so that they are parallel to none of the planes of a lattice.
inline void PowerCell::reset() {
  constexpr double kDistance = 1.0625;
  constexpr std::array<Vec3d, kWalls> kAxes{
      {{-0.17659320681185342, 0.97617922034458771, -0.1260514540786391},
       {0.53844537614247978, -0.13669188708020807, 0.8314997924938019},
       {0.50709871624210445, -0.35135763095403183, -0.78701887344331234},
       {-0.86895088557273081, -0.4881297023103478, 0.081570535028149538}}};
  // Vertex i is opposite to plane i, so an edge that leaves plane i runs to vertex i.
  constexpr std::array<std::uint32_t, 4 * kWalls> kPlanes{3, 2, 1, 3, 3, 0, 2, 3,
                                                          3, 1, 0, 3, 2, 0, 1, 2};
  constexpr std::array<EdgeEnd, 4 * kWalls> kTwins{
      0, end_of(2, 2), end_of(1, 1), end_of(3, 1), 0, end_of(0, 2), end_of(2, 1), end_of(3, 2),
      0, end_of(1, 2), end_of(0, 1), end_of(3, 3), 0, end_of(0, 3), end_of(1, 3), end_of(2, 3)};
  if (planes_.empty()) {
    planes_.resize(64);
    open_.assign(64, kNone);
  }
  plane_count_ = kWalls;
  reserve(kWalls);
  static_assert(kWalls % kLanes == 0);
  for (std::size_t i = kWalls; i < slots_; i += kLanes) store_lanes(&x_[i], all_lanes(kNowhere));
  slots_ = alive_ = kWalls;
  free_count_ = 0;
  for (std::uint32_t i = 0; i < kWalls; ++i) {
    planes_[i] = {kAxes[i], kDistance};
    const Vec3d corner = -3 * kDistance * kAxes[i];
    store_lanes(position_[i].at, Lanes{corner.x, corner.y, corner.z, 0});
    x_[i] = corner.x;
    y_[i] = corner.y;
    z_[i] = corner.z;
  }
  std::copy(kPlanes.begin(), kPlanes.end(), plane_.begin());
  std::copy(kTwins.begin(), kTwins.end(), twin_.begin());
  doubts_ = 0;
  reach_is_stale_ = true;
}

// Makes room for so many vertices, and for the lanes behind the last of them.
inline void PowerCell::reserve(std::size_t vertices) {
  const std::size_t least = vertices + kStep;
  if (x_.size() >= least) return;
  x_.resize(2 * least, kNowhere);
  for (std::vector<double>* v : {&y_, &z_, &depth_}) v->resize(2 * least);
  for (std::vector<std::uint32_t>* v : {&plane_, &twin_}) v->resize(8 * least);
  position_.resize(2 * least);
  // Three edges a vertex, and one that is written but not kept.
  border_.resize(6 * least + 1);
  links_.resize(border_.size());
  // Free slots, and four for each step of list_slots().
  free_.resize(border_.size() + 2 * least + 4);
  removed_.resize(free_.size());
}

// Fills depth_, the signed distances of the vertices beyond the plane, and returns the largest.
VDWMESH_INLINE double PowerCell::measure_depths(const Cap& cap) {
  const Lanes ax = all_lanes(cap.axis.x), ay = all_lanes(cap.axis.y), az = all_lanes(cap.axis.z),
              distance = all_lanes(cap.cosine);
  const double *x = x_.data(), *y = y_.data(), *z = z_.data();
  double* depths = depth_.data();
  Lanes most = all_lanes(-4);
  const auto measure = [&](std::size_t i) {
    const Lanes depth =
        ax * lanes_at(x + i) + ay * lanes_at(y + i) + az * lanes_at(z + i) - distance;
    store_lanes(depths + i, depth);
    most = depth > most ? depth : most;
  };
  for (std::size_t i = 0, count = slots_; i < count; i += kStep) {
    measure(i);
    measure(i + kLanes);
  }
  return largest_of(most);
}

// Lists the vertices beyond the plane and the edges that lead from them to those that stay, and
// raises the doubts about vertices that all but lie on it. Returns whether there are vertices to
// remove; their slots look free from now on. A bit for each of 64 vertices says whether it lies
// beyond; lane k has those of every fourth vertex from k on.
VDWMESH_INLINE bool PowerCell::find_removed(const Cap& cap) {
  constexpr std::uint32_t kBits = 64;
  std::uint32_t* const places = removed_.data();
  BorderEdge* const border = border_.data();
  const EdgeEnd* const twins = twin_.data();
  const double* const depths = depth_.data();
  double* const x = x_.data();
  std::uint32_t removed = 0, found = 0;
  Lanes nearest = all_lanes(4);
  for (std::uint32_t start = 0, count = slots_; start < count; start += kBits) {
    LaneBits beyond{0, 0, 0, 0}, bit{1, 2, 4, 8};
    const std::uint32_t end = start + kBits < count ? start + kBits : count;
    const auto look_at = [&](std::uint32_t i) {
      const Lanes depth = lanes_at(depths + i), size = depth < 0 ? -depth : depth;
      nearest = size < nearest ? size : nearest;
      beyond |= (depth > kSlack) & bit;
      bit <<= kLanes;
    };
    for (std::uint32_t i = start; i < end; i += kStep) {
      look_at(i);
      look_at(i + kLanes);
    }
    auto bits = static_cast<std::uint64_t>(beyond[0] | beyond[1] | beyond[2] | beyond[3]);
    for (; bits != 0; bits &= bits - 1) {
      const std::uint32_t from = start + static_cast<std::uint32_t>(std::countr_zero(bits));
      places[removed++] = from;
      x[from] = kNowhere;
      for (std::uint32_t side = 1; side <= 3; ++side) {
        const EdgeEnd removed_end = end_of(from, side), kept = twins[removed_end];
        border[found] = {removed_end, kept};
        found += !(depths[vertex_of(kept)] > kSlack);
      }
    }
  }
  removed_count_ = removed;
  border_count_ = found;
  if (-largest_of(-nearest) < kNearby) doubt_near(cap);
  return removed > 0;
}

// Vertices far outside the ball may be in doubt: its measures do not depend on them. But if they
// are, because the plane all but coincides with one of theirs, nobody knows where the two planes
// cross, and it may be inside. If the plane runs along an edge, a corner of the patch may have
// three circles, which is of no account for the measures. If even the vertex that stays deepest
// inside is on the plane but for rounding, or the one that goes first, then the cell is nearly or
// quite gone.
inline void PowerCell::doubt_near(const Cap& cap) {
  constexpr double kOutside = 1 + 1e-6;  // squared distance
  double least = 4;
  for (std::uint32_t i = 0; i < slots_; ++i) {
    least = depth_[i] < least ? depth_[i] : least;
    if (!(std::abs(depth_[i]) < kNearby)) continue;
    const bool touches = std::abs(depth_[i]) < kTouching;
    const Vec3d v = vertex(i);
    if (touches && inner(v, v) < kOutside) doubts_ |= kThirdCircle;
    for (std::uint32_t k = 1; k <= 3; ++k) {
      const EdgeEnd end = end_of(i, k);
      if (std::abs(depth_[vertex_of(twin_[end])]) < kNearby) doubts_ |= kAlongEdge;
      const Vec3d normal = cross(cap.axis, planes_[plane_[end]].axis);
      if (touches && inner(normal, normal) < kNearlyParallel) doubts_ |= kParallelPlanes;
    }
  }
  if (removed_count_ > 0 && std::abs(least) < kTouching) doubts_ |= kVanishing;
}

VDWMESH_INLINE std::uint32_t PowerCell::add_plane(const Cap& cap) {
  const std::uint32_t plane = plane_count_++;
  if (plane == planes_.size()) {
    planes_.resize(2 * planes_.size());
    open_.resize(planes_.size(), kNone);
  }
  planes_[plane] = cap;
  return plane;
}

// Lists slots for the new vertices: the free ones, and behind them as many unused ones as needed.
VDWMESH_INLINE void PowerCell::list_slots() {
  using FourNumbers = std::uint32_t __attribute__((vector_size(16)));
  FourNumbers more{0, 1, 2, 3};
  more += slots_;
  std::uint32_t listed = free_count_;
  do {  // four at a time; mostly they are enough
    std::memcpy(&free_[listed], &more, sizeof more);
    more += 4;
    listed += 4;
  } while (listed < border_count_);
}

// A new vertex stands where the plane meets the edge: between its ends, so that it is as near to
// the edge's own planes as they are. It has the new plane, which the old edge leaves there, and the
// two planes of the edge, in the order of the removed end.
//
// Each of the other two edges lies in the new plane and in one of the two old ones, and leaves the
// other. An old plane at the border has two new vertices, of which it follows the new plane at one
// and precedes it at the other. The first leaves its end of the common edge in open_, and the
// second will look there for it.
VDWMESH_INLINE void PowerCell::make_vertices(std::uint32_t plane) {
  double *const x = x_.data(), *const y = y_.data(), *const z = z_.data();
  const double* const depths = depth_.data();
  Position* const positions = position_.data();
  std::uint32_t* const planes = plane_.data();
  EdgeEnd *const twins = twin_.data(), *const open = open_.data();
  const BorderEdge* const border = border_.data();
  const std::uint32_t* const slots = free_.data();
  HalfLink* const links = links_.data();
  for (std::uint32_t i = 0, count = border_count_; i < count; ++i) {
    const auto [removed, kept] = border[i];
    const std::uint32_t from = vertex_of(removed), to = vertex_of(kept), number = slots[i];
    // A vertex that stays may lie beyond the plane by up to kSlack.
    const double inside = depths[to] < 0 ? depths[to] : 0, share = inside / (inside - depths[from]);
    const Lanes start = lanes_at(positions[to].at), end = lanes_at(positions[from].at),
                position = start + all_lanes(share) * (end - start);
    store_lanes(positions[number].at, position);
    x[number] = position[0];
    y[number] = position[1];
    z[number] = position[2];
    const std::uint32_t following = planes[kept - 1], preceding = planes[removed - 1];
    const EdgeEnd first = end_of(number, 1);
    planes[first - 1] = preceding;
    planes[first] = plane;
    planes[first + 1] = following;
    planes[first + 2] = preceding;
    twins[first] = kept;
    twins[kept] = first;
    open[following] = first + 2;
    links[i] = {preceding, first + 1};
  }
}

// Returns whether every edge found its other end. As many ends look for others as were left in
// open_, and each takes what it finds away; so if none is missing, none was left twice.
VDWMESH_INLINE bool PowerCell::link_vertices() {
  const HalfLink* const links = links_.data();
  EdgeEnd *const twins = twin_.data(), *const open = open_.data();
  std::uint32_t missing = 0;
  for (std::uint32_t i = 0, count = border_count_; i < count; ++i) {
    const auto [plane, own] = links[i];
    const EdgeEnd other = open[plane];
    open[plane] = kNone;
    missing += other == kNone;
    twins[own] = other;
    twins[other] = own;
  }
  return missing == 0;
}

// The slots of the removed vertices are free from now on, beside those that nobody took.
VDWMESH_INLINE void PowerCell::free_removed() {
  const std::uint32_t taken = free_count_ < border_count_ ? free_count_ : border_count_;
  slots_ += border_count_ - taken;
  alive_ += border_count_ - removed_count_;
  std::uint32_t free = removed_count_;
  for (std::uint32_t i = taken; i < free_count_; ++i) removed_[free++] = free_[i];
  std::swap(free_, removed_);
  free_count_ = free;
}

// Moves vertices from the end of the list to free slots.
inline void PowerCell::finish() {
  if (alive_ == 0) slots_ = free_count_ = 0;
  for (std::uint32_t i = 0; i < free_count_; ++i) {
    while (std::isnan(x_[slots_ - 1])) --slots_;
    if (free_[i] < slots_) move_vertex(--slots_, free_[i]);
  }
  free_count_ = 0;
}

inline void PowerCell::move_vertex(std::uint32_t from, std::uint32_t to) {
  x_[to] = x_[from];
  y_[to] = y_[from];
  z_[to] = z_[from];
  position_[to] = position_[from];
  for (std::uint32_t side = 0; side <= 3; ++side) {
    plane_[end_of(to, side)] = plane_[end_of(from, side)];
  }
  for (std::uint32_t side = 1; side <= 3; ++side) {
    const EdgeEnd twin = twin_[end_of(from, side)];
    twin_[end_of(to, side)] = twin;
    twin_[twin] = end_of(to, side);
  }
  x_[from] = kNowhere;
}

inline bool PowerCell::cut(const Cap& cap) {
  // A NaN in the axis always comes with a NaN in the cosine.
  if (!(std::abs(cap.cosine) < 1)) {
    doubts_ |= kNotFinite;
    return false;
  }
  if (std::abs(cap.cosine) > 1 - kTouching) doubts_ |= kNearlyTangent;
  if (alive_ == 0 || measure_depths(cap) <= -kNearby || !find_removed(cap)) return false;
  reach_is_stale_ = true;
  if (removed_count_ == alive_) {
    alive_ = 0;
    return true;
  }
  reserve(slots_ + border_count_);
  list_slots();
  make_vertices(add_plane(cap));
  if (!link_vertices()) {
    doubts_ |= kDamaged;  // links lead nowhere: nothing can be done with this cell
    std::fill(open_.begin(), open_.end(), kNone);
    std::fill(x_.begin(), x_.end(), kNowhere);
    alive_ = 0;
    return true;
  }
  free_removed();
  return true;
}

// kSlack covers the rounding of the squares and of the root.
inline double PowerCell::reach() {
  if (!reach_is_stale_) return reach_;
  Lanes most = all_lanes(0);
  for (std::size_t i = 0; i < slots_; i += kLanes) {
    const Lanes x = lanes_at(&x_[i]), y = lanes_at(&y_[i]), z = lanes_at(&z_[i]);
    const Lanes squared = x * x + y * y + z * z;
    most = squared > most ? squared : most;
  }
  reach_ = std::sqrt(largest_of(most)) + kSlack;
  reach_is_stale_ = false;
  return reach_;
}

}  // namespace vdwmesh::arcs

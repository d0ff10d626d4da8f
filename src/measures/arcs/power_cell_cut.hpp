// PowerCellIn<Room>::cut(): removes a half-space from the cell. Included by power_cell.hpp alone.
// The cell is the power cell of one ball, scaled to radius 1 at the origin. The half-space is given
// by the cap that it cuts from this unit ball: x · axis > cosine.
//
// 1. measure_depths() finds how far every vertex lies beyond the plane, kStep vertices at a time.
//    Most planes of a ball with many neighbours cut nothing off; then this is the only step.
// 2. find_removed() lists the vertices beyond the plane, and the border: the edges that lead from
//    one of them to a vertex that stays. On each of these edges lies one vertex of the new face.
// 3. make_vertices() computes the new vertices. It puts them into slots that were free before this
//    cut, because the removed vertices are still read.
// 4. link_vertices() links the new vertices to a ring: two of them are neighbours if they share an
//    old plane beside the new one.
// 5. free_removed() frees the slots of the removed vertices.
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <utility>

#include "measures/arcs/power_cell.hpp"

namespace vdwmesh::arcs {

// The cell begins as a tetrahedron around the ball, whose faces are the walls: a regular
// tetrahedron turned by arbitrary angles, so that the walls are parallel to no plane of a lattice.
template <class Room>
inline void PowerCellIn<Room>::reset() {
  constexpr double kDistance = 1.0625;
  constexpr std::array<Vec3d, kWalls> kAxes{
      {{-0.17659320681185342, 0.97617922034458771, -0.1260514540786391},
       {0.53844537614247978, -0.13669188708020807, 0.8314997924938019},
       {0.50709871624210445, -0.35135763095403183, -0.78701887344331234},
       {-0.86895088557273081, -0.4881297023103478, 0.081570535028149538}}};
  // Three planes meet at a vertex; each of its edges lies in two of them and leaves the third.
  // Vertex i is opposite to plane i, so an edge that leaves plane i runs to vertex i. Entries 1, 2
  // and 3 of a vertex are its edges counter-clockwise; entry 0 of kPlanes repeats entry 3.
  constexpr std::array<std::uint32_t, 4 * kWalls> kPlanes{3, 2, 1, 3, 3, 0, 2, 3,
                                                          3, 1, 0, 3, 2, 0, 1, 2};
  constexpr std::array<EdgeEnd, 4 * kWalls> kTwins{
      0, end_of(2, 2), end_of(1, 1), end_of(3, 1), 0, end_of(0, 2), end_of(2, 1), end_of(3, 2),
      0, end_of(1, 2), end_of(0, 1), end_of(3, 3), 0, end_of(0, 3), end_of(1, 3), end_of(2, 3)};
  plane_count_ = kWalls;
  room_.reserve(kWalls, kWalls);
  static_assert(kWalls % kLanes == 0);
  for (std::size_t i = kWalls; i < slots_; i += kLanes)
    store_lanes(&room_.x[i], all_lanes(kNowhere));  // NaN marks a free slot
  slots_ = alive_ = kWalls;
  free_count_ = 0;
  for (std::uint32_t i = 0; i < kWalls; ++i) {
    room_.planes[i] = {kAxes[i], kDistance};
    const Vec3d corner = -3 * kDistance * kAxes[i];
    store_lanes(room_.position[i].at, Lanes{corner.x, corner.y, corner.z, 0});
    room_.x[i] = corner.x;
    room_.y[i] = corner.y;
    room_.z[i] = corner.z;
  }
  std::copy(kPlanes.begin(), kPlanes.end(), room_.plane_left.begin());
  std::copy(kTwins.begin(), kTwins.end(), room_.twin.begin());
  doubts_ = 0;
  reach_is_stale_ = true;
  overflowed_ = false;
}

// Fills the depths, the signed distances of the vertices beyond the plane, and returns the largest.
// Depths of free slots are NaN, which no comparison finds larger.
template <class Room>
VDWMESH_INLINE double PowerCellIn<Room>::measure_depths(const Cap& cap) {
  const Lanes ax = all_lanes(cap.axis.x), ay = all_lanes(cap.axis.y), az = all_lanes(cap.axis.z),
              distance = all_lanes(cap.cosine);
  const double *x = room_.x.data(), *y = room_.y.data(), *z = room_.z.data();
  double* depths = room_.depth.data();
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

// Lists the vertices beyond the plane and the border, and raises doubts about vertices that nearly
// lie on the plane. Returns whether there are vertices to remove, and marks their slots free.
// Vertices are handled 64 at a time, with a bit for each that says whether it lies beyond; lane k
// computes the bits of vertices k, k + 4, k + 8 and so on.
template <class Room>
VDWMESH_INLINE bool PowerCellIn<Room>::find_removed(const Cap& cap) {
  constexpr std::uint32_t kBits = 64;
  constexpr bool kAllHaveBits = Room::kMostVertices <= kBits;
  std::uint32_t* const places = room_.removed.data();
  BorderEdge* const border = room_.border.data();
  const EdgeEnd* const twins = room_.twin.data();
  const double* const depths = room_.depth.data();
  double* const x = room_.x.data();
  std::uint32_t removed = 0, found = 0;
  Lanes nearest = all_lanes(4);
  const auto list_from = [&](std::uint32_t start, std::uint32_t end) {
    LaneBits beyond{0, 0, 0, 0}, bit{1, 2, 4, 8};
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
    const auto all = static_cast<std::uint64_t>(beyond[0] | beyond[1] | beyond[2] | beyond[3]);
    const auto stays = [&](std::uint32_t v) -> std::uint32_t {
      if constexpr (kAllHaveBits) {
        return ~static_cast<std::uint32_t>(all >> v) & 1;
      } else {
        return !(depths[v] > kSlack);
      }
    };
    for (std::uint64_t bits = all; bits != 0; bits &= bits - 1) {
      const std::uint32_t from = start + static_cast<std::uint32_t>(std::countr_zero(bits));
      places[removed++] = from;
      x[from] = kNowhere;
      for (std::uint32_t side = 1; side <= 3; ++side) {
        const EdgeEnd removed_end = end_of(from, side), kept = twins[removed_end];
        border[found] = {removed_end, kept};
        found += stays(vertex_of(kept));
      }
    }
  };
  if constexpr (kAllHaveBits) {
    list_from(0, slots_);
  } else {
    for (std::uint32_t start = 0; start < slots_; start += kBits) {
      list_from(start, start + kBits < slots_ ? start + kBits : slots_);
    }
  }
  removed_count_ = removed;
  border_count_ = found;
  if (-largest_of(-nearest) < kNearby) doubt_near(cap);
  return removed > 0;
}

// Finds the doubts about vertices near the plane.
// - Whether a vertex is cut off matters only if it lies in the ball or on it: area and volume of
// the
//   ball do not depend on other vertices (kThirdCircle).
// - If the plane is also nearly parallel to a plane of the vertex, rounding decides where the two
//   planes cross, and that may be inside the ball wherever the vertex is (kParallelPlanes).
// - If the plane nearly contains an edge, three circles may meet in a corner of the patch. That
//   does not affect area and volume (kAlongEdge).
// - If even the vertex of least depth lies within kTouching of the plane, rounding decides whether
//   anything of the cell is left (kVanishing).
template <class Room>
inline void PowerCellIn<Room>::doubt_near(const Cap& cap) {
  constexpr double kOutside = 1 + 1e-6;  // squared distance
  double least = 4;
  for (std::uint32_t i = 0; i < slots_; ++i) {
    least = room_.depth[i] < least ? room_.depth[i] : least;
    if (!(std::abs(room_.depth[i]) < kNearby)) continue;
    const bool touches = std::abs(room_.depth[i]) < kTouching;
    const Position& at = room_.position[i];
    const Vec3d v{at.at[0], at.at[1], at.at[2]};
    if (touches && inner(v, v) < kOutside) doubts_ |= kThirdCircle;
    for (std::uint32_t k = 1; k <= 3; ++k) {
      const EdgeEnd end = end_of(i, k);
      if (std::abs(room_.depth[vertex_of(room_.twin[end])]) < kNearby) doubts_ |= kAlongEdge;
      const Vec3d normal = cross(cap.axis, room_.planes[room_.plane_left[end]].axis);
      if (touches && inner(normal, normal) < kNearlyParallel) doubts_ |= kParallelPlanes;
    }
  }
  if (removed_count_ > 0 && std::abs(least) < kTouching) doubts_ |= kVanishing;
}

// Lists slots for the new vertices: the free ones, then as many unused ones as are needed.
template <class Room>
VDWMESH_INLINE void PowerCellIn<Room>::list_slots() {
  using FourNumbers = std::uint32_t __attribute__((vector_size(16)));
  FourNumbers more{0, 1, 2, 3};
  more += slots_;
  std::uint32_t listed = free_count_;
  do {  // four at a time, which is enough in most cuts
    std::memcpy(&room_.free[listed], &more, sizeof more);
    more += 4;
    listed += 4;
  } while (listed < border_count_);
}

// A new vertex lies where the plane meets an edge of the border. It is interpolated between the
// ends of the edge, so it is as near to the edge's planes as they are. Its three planes are the new
// plane, which the old edge leaves there, and the two planes of the edge, in the order that they
// have at the removed end.
//
// Two further edges begin at the new vertex, both in the new plane: each lies in one of the old
// planes and leaves the other. An old plane at the border has two new vertices. Counter-clockwise
// around one of them it comes after the new plane, around the other before it. The first vertex
// stores its end of their common edge in room_.open, where link_vertices() finds it for the second.
template <class Room>
VDWMESH_INLINE void PowerCellIn<Room>::make_vertices(std::uint32_t plane) {
  double *const x = room_.x.data(), *const y = room_.y.data(), *const z = room_.z.data();
  const double* const depths = room_.depth.data();
  Position* const positions = room_.position.data();
  std::uint32_t* const planes = room_.plane_left.data();
  EdgeEnd *const twins = room_.twin.data(), *const open = room_.open.data();
  const BorderEdge* const border = room_.border.data();
  const std::uint32_t* const slots = room_.free.data();
  HalfLink* const links = room_.links.data();
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

// Links the edges of the new face, and returns whether each has found its other end. If two ends
// were stored for one plane, the second has replaced the first, and one edge of `links` finds none.
// A missing end is kNone, the unused side 0 of vertex 0, so it does no harm to write there.
template <class Room>
VDWMESH_INLINE bool PowerCellIn<Room>::link_vertices() {
  const HalfLink* const links = room_.links.data();
  EdgeEnd *const twins = room_.twin.data(), *const open = room_.open.data();
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

// Updates the list of free slots: those that the new vertices did not take, and those of the
// removed vertices.
template <class Room>
VDWMESH_INLINE void PowerCellIn<Room>::free_removed() {
  std::uint32_t* const free = room_.free.data();
  const std::uint32_t* const removed = room_.removed.data();
  std::uint32_t left = 0;
  for (std::uint32_t i = border_count_; i < free_count_; ++i) free[left++] = free[i];
  const std::uint32_t reused = free_count_ - left;
  slots_ += border_count_ - reused;
  alive_ += border_count_ - removed_count_;
  free_count_ = left + removed_count_;
  for (std::uint32_t i = 0; i < removed_count_; i += 4) {  // four at a time, in most cuts all
    std::memcpy(free + left + i, removed + i, 4 * sizeof *free);
  }
}

// Moves vertices from the last slots to free slots before them, so that no slot is free.
template <class Room>
inline CellView PowerCellIn<Room>::finish() {
  if (alive_ > 0) {
    for (std::uint32_t i = 0; i < free_count_; ++i) {
      while (std::isnan(room_.x[slots_ - 1])) --slots_;
      if (room_.free[i] < slots_) move_vertex(--slots_, room_.free[i]);
    }
    free_count_ = 0;
  }
  return {alive_,
          plane_count_,
          doubts_,
          room_.x.data(),
          room_.y.data(),
          room_.z.data(),
          room_.position.data(),
          room_.plane_left.data(),
          room_.twin.data(),
          room_.planes.data()};
}

template <class Room>
inline void PowerCellIn<Room>::move_vertex(std::uint32_t from, std::uint32_t to) {
  room_.x[to] = room_.x[from];
  room_.y[to] = room_.y[from];
  room_.z[to] = room_.z[from];
  room_.position[to] = room_.position[from];
  for (std::uint32_t side = 0; side <= 3; ++side) {
    room_.plane_left[end_of(to, side)] = room_.plane_left[end_of(from, side)];
  }
  for (std::uint32_t side = 1; side <= 3; ++side) {
    const EdgeEnd twin = room_.twin[end_of(from, side)];
    room_.twin[end_of(to, side)] = twin;
    room_.twin[twin] = end_of(to, side);
  }
  room_.x[from] = kNowhere;
}

template <class Room>
inline bool PowerCellIn<Room>::cut(const Cap& cap) {
  // A NaN in the axis always comes with a NaN in the cosine.
  if (!(std::abs(cap.cosine) <= 1 - kTouching)) {
    // Callers pass planes that meet the ball, so another cosine comes from an overflow.
    doubts_ |= std::abs(cap.cosine) < 1 ? kNearlyTangent : kNotFinite;
    if (!(std::abs(cap.cosine) < 1)) return false;
  }
  if (alive_ == 0 || measure_depths(cap) <= -kNearby || !find_removed(cap)) return false;
  reach_is_stale_ = true;
  if (removed_count_ == alive_) {
    alive_ = 0;
    return true;
  }
  if (!room_.reserve(slots_ + border_count_, plane_count_ + 1)) {
    overflowed_ = true;
    alive_ = 0;
    return true;
  }
  room_.planes[plane_count_] = cap;
  list_slots();
  make_vertices(plane_count_++);
  if (!link_vertices()) {
    doubts_ |= kDamaged;  // links lead nowhere: nothing can be done with this cell
    std::fill(room_.open.begin(), room_.open.end(), kNone);
    std::fill(room_.x.begin(), room_.x.end(), kNowhere);
    alive_ = 0;
    return true;
  }
  free_removed();
  return true;
}

// The largest distance of a vertex from the centre. kSlack covers the rounding of the squares and
// of the root.
template <class Room>
inline double PowerCellIn<Room>::reach() {
  if (!reach_is_stale_) return reach_;
  Lanes most = all_lanes(0);
  for (std::size_t i = 0; i < slots_; i += kLanes) {
    const Lanes x = lanes_at(&room_.x[i]), y = lanes_at(&room_.y[i]), z = lanes_at(&room_.z[i]);
    const Lanes squared = x * x + y * y + z * z;
    most = squared > most ? squared : most;
  }
  reach_ = std::sqrt(largest_of(most)) + kSlack;
  reach_is_stale_ = false;
  return reach_;
}

}  // namespace vdwmesh::arcs

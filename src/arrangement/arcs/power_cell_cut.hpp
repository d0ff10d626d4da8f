// PowerCell::cut(): removes a half-space from the cell. Included by power_cell.hpp alone.
//
// 1. measure_depths() finds how far every vertex lies beyond the plane, some vertices at a time.
//    Most planes of a crowded ball cut nothing off, and end here.
// 2. find_removed() lists the vertices beyond the plane, and the border: the edges that lead from
//    one of them to one that stays. Each of these edges has one vertex of the new face.
// 3. make_vertices() computes the new vertices and links them to a ring: two of them are neighbours
//    if they share an old plane beside the new one.
// 4. store_vertices() stores them, in the places of removed ones as long as there are any.
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>

#include "arrangement/arcs/power_cell.hpp"

namespace vdwmesh::arcs {

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
  constexpr std::array<ByEdge, kWalls> kPlanes{
      {{{0, 2, 1, 3}}, {{0, 0, 2, 3}}, {{0, 1, 0, 3}}, {{0, 0, 1, 2}}}};
  constexpr std::array<ByEdge, kWalls> kTwins{{{{0, end_of(2, 2), end_of(1, 1), end_of(3, 1)}},
                                               {{0, end_of(0, 2), end_of(2, 1), end_of(3, 2)}},
                                               {{0, end_of(1, 2), end_of(0, 1), end_of(3, 3)}},
                                               {{0, end_of(0, 3), end_of(1, 3), end_of(2, 3)}}}};
  if (planes_.empty()) {
    planes_.resize(64);
    open_.assign(64, kNone);
  }
  plane_count_ = kWalls;
  count_ = kWalls;
  reserve(kWalls);
  for (std::uint32_t i = 0; i < kWalls; ++i) {
    planes_[i] = {kAxes[i], kDistance};
    const Vec3d corner = -3 * kDistance * kAxes[i];
    store_lanes(position_[i].at, Lanes{corner.x, corner.y, corner.z, 0});
    x_[i] = corner.x;
    y_[i] = corner.y;
    z_[i] = corner.z;
    plane_[i] = kPlanes[i];
    twin_[i] = kTwins[i];
  }
  pad();
  doubts_ = 0;
  reach_is_stale_ = true;
}

// Makes room for so many vertices, and for the lanes behind the last of them.
inline void PowerCell::reserve(std::size_t vertices) {
  const std::size_t least = vertices + kStep;
  if (x_.size() >= least) return;
  for (std::vector<double>* v : {&x_, &y_, &z_, &depth_}) v->resize(2 * least);
  for (std::vector<ByEdge>* v : {&plane_, &twin_}) v->resize(2 * least);
  position_.resize(2 * least);
  // Three edges a vertex, and one that is written but not kept.
  border_.resize(6 * least + 1);
  removed_.resize(border_.size() + 4);
  new_.resize(border_.size());
}

// Behind the last vertex stand copies of the first, which change no maximum.
inline void PowerCell::pad() {
  for (std::size_t i = 0; i < kStep; i += kLanes) {
    store_lanes(&x_[count_ + i], all_lanes(x_[0]));
    store_lanes(&y_[count_ + i], all_lanes(y_[0]));
    store_lanes(&z_[count_ + i], all_lanes(z_[0]));
  }
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
  for (std::size_t i = 0, count = count_; i < count; i += kStep) {
    measure(i);
    measure(i + kLanes);
  }
  return largest_of(most);
}

// Lists the vertices beyond the plane and the edges that lead from them to those that stay, and
// raises the doubts about vertices that all but lie on it. Returns whether there are vertices to
// remove. A bit for each of 64 vertices says whether it lies beyond; lane k has those of every
// fourth vertex from k on.
VDWMESH_INLINE bool PowerCell::find_removed(const Cap& cap) {
  constexpr std::uint32_t kBits = 64;
  std::uint32_t* const places = removed_.data();
  BorderEdge* const border = border_.data();
  const ByEdge* const twins = twin_.data();
  const double* const depths = depth_.data();
  std::uint32_t removed = 0, found = 0;
  Lanes least = all_lanes(4), nearest = least;
  for (std::uint32_t start = 0, count = count_; start < count; start += kBits) {
    LaneBits beyond{0, 0, 0, 0}, bit{1, 2, 4, 8};
    const std::uint32_t end = start + kBits < count ? start + kBits : count;
    const auto look_at = [&](std::uint32_t i) {
      const Lanes depth = lanes_at(depths + i), size = depth < 0 ? -depth : depth;
      least = depth < least ? depth : least;
      nearest = size < nearest ? size : nearest;
      beyond |= (depth > kSlack) & bit;
      bit <<= kLanes;
    };
    for (std::uint32_t i = start; i < end; i += kStep) {
      look_at(i);
      look_at(i + kLanes);
    }
    auto bits = static_cast<std::uint64_t>(beyond[0] | beyond[1] | beyond[2] | beyond[3]);
    bits &= ~std::uint64_t{0} >> (kBits - (end - start));  // without the lanes behind the last
    for (; bits != 0; bits &= bits - 1) {
      const std::uint32_t from = start + static_cast<std::uint32_t>(std::countr_zero(bits));
      places[removed++] = from;
      for (std::uint32_t side = 1; side <= 3; ++side) {
        const EdgeEnd kept = twins[from].at[side];
        border[found] = {end_of(from, side), kept};
        found += !(depths[vertex_of(kept)] > kSlack);
      }
    }
  }
  removed_count_ = removed;
  border_count_ = found;
  if (-largest_of(-nearest) < kNearby) doubt_near(cap);
  // If even the vertex that stays deepest inside is on the plane but for rounding, or the one that
  // goes first, then the cell is nearly or quite gone.
  if (removed > 0 && std::abs(-largest_of(-least)) < kTouching) doubts_ |= kVanishing;
  return removed > 0;
}

// Vertices far outside the ball may be in doubt: its measures do not depend on them. But if they
// are, because the plane all but coincides with one of theirs, nobody knows where the two planes
// cross, and it may be inside. If the plane runs along an edge, a corner of the patch may have
// three circles, which is of no account for the measures.
inline void PowerCell::doubt_near(const Cap& cap) {
  constexpr double kOutside = 1 + 1e-6;  // squared distance
  for (std::uint32_t i = 0; i < count_; ++i) {
    if (!(std::abs(depth_[i]) < kNearby)) continue;
    const bool touches = std::abs(depth_[i]) < kTouching;
    const Vec3d v = vertex(i);
    if (touches && inner(v, v) < kOutside) doubts_ |= kThirdCircle;
    for (std::size_t k = 1; k <= 3; ++k) {
      if (std::abs(depth_[vertex_of(twin_[i].at[k])]) < kNearby) doubts_ |= kAlongEdge;
      const Vec3d normal = cross(cap.axis, planes_[plane_[i].at[k]].axis);
      if (touches && inner(normal, normal) < kNearlyParallel) doubts_ |= kParallelPlanes;
    }
  }
}

// A new vertex stands where the plane meets the edge: between its ends, so that it is as near to
// the edge's own planes as they are. It takes the planes of the removed end, but for the one that
// the edge leaves there: the new plane takes its place.
//
// Each old plane at the border has two new vertices, whose common edge lies in it and in the new
// plane. The first of them waits in open_ for the second. At a vertex, the edge in a plane is one
// of the two that do not leave it, and the one that leaves the third plane. Returns whether every
// vertex found its neighbours.
VDWMESH_INLINE bool PowerCell::make_vertices(const Cap& cap) {
  const std::uint32_t plane = plane_count_++;
  if (plane == planes_.size()) {
    planes_.resize(2 * planes_.size());
    open_.resize(planes_.size(), kNone);
  }
  planes_[plane] = cap;
  const std::uint32_t count = border_count_;
  reserve(count_ + count);
  std::uint32_t* const numbers = removed_.data();
  FourNumbers more{0, 1, 2, 3};
  more += count_;
  std::uint32_t numbered = removed_count_;
  do {  // four at a time; mostly they are enough
    std::memcpy(numbers + numbered, &more, sizeof more);
    more += 4;
    numbered += 4;
  } while (numbered < count);
  const double* const depths = depth_.data();
  const Position* const positions = position_.data();
  const ByEdge* const planes = plane_.data();
  const BorderEdge* const border = border_.data();
  NewVertex* const fresh = new_.data();
  EdgeEnd *const twin_by_end = twin_[0].at.data(), *const open = open_.data();
  const FourNumbers all_new{plane, plane, plane, plane};
  std::uint64_t waiting = 0;  // the sum of all that wait
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto [removed, kept] = border[i];
    const std::uint32_t from = vertex_of(removed), side = side_of(removed), to = vertex_of(kept),
                        number = numbers[i];
    // A vertex that stays may lie beyond the plane by up to kSlack.
    const double inside = depths[to] < 0 ? depths[to] : 0, share = inside / (inside - depths[from]);
    const Lanes start = lanes_at(positions[to].at), end = lanes_at(positions[from].at);
    store_lanes(fresh[i].position.at, start + all_lanes(share) * (end - start));
    const FourNumbers old = numbers_of(planes[from]), own_side{side, side, side, side};
    store_numbers(fresh[i].plane, FourNumbers{0, 1, 2, 3} == own_side ? all_new : old);
    twin_by_end[end_of(number, side)] = kept;
    twin_by_end[kept] = end_of(number, side);
    const auto close = [&](EdgeEnd& end, EdgeEnd own) {
      // Without a branch, which the processor could not foresee: if none waits, what does not apply
      // is written to element 0 of vertex 0.
      const EdgeEnd other = end;
      twin_by_end[own] = other;
      twin_by_end[other] = own;
      end = own & (0u - (other == kNone));  // kNone if one was waiting
      waiting += end;
      waiting -= other;
    };
    const std::uint32_t one = kNextSide[side], two = kAfterNextSide[side];
    close(open[planes[from].at[one]], end_of(number, two));
    close(open[planes[from].at[two]], end_of(number, one));
  }
  return waiting == 0;
}

// Nothing of removed vertices is needed any more, so new ones take their places.
VDWMESH_INLINE void PowerCell::store_vertices() {
  double *const x = x_.data(), *const y = y_.data(), *const z = z_.data();
  Position* const positions = position_.data();
  ByEdge* const planes = plane_.data();
  const NewVertex* const fresh = new_.data();
  const std::uint32_t* const numbers = removed_.data();
  for (std::uint32_t i = 0, count = border_count_; i < count; ++i) {
    const std::uint32_t number = numbers[i];
    store_numbers(planes[number], numbers_of(fresh[i].plane));
    const Lanes position = lanes_at(fresh[i].position.at);
    store_lanes(positions[number].at, position);
    x[number] = position[0];
    y[number] = position[1];
    z[number] = position[2];
  }
  if (border_count_ < removed_count_) fill_holes();
  count_ = count_ + border_count_ - removed_count_;
  pad();
}

// Fewer vertices came than went: moves vertices from the end of the list to the places left empty.
inline void PowerCell::fill_holes() {
  const std::uint32_t kept = count_ + border_count_ - removed_count_;
  std::uint32_t last_hole = removed_count_, last = count_;
  for (std::uint32_t hole = border_count_; hole < last_hole && removed_[hole] < kept; ++hole) {
    --last;
    while (last_hole > hole && removed_[last_hole - 1] == last) {
      --last;
      --last_hole;
    }
    move_vertex(last, removed_[hole]);
  }
}

inline void PowerCell::move_vertex(std::uint32_t from, std::uint32_t to) {
  x_[to] = x_[from];
  y_[to] = y_[from];
  z_[to] = z_[from];
  position_[to] = position_[from];
  plane_[to] = plane_[from];
  twin_[to] = twin_[from];
  for (std::uint32_t side = 1; side <= 3; ++side) {
    const EdgeEnd twin = twin_[to].at[side];
    twin_[vertex_of(twin)].at[side_of(twin)] = end_of(to, side);
  }
}

inline bool PowerCell::cut(const Cap& cap) {
  // A NaN in the axis always comes with a NaN in the cosine.
  if (!(std::abs(cap.cosine) < 1)) {
    doubts_ |= kNotFinite;
    return false;
  }
  if (std::abs(cap.cosine) > 1 - kTouching) doubts_ |= kNearlyTangent;
  if (count_ == 0 || measure_depths(cap) <= -kNearby || !find_removed(cap)) return false;
  reach_is_stale_ = true;
  if (removed_count_ == count_) {
    count_ = 0;
    return true;
  }
  if (!make_vertices(cap)) {
    doubts_ |= kDamaged;  // links lead nowhere: nothing can be done with this cell
    std::fill(open_.begin(), open_.end(), kNone);
    count_ = 0;
    return true;
  }
  store_vertices();
  return true;
}

// kSlack covers the rounding of the squares and of the root.
inline double PowerCell::reach() {
  if (!reach_is_stale_) return reach_;
  Lanes most = all_lanes(0);
  for (std::size_t i = 0; i < count_; i += kLanes) {
    const Lanes x = lanes_at(&x_[i]), y = lanes_at(&y_[i]), z = lanes_at(&z_[i]);
    const Lanes squared = x * x + y * y + z * z;
    most = squared > most ? squared : most;
  }
  reach_ = std::sqrt(largest_of(most)) + kSlack;
  reach_is_stale_ = false;
  return reach_;
}

}  // namespace vdwmesh::arcs

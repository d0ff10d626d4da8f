// PowerCell::cut(): removes a half-space from the cell. Included by power_cell.hpp alone.
//
// 1. measure_depths() finds how far every vertex lies beyond the plane, four vertices at a time.
//    Most planes of a crowded ball cut nothing off, and end here.
// 2. find_removed() lists the vertices beyond the plane, and the edges that lead from one of them
// to
//    one that stays: the border. Each of these edges has one vertex of the new face.
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
  constexpr std::array<std::array<std::uint32_t, 4>, kWalls> kPlanes{
      {{2, 1, 3, 0}, {0, 2, 3, 0}, {1, 0, 3, 0}, {0, 1, 2, 0}}};
  if (planes_.empty()) {
    planes_.resize(64);
    open_.assign(64, {kNone, 0});
  }
  plane_count_ = kWalls;
  count_ = kWalls;
  reserve(kWalls);
  for (std::uint32_t i = 0; i < kWalls; ++i) {
    planes_[i] = {kAxes[i], kDistance};
    x_[i] = -3 * kDistance * kAxes[i].x;
    y_[i] = -3 * kDistance * kAxes[i].y;
    z_[i] = -3 * kDistance * kAxes[i].z;
    links_[i] = {kPlanes[i], kPlanes[i]};
  }
  pad();
  doubts_ = 0;
  reach_is_stale_ = true;
}

// Makes room for so many vertices, and for the lanes behind the last of them.
inline void PowerCell::reserve(std::size_t vertices) {
  const std::size_t least = vertices + kLanes;
  if (x_.size() >= least) return;
  for (std::vector<double>* v : {&x_, &y_, &z_, &depth_}) v->resize(2 * least);
  links_.resize(2 * least);
  removed_.resize(2 * least);
  border_.resize(6 * least + 1);  // three edges a vertex, and one that is written but not kept
  fresh_.resize(border_.size());
}

// Behind the last vertex stand copies of the first, which change no maximum.
inline void PowerCell::pad() {
  store_lanes(&x_[count_], all_lanes(x_[0]));
  store_lanes(&y_[count_], all_lanes(y_[0]));
  store_lanes(&z_[count_], all_lanes(z_[0]));
}

// Fills depth_, the signed distances of the vertices beyond the plane, and returns the largest.
VDWMESH_INLINE double PowerCell::measure_depths(const Cap& cap) {
  const Lanes ax = all_lanes(cap.axis.x), ay = all_lanes(cap.axis.y), az = all_lanes(cap.axis.z),
              distance = all_lanes(cap.cosine);
  const double *x = x_.data(), *y = y_.data(), *z = z_.data();
  double* depths = depth_.data();
  Lanes most = all_lanes(-4);
  for (std::size_t i = 0, count = count_; i < count; i += kLanes) {
    const Lanes depth =
        ax * lanes_at(x + i) + ay * lanes_at(y + i) + az * lanes_at(z + i) - distance;
    store_lanes(depths + i, depth);
    most = depth > most ? depth : most;
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
  const VertexLinks* const links = links_.data();
  const double* const depths = depth_.data();
  std::uint32_t removed = 0, found = 0;
  Lanes least = all_lanes(4), nearest = least;
  for (std::uint32_t start = 0, count = count_; start < count; start += kBits) {
    LaneBits beyond{0, 0, 0, 0}, bit{1, 2, 4, 8};
    const std::uint32_t end = start + kBits < count ? start + kBits : count;
    for (std::uint32_t i = start; i < end; i += kLanes) {
      const Lanes depth = lanes_at(depths + i), size = depth < 0 ? -depth : depth;
      least = depth < least ? depth : least;
      nearest = size < nearest ? size : nearest;
      beyond |= (depth > kSlack) & bit;
      bit <<= kLanes;
    }
    auto bits = static_cast<std::uint64_t>(beyond[0] | beyond[1] | beyond[2] | beyond[3]);
    bits &= ~std::uint64_t{0} >> (kBits - (end - start));  // without the lanes behind the last
    for (; bits != 0; bits &= bits - 1) {
      const std::uint32_t from = start + static_cast<std::uint32_t>(std::countr_zero(bits));
      places[removed++] = from;
      for (std::uint32_t side = 0; side < 3; ++side) {
        const std::uint32_t to = links[from].next[side];
        border[found] = {from, to, side};
        found += !(depths[to] > kSlack);
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
    for (std::size_t k = 0; k < 3; ++k) {
      if (std::abs(depth_[links_[i].next[k]]) < kNearby) doubts_ |= kAlongEdge;
      const Vec3d normal = cross(cap.axis, planes_[links_[i].plane[k]].axis);
      if (touches && inner(normal, normal) < kNearlyParallel) doubts_ |= kParallelPlanes;
    }
  }
}

// A new vertex stands where the plane meets the edge: between its ends, so that it is as near to
// the edge's own planes as they are. It takes the links of the removed end, but for the plane that
// the edge leaves there: the new plane takes its place.
//
// Each old plane at the border has two new vertices, whose common edge lies in it and in the new
// plane. The first of them waits in open_ for the second. At a vertex, the edge in a plane is one
// of the two that do not leave it, and the one that leaves the third plane. Returns whether every
// vertex found its neighbours.
VDWMESH_INLINE bool PowerCell::make_vertices(const Cap& cap) {
  constexpr std::array<std::uint32_t, 3> kAfter{1, 2, 0};
  const std::uint32_t plane = plane_count_++;
  if (plane == planes_.size()) {
    planes_.resize(2 * planes_.size());
    open_.resize(planes_.size(), {kNone, 0});
  }
  planes_[plane] = cap;
  const double *x = x_.data(), *y = y_.data(), *z = z_.data(), *depths = depth_.data();
  const BorderEdge* const border = border_.data();
  const VertexLinks* const old_links = links_.data();
  NewVertex* const fresh = fresh_.data();
  OpenEnd* const open = open_.data();
  const std::uint32_t removed = removed_count_;
  std::int32_t waiting = 0;
  for (std::uint32_t i = 0, count = border_count_; i < count; ++i) {
    const BorderEdge& edge = border[i];
    fresh[i].number = i < removed ? removed_[i] : count_ + i - removed;
    const auto& next = old_links[edge.to].next;
    fresh[i].back = (next[1] == edge.from ? 1 : 0) + (next[2] == edge.from ? 2 : 0);
    // A vertex that stays may lie beyond the plane by up to kSlack.
    const double inside = std::min(depths[edge.to], 0.0),
                 share = inside / (inside - depths[edge.from]);
    fresh[i].position = {x[edge.to] + share * (x[edge.from] - x[edge.to]),
                         y[edge.to] + share * (y[edge.from] - y[edge.to]),
                         z[edge.to] + share * (z[edge.from] - z[edge.to])};
    const VertexLinks& links = old_links[edge.from];
    std::memcpy(&fresh[i].links, &links, sizeof links);  // in one piece
    fresh[i].links.plane[edge.side] = plane;
    fresh[i].links.next[edge.side] = edge.to;
    const std::uint32_t one = kAfter[edge.side], two = kAfter[one];
    const auto close = [&](OpenEnd& end, std::uint32_t side) {
      // Without a branch, which the processor could not foresee: what does not apply is written to
      // the unused element.
      const bool is_first = end.border == kNone;
      NewVertex& other = fresh[is_first ? i : end.border];
      fresh[i].links.next[is_first ? kUnused : side] = other.number;
      other.links.next[is_first ? kUnused : end.side] = fresh[i].number;
      end = {is_first ? i : kNone, side};
      waiting += is_first ? 1 : -1;
    };
    close(open[links.plane[one]], two);
    close(open[links.plane[two]], one);
  }
  return waiting == 0;
}

VDWMESH_INLINE void PowerCell::store_vertices() {
  const std::uint32_t all = count_ + border_count_;
  reserve(all);
  VertexLinks* const links = links_.data();
  double *x = x_.data(), *y = y_.data(), *z = z_.data();
  const BorderEdge* const border = border_.data();
  const NewVertex* const fresh = fresh_.data();
  for (std::uint32_t i = 0, count = border_count_; i < count; ++i) {
    const NewVertex& vertex = fresh[i];
    const std::uint32_t number = vertex.number;
    links[border[i].to].next[vertex.back] = number;
    std::memcpy(&links[number], &vertex.links, sizeof vertex.links);
    x[number] = vertex.position.x;
    y[number] = vertex.position.y;
    z[number] = vertex.position.z;
  }
  if (border_count_ < removed_count_) fill_holes();
  count_ = all - removed_count_;
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
  links_[to] = links_[from];
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::uint32_t& next : links_[links_[to].next[k]].next) next = next == from ? to : next;
  }
}

inline void PowerCell::cut(const Cap& cap) {
  // A NaN in the axis always comes with a NaN in the cosine.
  if (!(std::abs(cap.cosine) < 1)) {
    doubts_ |= kNotFinite;
    return;
  }
  if (std::abs(cap.cosine) > 1 - kTouching) doubts_ |= kNearlyTangent;
  if (count_ == 0 || measure_depths(cap) <= -kNearby || !find_removed(cap)) return;
  reach_is_stale_ = true;
  if (removed_count_ == count_) {
    count_ = 0;
    return;
  }
  if (!make_vertices(cap)) {
    doubts_ |= kDamaged;  // links lead nowhere: nothing can be done with this cell
    std::fill(open_.begin(), open_.end(), OpenEnd{kNone, 0});
    count_ = 0;
    return;
  }
  store_vertices();
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

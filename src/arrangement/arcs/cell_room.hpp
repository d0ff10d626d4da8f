// The arrays of a PowerCell, in two kinds: FixedRoom has room for the cells of nearly all balls,
// and its arrays stand at known places, so that loops need no pointers to them; GrowingRoom takes
// memory as it is needed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "arrangement/arcs/arc_cap.hpp"
#include "core/lanes.hpp"

namespace vdwmesh::arcs {

// An edge as seen from one of its ends: 4 v + k for edge k of vertex v, which is 1, 2 or 3. Edge k
// lies in the planes of the two other edges and leaves plane k. The axes of planes 1, 2 and 3 have
// a positive determinant, so an edge runs against the cross product of the axes of the two planes
// that follow its own in the cycle 1, 2, 3. Seen from its other end the two have changed places.
using EdgeEnd = std::uint32_t;
constexpr std::uint32_t vertex_of(EdgeEnd end) { return end / 4; }
constexpr EdgeEnd end_of(std::uint32_t vertex, std::uint32_t side) { return 4 * vertex + side; }

// A vertex in lanes.
struct alignas(32) Position {
  double at[4];  // the fourth is 0
};

// An edge from a removed vertex, `removed` at its end, to one that stays, `kept` at its end.
struct BorderEdge {
  EdgeEnd removed, kept;
};

// An edge of the new face that looks for its other end: it lies in `plane`.
struct HalfLink {
  std::uint32_t plane;
  EdgeEnd own;
};

// Vertices that a loop looks at in one step: two vectors, for fewer and more predictable ends of
// loops.
inline constexpr std::size_t kStep = 2 * kLanes;
// The x coordinate of a slot without a vertex.
inline constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();

// What a cell is made of. Array<T, kSize> is the kind of array.
template <template <class, std::size_t> class Array, std::size_t kVertices, std::size_t kPlanes>
struct CellArrays {
  // By slot of a vertex. The loops over x, y, z and depth run to a multiple of kStep.
  Array<double, kVertices> x, y, z, depth;
  Array<Position, kVertices> position;  // the same as x, y and z
  // By the ends of edges: the plane that is left, and the other end.
  Array<std::uint32_t, 4 * kVertices> plane_left;
  Array<EdgeEnd, 4 * kVertices> twin;
  Array<Cap, kPlanes> planes;
  // By plane: the edge of the new face that waits for its other end; between cuts none waits.
  Array<EdgeEnd, kPlanes> open;
  // The free slots; during a cut, those that were free before, and behind them unused ones, which
  // are listed four at a time.
  Array<std::uint32_t, 2 * kVertices + 4> free;
  // During a cut. Removed vertices are in ascending order. The border has the edges from removed
  // vertices to those that stay, and one that is written but not kept; links are by these edges,
  // which are no more than there is room for new vertices.
  Array<std::uint32_t, 2 * kVertices + 4> removed;
  Array<BorderEdge, 3 * kVertices + 1> border;
  Array<HalfLink, kVertices> links;
};

template <class T, std::size_t kSize>
using GrowingArray = std::vector<T>;

template <std::size_t kVertices, std::size_t kPlanes>
class FixedRoom : public CellArrays<std::array, kVertices, kPlanes> {
 public:
  static constexpr std::size_t kMostVertices = kVertices;
  static_assert(kVertices % kStep == 0);

  FixedRoom() {
    this->x.fill(kNowhere);
    this->open.fill(0);
  }
  // Returns whether there is room for so many vertices and planes.
  bool reserve(std::size_t vertices, std::size_t planes) const {
    return vertices <= kVertices && planes <= kPlanes;
  }
};

class GrowingRoom : public CellArrays<GrowingArray, 0, 0> {
 public:
  static constexpr std::size_t kMostVertices = std::numeric_limits<std::size_t>::max();

  // Makes room for so many vertices and planes.
  bool reserve(std::size_t vertices, std::size_t planes_wanted) {
    if (planes.size() < planes_wanted) {
      planes.resize(2 * planes_wanted);
      open.resize(planes.size());
    }
    const std::size_t least = vertices + kStep;
    if (x.size() >= least) return true;
    x.resize(2 * least, kNowhere);
    for (std::vector<double>* v : {&y, &z, &depth}) v->resize(2 * least);
    for (std::vector<std::uint32_t>* v : {&plane_left, &twin}) v->resize(8 * least);
    position.resize(2 * least);
    for (std::vector<std::uint32_t>* v : {&free, &removed}) v->resize(4 * least + 4);
    border.resize(6 * least + 1);
    links.resize(2 * least);
    return true;
  }
};

}  // namespace vdwmesh::arcs

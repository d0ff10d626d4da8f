// The arrays of a PowerCell, in two kinds. FixedRoom has arrays of fixed size, which suffice for
// the cells of nearly all balls; their addresses are known when compiling, so loops load no
// pointers. GrowingRoom allocates memory as it is needed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/lanes/lanes.hpp"
#include "measures/arcs/arc_cap.hpp"

namespace vdwmesh::arcs {

// An edge as seen from one of its ends: 4 v + k is edge k (1, 2 or 3) of vertex v. Counting from 1
// leaves 0 for no edge; with four numbers per vertex, a shift finds the vertex.
//
// Three planes meet in a vertex. They are numbered 1, 2 and 3 there such that the determinant of
// their axes n1, n2, n3 is positive. Edge k lies in the two planes other than k. From the vertex it
// leads away from plane k into the cell: edge 1 in the direction -(n2 x n3), edges 2 and 3 likewise
// in the cycle 1, 2, 3. The direction is opposite at its other end, so there the two planes follow
// each other in the opposite order.
using EdgeEnd = std::uint32_t;
constexpr std::uint32_t vertex_of(EdgeEnd end) { return end / 4; }
constexpr EdgeEnd end_of(std::uint32_t vertex, std::uint32_t side) { return 4 * vertex + side; }

// The position of a vertex as one vector of four lanes.
struct alignas(32) Position {
  double at[4];  // the fourth is 0
};

// An edge between a vertex that is removed and one that stays, as seen from both.
struct BorderEdge {
  EdgeEnd removed, kept;
};

// One end of an edge of the new face whose other end is not known yet. The edge lies in the new
// plane and in `plane`.
struct HalfLink {
  std::uint32_t plane;
  EdgeEnd own;
};

// Vertices that a loop handles in one step: two vectors, so that loops are short and the processor
// predicts their ends.
inline constexpr std::size_t kStep = 2 * kLanes;
// The x coordinate of a slot without a vertex.
inline constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();

// What a cell is made of. Array<T, kSize> is the kind of array.
template <template <class, std::size_t> class Array, std::size_t kVertices, std::size_t kPlanes>
struct CellArrays {
  // By slot of a vertex. `depth` is how far the vertex lies beyond the plane of the cut. Loops over
  // all vertices read x, y, z and depth, and run to a multiple of kStep.
  Array<double, kVertices> x, y, z, depth;
  Array<Position, kVertices> position;  // the same as x, y and z, for one vertex at a time
  // By EdgeEnd: the plane that the edge leaves there, and the edge's other end.
  Array<std::uint32_t, 4 * kVertices> plane_left;
  Array<EdgeEnd, 4 * kVertices> twin;
  Array<Cap, kPlanes> planes;
  // By plane, during a cut: the first end of the edge of the new face in this plane, until its
  // second end is found. 0 otherwise.
  Array<EdgeEnd, kPlanes> open;
  // The slots of removed vertices, which new vertices may use again. A cut appends slots that
  // were never used, four at a time; so there is room for four more.
  Array<std::uint32_t, 2 * kVertices + 4> free;
  // Used during a cut. `removed` is in ascending order. `border` has the edges from removed
  // vertices to vertices that stay, and one element more, because an edge is written before it is
  // known to belong there. `links` has an element for each of these edges; each makes one new
  // vertex, so kVertices suffice.
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
    // Loops run to the next multiple of kStep. In FixedRoom, kVertices is one.
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

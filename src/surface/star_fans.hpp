// Star-shaped fans: a proof in linear time that triangles around a vertex do not intersect.
//
// A fan is made of the triangles around a vertex u, or of other pieces of surface with u in the
// middle that are discs, follow each other around u, and consist of triangles. Let a linear map
// take space to a plane, u to the origin. The fan is a star if
//   1. every triangle of it has a positive area in the plane, and
//   2. its border, a polygon, runs once around the origin, and each edge of it counter-clockwise by
//      less than half a turn.
//
// Two triangles of a star have nothing in common but a vertex or an edge that is a vertex or an
// edge of both. For the fan is a disc, and the border's image is a simple closed curve by 2. A
// point beside this curve and beside all edges is covered as often as the curve runs around it,
// once or not at all, for triangles count with the sign of their area, which is positive. Let two
// points of the disc have one image. If one of them is not on the border, the disc covers all that
// is near the image by what is near this point, and some of that again by what is near the other
// one; so something is covered twice. If both are on the border, the border's image is not simple.
// So different points of the disc have different images, and different places in space. Whatever
// two triangles have in common in space is thus the same point of the disc. ∎
//
// The second condition is judged piece by piece. A piece of border between two spokes, edges of the
// mesh from u outwards, crosses the positive x axis or does not, as the signs of y at its points
// tell. If each edge turns counter-clockwise by less than half a turn, a fan that closes crosses
// the axis once for each time that it runs around u, and at least once. So if all pieces at a
// vertex cross once in all, there is a single fan, and it runs around once. This needs no order of
// the pieces, but that the fans close: each spoke must belong to two pieces, and begin one of them
// and end the other.
//
// The map is a matter of taste: one that does not fit proves nothing, and no other result depends
// on it. But all pieces around a vertex must have the same one. Here its kernel is a direction for
// each vertex, the mean normal of up to three triangles. Which ones these are depends on the
// threads.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "core/buffer.hpp"
#include "core/vec3.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// The vertices whose fans are known to be stars. Pieces are added and replaced by several threads.
class StarFans {
 public:
  StarFans() = default;  // none
  explicit StarFans(std::size_t vertices) : state_(vertices, 0) {}

  // What is known of a piece at each of the three vertices that it belongs to. Bit k of `holds`
  // says that at vertex k all areas and turns are positive, bit k of `crosses` that its border
  // crosses the positive x axis.
  struct Judgement {
    std::uint8_t holds, crosses;
  };

  void add(const Triangle& vertex, const Judgement& judgement) {
    for (std::size_t k = 0; k < 3; ++k) change(vertex[k], state_of(judgement, k));
  }
  // Replaces the judgement of a piece that was added.
  void replace(const Triangle& vertex, const Judgement& before, const Judgement& now) {
    for (std::size_t k = 0; k < 3; ++k) {
      change(vertex[k], state_of(now, k) - state_of(before, k));
    }
  }

  bool empty() const { return state_.empty(); }
  // Whether all pieces around the vertex are one fan, which is a star. Precondition: it is one of
  // the vertices, or kNone or the number after that.
  bool is_star(std::uint32_t vertex) const { return vertex < kNone && state_[vertex] == 1; }

  // This number and the next one are no vertex of a star.
  static constexpr std::uint32_t kNone = 0xfffffffeu;

 private:
  // Of a vertex, the number of pieces that cross the axis, plus kFailure for each that proves
  // nothing, which does not count as crossing. Both numbers are below 2^32, for a mesh has fewer
  // corners of patches. Differences may wrap, and the sums are right all the same.
  using State = std::uint64_t;
  static constexpr State kFailure = State{1} << 32;
  static State state_of(const Judgement& judgement, std::size_t k) {
    return (judgement.holds >> k & 1) == 0 ? kFailure : State{judgement.crosses} >> k & 1;
  }
  void change(std::uint32_t vertex, State by) {
    if (by != 0) std::atomic_ref(state_[vertex]).fetch_add(by, std::memory_order_relaxed);
  }
  Buffer<State> state_;  // by vertex
};

// A direction (about of unit length) for each vertex, or any vector for one without triangles.
// Precondition: the vertices of all triangles are among the first `vertices` positions.
Buffer<Vec3f> fan_directions(const Buffer<Vec3d>& positions, std::size_t vertices,
                             const Buffer<Triangle>& triangles);

// Finds out whether a mesh was made by dividing each triangle of another one into four, as
// refine/subdivision_formulas.hpp does: triangles 4 t to 4 t + 3 are a patch. If so, returns the
// vertices of the other mesh around which the patches are a star, else nothing is known.
// Precondition: the mesh is closed and oriented: every edge is on exactly two triangles, which run
// along it in opposite directions.
StarFans fans_of_divided(const IndexedMesh& mesh);

}  // namespace vdwmesh

// The pieces of a patch's boundary in its triangulation, and those to be split because the marks of
// the triangles inside the patch have leaked out of it. For host and device.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "creases/patch/patch_work.hpp"
#include "creases/plane/inside_marks.hpp"
#include "creases/plane/piece_lens.hpp"
#include "creases/plane/stereographic.hpp"

namespace vdwmesh {

// Lists every piece, as 4 t + k for the triangle t on its left, whose edge k it is.
template <class Memory>
VDWMESH_HD void list_pieces(const PatchBoundaryView& boundary,
                            const PlaneTriangulationOf<Memory>& plane,
                            typename Memory::template Array<std::uint32_t>& listed) {
  listed.clear();
  const std::span<const LinkedTriangle> triangles = plane.triangles();
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const LinkedTriangle& w = triangles[t];
    // All bits of kNoPiece are set.
    if ((w.pieces[0] & w.pieces[1] & w.pieces[2]) == kNoPiece) continue;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const bool is_left = w.pieces[k] != kNoPiece &&
                           boundary.pieces[w.pieces[k]].from == w.vertices[corner_after(k)];
      if (is_left) listed.push_back(4 * t + k);
    }
  }
}
// Calls visit(t, k) for those listed.
template <class List, class Visit>
VDWMESH_HD void visit_listed_pieces(const List& listed, const Visit& visit) {
  for (const std::uint32_t i : listed) visit(i / 4, i % 4);
}

// Whether a point of the boundary lies between piece p, which triangle t has, and its arc. A point
// of the same circle does not. On the host only points near the piece are looked at.
template <class Memory>
VDWMESH_HD bool hides_a_point(const PatchBoundaryView& boundary, const Stereographic& projection,
                              PatchWork<Memory>& work, std::uint32_t t, std::uint32_t p) {
  const BoundaryPiece& piece = boundary.pieces[p];
  const PieceLens lens(work.patch.points[piece.from], work.patch.points[piece.to], piece.bulge,
                       projection);
  const auto is_hidden = [&](std::uint32_t i) {
    return lens.contains(work.plane.point(i)) && !work.circles.on(i, piece.neighbor);
  };
  if constexpr (Memory::kIsBounded) {
    for (std::uint32_t i = 0; i < boundary.points.size(); ++i) {
      if (is_hidden(i)) return true;
    }
    return false;
  } else {
    const std::size_t count = boundary.points.size();  // corners of the frame have more
    for (const std::uint32_t near : work.plane.triangles_at_disk(lens.center(), lens.radius(), t)) {
      for (const std::uint32_t i : work.plane.triangle(near).vertices) {
        if (i < count && is_hidden(i)) return true;
      }
    }
    return false;
  }
}

// Asks for splits if marks have leaked out of the patch. It shows at pieces with marked triangles
// on both sides, or with a corner of the frame on their left. To blame are pieces so coarse that
// a point of the boundary lies in the lens between the piece and its arc: all of these are split.
// They need not be leaking themselves. In a narrow part of the patch that a loop of its own
// bounds, the chord of one arc may pass beyond the other arc, and turn the loop around: then all
// of the patch is marked on the wrong side but at the pieces of this loop.
//
// There is such a piece. Let all arcs shrink to their chords at once, each through the circular
// arcs between the same ends. If no lens has a point in it, no arc passes over a point meanwhile.
// Two arcs may come to cross only in pairs of crossings, which have to vanish in the same pairs,
// because neither the arcs nor, at last, the pieces cross. So the pieces divide the sphere as the
// arcs do, and marks do not leak.
//
// And it comes to an end: a point at the distance d from an arc is in no lens lower than d, and
// the height of a lens falls by a factor of four with each split.
//
// `work` has the listed pieces; its numbers are scratch memory. want_split(piece) asks for a split,
// and count_step() counts a piece that is looked at.
template <class Memory, class WantSplit, class CountStep>
VDWMESH_HD void split_leaks(const PatchBoundaryView& boundary, const Stereographic& projection,
                            PatchWork<Memory>& work, const WantSplit& want_split,
                            const CountStep& count_step) {
  const PlaneTriangulationOf<Memory>& plane = work.plane;
  const auto chord = [&](std::uint32_t p) {
    return norm(work.patch.points[boundary.pieces[p].to] -
                work.patch.points[boundary.pieces[p].from]);
  };
  auto& leaks = work.numbers;
  leaks.clear();
  double longest = 0;
  visit_listed_pieces(work.pieces, [&](std::uint32_t t, std::uint32_t k) {
    const LinkedTriangle& w = plane.triangle(t);
    if (!plane.is_inside(w.neighbors[k]) && !plane.touches_frame(t)) return;
    leaks.push_back(w.pieces[k]);
    longest = std::max(longest, chord(w.pieces[k]));
  });
  if (leaks.empty()) return;
  bool has_hidden = false;
  visit_listed_pieces(work.pieces, [&](std::uint32_t t, std::uint32_t k) {
    count_step();
    const std::uint32_t p = plane.triangle(t).pieces[k];
    if (!hides_a_point(boundary, projection, work, t, p)) return;
    has_hidden = true;
    want_split(p);
  });
  // A point may be so near to an arc that its lens is not seen to have it.
  if (has_hidden) return;
  for (const std::uint32_t p : leaks) {
    if (chord(p) >= longest / 2) want_split(p);
  }
}

}  // namespace vdwmesh

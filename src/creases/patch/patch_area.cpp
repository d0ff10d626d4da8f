// Estimates the area error of a patch's mesh from its boundary, before there are triangles.
//
// The mesh of a patch has straight chords in place of arcs. Let L be the length of a piece and k
// the geodesic curvature of its arc, all on the unit sphere. Between the arc and the great circle
// through its ends is a lens, but for higher orders the segment of a parabola of height k L² / 8:
// its area is 2/3 · L · k L² / 8 = k L³ / 12. The bulge of the piece is the angle k L / 2 between
// the two, so the area is L² · bulge / 6.
//
// The flat triangles between the great circles lack area, too. The part of the sphere over a flat
// triangle with circumradius R, which is at the distance d from the centre, d² = 1 - R², has the
// area ∫ d (d² + s²)^(-3/2), where s is the distance from the circumcentre. But for higher orders
// the integrand is 1 + R² - 3/2 s². The mean of s² over an equilateral triangle of edge length h is
// h² / 12, and R² is h² / 3, so 5/24 h² of its area is lacking.
//
// Hence the error is the sum of the lenses, with their signs, less what the flat triangles lack,
// but for terms of fourth order. Each part is of second order in the edge length.
//
// A split of a piece into halves leaves a fourth of its lens, so a request reduces the error, and
// after some rounds there are none. The largest lenses first: each split costs one point and takes
// three fourths of a lens. The halves of the largest piece have an eighth of its lens each; so
// pieces with less wait for the next round, which may want those halves split before them. Thus
// short and nearly straight pieces are left alone. Pieces of one arc are equal but for rounding,
// which must not choose between them, so all of them are split.
#include "creases/patch/patch_area.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/lanes/multiversion.hpp"

namespace vdwmesh {

double flat_triangle_error(double area, double edge_length) {
  return 5. / 24 * edge_length * edge_length * area;
}

double lens_area(const PatchBoundary& boundary, const BoundaryPiece& piece) {
  return squared_norm(boundary.points[piece.to] - boundary.points[piece.from]) * piece.bulge / 6;
}

VDWMESH_MULTIVERSION void split_for_area(const PatchBoundary& boundary, double area,
                                         double edge_length, PatchVector<PieceSplit>& splits) {
  const double flat = flat_triangle_error(area, edge_length);
  const double counted = std::max(area, kCountedArea * edge_length * edge_length);
  const double most = std::max(kLargestAreaError * counted, kFlatTriangleErrors * flat);
  double error = -flat;
  for (const BoundaryPiece& piece : boundary.pieces) error += lens_area(boundary, piece);
  if (std::abs(error) <= most) return;
  std::vector<std::pair<double, std::uint32_t>> lenses;  // areas and pieces of those to blame
  for (std::uint32_t p = 0; p < boundary.pieces.size(); ++p) {
    const double lens = std::copysign(1, error) * lens_area(boundary, boundary.pieces[p]);
    if (lens > 0) lenses.push_back({lens, p});
  }
  std::ranges::sort(lenses, [](const auto& a, const auto& b) { return a.first > b.first; });
  constexpr double kTie = 1e-6;
  double left = std::abs(error), last = 0;
  for (const auto& [area, piece] : lenses) {
    if (area < lenses.front().first / 8) break;
    if (left <= most && area < (1 - kTie) * last) break;
    splits.push_back({boundary.pieces[piece].source, 1});
    left -= 0.75 * area;
    last = area;
  }
}

}  // namespace vdwmesh

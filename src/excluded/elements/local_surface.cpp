// exact_circle() and exact_patch(): triangulate the balls near the element and take it from their
// dual complex and accessible surface. Only the balls that reach the element have a part in it, so
// it is the same as in the whole set.
#include "excluded/elements/local_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "complex/boundary/boundary_shapes.hpp"
#include "excluded/elements/low_patch.hpp"
#include "excluded/patches/atom_shares.hpp"
#include "excluded/probes/grown_atoms.hpp"

namespace vdwmesh::excluded::elements {
namespace {

// The least length of an arc, in the radius of the largest ball: see kNoLength.
constexpr double kLeastLength = 1e-10;

// The balls of a set around a place, ascending. Sets stand one after another.
std::vector<HostBall> balls_around(const HostBalls& balls, std::uint32_t set,
                                   const Around& around) {
  std::vector<HostBall> near;
  for (const HostBall& ball : std::ranges::equal_range(balls.balls, set, {}, &HostBall::set)) {
    if (is_around(around, ball.grown)) near.push_back(ball);
  }
  return near;
}

std::vector<Sphere> grown_of(const std::vector<HostBall>& near) {
  std::vector<Sphere> out;
  for (const HostBall& ball : near) out.push_back(ball.grown);
  return out;
}

std::uint32_t third_of(const DualTriangle& f, std::uint32_t edge) {
  const auto slot = std::find(f.edges.begin(), f.edges.end(), edge) - f.edges.begin();
  return f.vertices[static_cast<std::size_t>(slot)];
}

// The exposed arcs of an edge in their order around its circle.
std::vector<ExposedArc> arcs_around(const PowerTriangulation& t, const DualComplex& complex,
                                    std::uint32_t edge) {
  std::vector<ExposedArc> found, ordered;
  for (const ExposedArc& arc : exposed_arcs(t, complex)) {
    if (arc.edge == edge) found.push_back(arc);
  }
  if (found.empty() || found[0].start == kNoCorner) return found;
  ordered.push_back(found[0]);
  while (ordered.size() < found.size()) {
    const CornerIndex start = next_start(t, complex, edge, ordered.back().end);
    const auto next = std::find_if(found.begin(), found.end(),
                                   [&](const ExposedArc& arc) { return arc.start == start; });
    if (next == found.end()) break;
    ordered.push_back(*next);
  }
  return ordered;
}

// A probe of a local surface under the name that it has in the set.
class LocalNames {
 public:
  LocalNames(const AccessibleSurface& surface, const std::vector<HostBall>& near)
      : surface_(surface), near_(near) {}

  std::uint32_t ball(std::uint32_t vertex) const {
    return near_[surface_.triangulation().ids[vertex]].place;
  }
  CornerName corner(std::uint32_t probe) const {
    const CornerIndex c = surface_.probes[probe].corner;
    const auto& v = surface_.triangle_of(c).vertices;
    return corner_name(ball(v[0]), ball(v[1]), ball(v[2]), c % 2 == 0);
  }
  std::uint64_t number(std::uint32_t probe) const { return number_of(corner(probe)); }

 private:
  const AccessibleSurface& surface_;
  const std::vector<HostBall>& near_;
};

}  // namespace

std::optional<std::vector<ExactArc>> exact_circle(const HostBalls& balls, std::uint32_t a,
                                                  std::uint32_t b) {
  const Sphere &first_ball = balls.at(a).grown, &second_ball = balls.at(b).grown;
  const double rho = pair_circle(first_ball, second_ball).radius;
  const std::vector<HostBall> near =
      balls_around(balls, balls.at(a).set, around_circle(first_ball, second_ball));
  const PowerTriangulation t = triangulate(SphereSet(grown_of(near)), nullptr, 1);
  const DualComplex complex = dual_complex(t);
  const BoundaryShapes shapes(t, complex);
  const auto place = [&](std::uint32_t vertex) { return near[t.ids[vertex]].place; };
  std::vector<ExactArc> out;
  for (std::uint32_t e = 0; e < complex.edges.size(); ++e) {
    const DualEdge& edge = complex.edges[e];
    const std::uint32_t first = place(edge.vertices[0]), second = place(edge.vertices[1]);
    if (std::min(first, second) != a || std::max(first, second) != b) continue;
    if (edge.singular && edge.contact == Contact::touching) continue;
    const bool forward = first == a;
    for (const ExposedArc& arc : arcs_around(t, complex, e)) {
      const double angle = shapes.angle(arc), turns = angle / (kPi / 2);
      if (arc.start == kNoCorner) {
        out.push_back({{kNone, kNone}, 4});
        continue;
      }
      if (!(angle * rho > kLeastLength * first_ball.radius)) return std::nullopt;
      const std::uint32_t start = place(third_of(complex.triangles[arc.start / 2], e)),
                          end = place(third_of(complex.triangles[arc.end / 2], e));
      out.push_back(forward ? ExactArc{{start, end}, turns} : ExactArc{{end, start}, turns});
    }
    if (!forward) std::reverse(out.begin(), out.end());
  }
  return out;
}

void place_exactly(const HostBalls& balls, ProbeCorner& corner) {
  const auto& v = corner.name.ball;
  const CommonPoints points =
      common_points(balls.at(v[0]).grown, balls.at(v[1]).grown, balls.at(v[2]).grown);
  corner.at = corner.name.above ? points.above : points.below;
  corner.half_chord = points.half_chord;
  corner.low = corner.half_chord < balls.probe;
}

std::optional<PatchMeasures> exact_patch(const HostBalls& balls, const ProbeCorner& corner) {
  const HostBall& first = balls.at(corner.name.ball[0]);
  const std::vector<HostBall> near =
      balls_around(balls, first.set, around_corner(first.grown, corner, balls.probe));
  std::vector<Sphere> atoms = grown_of(near);
  for (std::size_t i = 0; i < near.size(); ++i) atoms[i].radius = near[i].radius;
  const GrownAtoms grown(SphereSet(std::move(atoms)), balls.probe, nullptr);
  const AccessibleSurface& surface = grown.surface;
  const LocalNames names(surface, near);
  std::uint32_t self = kNoIndex;
  for (std::uint32_t i = 0; i < surface.probes.size(); ++i) {
    if (names.corner(i) == corner.name) self = i;
  }
  if (self == kNoIndex || surface.probes[self].corner_count > 1) return std::nullopt;
  const std::vector<std::uint8_t> all(surface.components.size(), 1);
  const ConcavePatch patch = surface.probes[self].low
                                 ? concave_patch(surface, LowProbes(surface, all), all, self)
                                 : excluded::whole_patch(surface, self);
  if (!patch.certified || !(patch.margin >= kBrokenTie)) return std::nullopt;
  const auto is_crowded = [&](const PatchCap& cap) {
    return surface.probes[cap.probe].corner_count > 1;
  };
  if (std::any_of(patch.caps.begin(), patch.caps.end(), is_crowded)) return std::nullopt;
  PatchMeasures out{};
  for (const PatchPiece& piece : patch.pieces) {
    out.solid_angle += piece.solid_angle;
    out.vector = out.vector + piece.vector;
    out.sixths += 6 * (2 - static_cast<std::int32_t>(piece.loops));
  }
  count_creases(patch, names.number(self), names, out);
  for (const AtomShare& share : atom_shares(surface, patch)) {
    const int slot = place_in(corner.name, names.ball(share.ball));
    out.share[slot] = share.solid_angle;
    out.flat[slot] = 3 * share.cones - share.solid_angle;
  }
  return out;
}

}  // namespace vdwmesh::excluded::elements

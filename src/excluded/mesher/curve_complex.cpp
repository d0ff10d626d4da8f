// CurveComplex: makes the concave patches that are cut, numbers faces and corners, and places the
// curves arc by arc, then the creases.
//
// What is shared is found by name: points of contact by probe and atom, cusps by circle and atom,
// points of three creases by their probes. No position is compared with another one.
#include "excluded/mesher/curve_complex.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <compare>
#include <numbers>
#include <utility>

#include "core/errors.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh::excluded {
namespace {

constexpr std::uint32_t kNoFace = kNoIndex;

// The atom at which a side of a probe's polygon begins.
std::uint32_t first_atom(const AccessibleSurface& surface, const ProbeSide& side) {
  return surface.arcs[side.arc].ball[side.end == ArcEnd::end ? 0 : 1];
}

struct NamedPoint {
  CreaseEnd name;
  Vec3d position, normal;
};

// A crease as one of its two probes names it. In the name that the other one gives it, probes and
// ends are exchanged.
struct CreaseName {
  std::uint32_t probe, other;
  CreaseEnd from, to;
  auto operator<=>(const CreaseName&) const = default;
};

// The parts of a saddle, from ball a to ball b. A saddle has a waist if its circle about the axis
// is at its narrowest smaller than kThinWaist of the edge length. The waist ends where the circle
// is some kEndOfWaist of it larger; or at an atom that is not much farther. It is never longer than
// an edge, so that no curve has a point inside of it.
std::vector<SaddlePart> saddle_parts(const RolledArc& arc, double p, double edge_length) {
  constexpr double kThinWaist = 1e-4, kEndOfWaist = 0.005;
  const Profile profile = profile_of(arc);
  const auto& [first, last] = profile.end;
  if (profile.spindle) return {{first, -profile.cusp, 0}, {profile.cusp, last, 1}};
  const double edge = std::min(edge_length, p);
  if (!(first < 0 && last > 0 && arc.circle_radius - p < kThinWaist * edge)) return {{first, last}};
  const double end = std::min(std::sqrt(2 * kEndOfWaist * edge / p), edge / (4.01 * p));
  const double from = first < -2 * end ? -end : first, to = last > 2 * end ? end : last;
  std::vector<SaddlePart> parts;
  if (from > first) parts.push_back({first, from});
  parts.push_back({from, to, kNoIndex, true});
  if (to < last) parts.push_back({to, last});
  return parts;
}

// Calls visit(segment, from, to) for every crease of a patch.
template <class Visit>
void visit_creases(const AccessibleSurface& surface, const ConcavePatch& patch,
                   const Visit& visit) {
  for (const PatchSegment& s : patch.segments) {
    if (s.circle >= patch.caps.size()) continue;
    visit(s, crease_end(surface, patch, s.before, s.circle),
          crease_end(surface, patch, s.circle, s.next));
  }
}

}  // namespace

CurveComplex::CurveComplex(const GrownAtoms& grown, std::span<const std::uint8_t> included,
                           double edge_length, Monitor* monitor)
    : cut(cut_patches(grown.surface, included, monitor)), grown_(grown), included_(included) {
  curves.sizes = {0, 0};
  for (const ConcavePatch& patch : cut) {
    if (!patch.certified) refuse(patch.probe, "its creases do not close");
  }
  list_faces();
  place_corners();
  place_named_corners();
  for (std::uint32_t a = 0; a < surface().arcs.size(); ++a) {
    if (counts(surface().arcs[a])) add_arc(a, edge_length);
  }
  add_creases();
  const auto each_curve = [&](const auto& visit) {
    for (std::uint32_t c = 0; c < curves.arcs.size(); ++c) {
      const auto& [right, left] = curves.arcs[c].balls;
      visit(right, c);
      if (left != right) visit(left, c);
    }
  };
  curves_of_.fill(face_count(), each_curve);
}

void CurveComplex::list_faces() {
  const PowerTriangulation& t = grown_.triangulation;
  face_of_ball_.assign(t.balls.size(), kNoFace);
  face_of_probe_.assign(surface().probes.size(), kNoFace);
  const auto add = [&](const SphereFace& face) {
    spheres.push_back(face);
    return static_cast<std::uint32_t>(spheres.size() - 1);
  };
  for (const ContactPiece& c : surface().contacts) {
    if (c.point || !included_[c.component] || face_of_ball_[c.ball] != kNoFace) continue;
    const Sphere sphere{surface().center(c.ball), grown_.radius[c.ball]};
    face_of_ball_[c.ball] = add({false, c.ball, sphere, kNoIndex});
  }
  std::uint32_t next_cut = 0;
  for (std::uint32_t p = 0; p < surface().probes.size(); ++p) {
    const bool is_cut = next_cut < cut.size() && cut[next_cut].probe == p;
    if (included_[surface().probes[p].component]) {
      face_of_probe_[p] =
          add({true, p, {probe_center(p), surface().probe_radius}, is_cut ? next_cut : kNoIndex});
    }
    next_cut += is_cut;
  }
  const auto each_neighbor = [&](const auto& visit) {
    for (const DualEdge& e : grown_.complex.edges) {
      visit(e.vertices[0], e.vertices[1]);
      visit(e.vertices[1], e.vertices[0]);
    }
  };
  neighbors_.fill(t.balls.size(), each_neighbor);
}

std::uint32_t CurveComplex::add_corner(const Vec3d& position, const Vec3d& normal) {
  curves.corners.push_back({position, {kNoIndex, kNoIndex, kNoIndex}});
  normals.push_back(normal);
  return static_cast<std::uint32_t>(curves.corners.size() - 1);
}

// The points of contact of all probes.
void CurveComplex::place_corners() {
  first_corner_.assign(surface().probes.size(), kNoIndex);
  for (std::uint32_t p = 0; p < surface().probes.size(); ++p) {
    if (face_of_probe_[p] == kNoFace) continue;
    first_corner_[p] = static_cast<std::uint32_t>(curves.corners.size());
    for (const ProbeSide& side : surface().sides_of(surface().probes[p])) {
      const std::uint32_t ball = first_atom(surface(), side);
      const Vec3d normal = unit(probe_center(p) - surface().center(ball));
      add_corner(surface().center(ball) + grown_.radius[ball] * normal, normal);
    }
  }
}

// Cusps, and the points of three creases. The first patch that has a point places it.
void CurveComplex::place_named_corners() {
  const double p = surface().probe_radius;
  std::vector<NamedPoint> points;
  for (const RolledArc& arc : surface().arcs) {
    if (!counts(arc) || !profile_of(arc).spindle) continue;
    const Vec3d height = arc.cusp_height * arc.axis;
    points.push_back({cusp_of(arc, 0), arc.center - height, arc.axis});
    points.push_back({cusp_of(arc, 1), arc.center + height, -1.0 * arc.axis});
  }
  for (const ConcavePatch& patch : cut) {
    visit_creases(surface(), patch,
                  [&](const PatchSegment& s, const CreaseEnd&, const CreaseEnd& to) {
                    if (s.next == kNoIndex || to.is_cusp()) return;
                    const Vec3d at = probe_center(patch.probe) + p * s.to;
                    Vec3d normal{0, 0, 0};
                    for (const std::uint32_t probe : to.name) {
                      normal = normal + (probe_center(probe) - at);
                    }
                    points.push_back({to, at, unit(normal)});
                  });
  }
  std::stable_sort(points.begin(), points.end(),
                   [](const NamedPoint& a, const NamedPoint& b) { return a.name < b.name; });
  first_named_ = static_cast<std::uint32_t>(curves.corners.size());
  for (const NamedPoint& point : points) {
    if (!names_.empty() && names_.back() == point.name) continue;
    names_.push_back(point.name);
    add_corner(point.position, point.normal);
  }
}

std::uint32_t CurveComplex::contact_corner(std::uint32_t probe, std::uint32_t ball) const {
  const auto sides = surface().sides_of(surface().probes[probe]);
  const auto found = std::find_if(sides.begin(), sides.end(), [&](const ProbeSide& side) {
    return first_atom(surface(), side) == ball;
  });
  if (found == sides.end()) refuse(probe, "its sides do not close");
  return first_corner_[probe] + static_cast<std::uint32_t>(found - sides.begin());
}

std::uint32_t CurveComplex::named_corner(const CreaseEnd& end) const {
  const auto found = std::lower_bound(names_.begin(), names_.end(), end);
  if (found == names_.end() || *found != end) refuse(end.name[0], "a crease has no end");
  return first_named_ + static_cast<std::uint32_t>(found - names_.begin());
}

std::uint32_t CurveComplex::add_curve(const BoundaryArc& curve, const Rims& rims) {
  curves.arcs.push_back(curve);
  rims_.push_back(rims);
  return static_cast<std::uint32_t>(curves.arcs.size() - 1);
}

// A whole ring begins and ends at `radial`, where its seam is.
std::array<std::uint32_t, 2> CurveComplex::ring_corners(const RolledArc& arc, const Vec3d& radial) {
  std::array<std::uint32_t, 2> corners{};
  for (std::size_t k = 0; k < 2; ++k) {
    const Vec3d center = surface().center(arc.ball[k]);
    const Vec3d normal = unit(arc.center + arc.circle_radius * radial - center);
    corners[k] = add_corner(center + grown_.radius[arc.ball[k]] * normal, normal);
  }
  return corners;
}

void CurveComplex::add_arc(std::uint32_t a, double edge_length) {
  const RolledArc& arc = surface().arcs[a];
  const bool ring = arc.is_ring();
  const std::array<Vec3d, 2> radial =
      ring ? std::array{any_orthogonal(arc.axis), any_orthogonal(arc.axis)} : arc.radial;
  std::array<std::array<std::uint32_t, 2>, 2> corner{};  // by end of the arc, by ball
  if (ring) corner[0] = corner[1] = ring_corners(arc, radial[0]);
  for (std::size_t end = 0; end < 2 && !ring; ++end) {
    for (std::size_t k = 0; k < 2; ++k) {
      corner[end][k] = contact_corner(arc.probe[end], arc.ball[k]);
    }
  }
  const std::vector<SaddlePart> parts = saddle_parts(arc, surface().probe_radius, edge_length);
  const auto cusp = [&](std::uint32_t half) {
    const std::uint32_t at = named_corner(cusp_of(arc, half));
    return PartEnd{kNoIndex, {at, at}};
  };
  PartEnd high{};  // of the part before
  for (const SaddlePart& part : parts) {
    const auto index = static_cast<std::uint32_t>(saddles.size());
    const auto contact = [&](std::uint32_t k) {
      const std::array<std::uint32_t, 2> ends{corner[0][k], corner[1][k]};
      return PartEnd{add_contact(a, k, radial[0], ends, index), ends};
    };
    const PartEnd low = &part == &parts.front() ? contact(0) : part.half == 1 ? cusp(1) : high;
    high = &part == &parts.back() ? contact(1)
           : part.half == 0       ? cusp(0)
                                  : add_waist(a, part.to, radial, index);
    SaddleFace face{a, part, {low.curve, high.curve}, {}};
    for (std::size_t end = 0; end < (ring ? 1 : 2); ++end) {
      const ProfileRange range{part.from, part.to, {low.corners[end], high.corners[end]}};
      face.profile[end] = add_profile(a, end, radial[end], range, index);
    }
    if (ring) face.profile[1] = face.profile[0];
    saddles.push_back(face);
  }
}

// The curve along the arc between a part of a saddle and the next one, at a profile angle.
CurveComplex::PartEnd CurveComplex::add_waist(std::uint32_t a, double profile,
                                              const std::array<Vec3d, 2>& radial,
                                              std::uint32_t saddle) {
  const RolledArc& arc = surface().arcs[a];
  const double p = surface().probe_radius, c = std::cos(profile), s = std::sin(profile);
  BoundaryArc curve{};
  curve.radius = arc.circle_radius - p * c;
  curve.balls = {saddle_face(saddle), saddle_face(saddle + 1)};
  curve.center = arc.center + (p * s) * arc.axis;
  curve.cosine = curve.radius * radial[0];
  curve.sine = curve.radius * cross(arc.axis, radial[0]);
  curve.sweep = arc.angle;
  for (std::size_t end = 0; end < 2; ++end) {
    curve.ends[end] =
        end == 1 && arc.is_ring()
            ? curve.ends[0]
            : add_corner(curve.center + curve.radius * radial[end], c * radial[end] - s * arc.axis);
  }
  return {add_curve(curve, {Kind::waist, {a, a}, {0, 0}}), curve.ends};
}

// The contact curve on the atom of ball k. It runs about the axis like the arc.
std::uint32_t CurveComplex::add_contact(std::uint32_t a, std::uint32_t k, const Vec3d& radial,
                                        std::array<std::uint32_t, 2> ends, std::uint32_t saddle) {
  const RolledArc& arc = surface().arcs[a];
  const std::uint32_t ball = arc.ball[k];
  const double grown = grown_.triangulation.balls[ball].radius;
  const double share = grown_.radius[ball] / grown;
  const double radius = share * arc.circle_radius;
  const Vec3d from_center = (k == 0 ? arc.height[0] : -arc.height[1]) * arc.axis;
  const std::uint32_t contact = face_of_ball_[ball], torus = saddle_face(saddle);
  BoundaryArc curve{};
  curve.balls = k == 0 ? std::array{contact, torus} : std::array{torus, contact};
  curve.ends = ends;
  curve.center = surface().center(ball) + share * from_center;
  curve.cosine = radius * radial;
  curve.sine = radius * cross(arc.axis, radial);
  curve.sweep = arc.angle;
  curve.radius = radius;
  const double cosine = arc.height[k] / grown;
  return add_curve(curve, {Kind::contact, {arc.edge, arc.edge}, {cosine, cosine}});
}

// The curve along which the probe at one end of the arc touches the saddle, or a part of that curve
// up to a cusp.
std::uint32_t CurveComplex::add_profile(std::uint32_t a, std::size_t end, const Vec3d& radial,
                                        const ProfileRange& range, std::uint32_t saddle) {
  const RolledArc& arc = surface().arcs[a];
  const double p = surface().probe_radius;
  const std::uint32_t torus = saddle_face(saddle);
  const std::uint32_t concave = arc.is_ring() ? torus : face_of_probe_[arc.probe[end]];
  const double c = std::cos(range.from), s = std::sin(range.from);
  BoundaryArc curve{};
  curve.balls = end == 0 ? std::array{concave, torus} : std::array{torus, concave};
  curve.ends = range.ends;
  curve.center = arc.center + arc.circle_radius * radial;
  curve.cosine = p * (s * arc.axis - c * radial);
  curve.sine = p * (c * arc.axis + s * radial);
  curve.sweep = range.to - range.from;
  curve.radius = p;
  constexpr std::uint32_t kSide = 0x80000000u;  // creases are named by probes
  const std::uint32_t name = kSide | (2 * a + static_cast<std::uint32_t>(end));
  return add_curve(curve, {Kind::side, {name, name}, {0, 0}});
}

// Adds each crease once, for its probe of lower number.
void CurveComplex::add_creases() {
  std::vector<CreaseName> all;
  for (const ConcavePatch& patch : cut) {
    visit_creases(surface(), patch,
                  [&](const PatchSegment& s, const CreaseEnd& from, const CreaseEnd& to) {
                    all.push_back({patch.probe, patch.caps[s.circle].probe, from, to});
                  });
  }
  std::sort(all.begin(), all.end());
  for (const CreaseName& c : all) {
    if (!std::binary_search(all.begin(), all.end(), CreaseName{c.other, c.probe, c.to, c.from})) {
      refuse(c.probe, "the patch beside it does not share a crease");
    }
  }
  for (const ConcavePatch& patch : cut) {
    visit_creases(surface(), patch,
                  [&](const PatchSegment& s, const CreaseEnd& from, const CreaseEnd& to) {
                    if (patch.caps[s.circle].probe > patch.probe) add_crease(patch, s, from, to);
                  });
  }
}

// Segments run clockwise about the axis of their cap, with the patch of their own probe on the
// left.
void CurveComplex::add_crease(const ConcavePatch& patch, const PatchSegment& s,
                              const CreaseEnd& from, const CreaseEnd& to) {
  const double p = surface().probe_radius;
  const PatchCap& cap = patch.caps[s.circle];
  const Vec3d radial = unit(s.from - dot(s.from, cap.axis) * cap.axis);
  BoundaryArc curve{};
  curve.radius = p * std::sqrt((1 - cap.cosine) * (1 + cap.cosine));
  curve.balls = {face_of_probe_[cap.probe], face_of_probe_[patch.probe]};
  curve.ends = {kNoIndex, kNoIndex};
  if (s.next != kNoIndex) curve.ends = {named_corner(from), named_corner(to)};
  curve.center = probe_center(patch.probe) + (p * cap.cosine) * cap.axis;
  curve.cosine = curve.radius * radial;
  curve.sine = curve.radius * cross(radial, cap.axis);
  curve.sweep = s.angle;
  add_curve(curve, {Kind::crease, {patch.probe, cap.probe}, {cap.cosine, cap.cosine}});
}

std::vector<RimArc> CurveComplex::rims_of(std::uint32_t face) const {
  std::vector<RimArc> rims;
  for (const std::uint32_t c : curves_of(face)) {
    const std::size_t side = curves.arcs[c].balls[0] == face ? 0 : 1;
    rims.push_back({c, rims_[c].circle[side], rims_[c].cosine[side]});
  }
  return rims;
}

PatchVector<CoveredCap> CurveComplex::caps_of(const SphereFace& face) const {
  PatchVector<CoveredCap> caps;
  const auto& balls = grown_.triangulation.balls;
  if (!face.concave) {
    for (const std::uint32_t n : neighbors_[face.element]) {
      caps.push_back(covered_cap(curves, balls[face.element], balls[n]));
    }
    return caps;
  }
  const auto add_sides = [&](const std::vector<PatchSide>& sides) {
    for (const PatchSide& side : sides) caps.push_back({-1.0 * side.inward, 0, 2});
  };
  if (face.patch == kNoIndex) {
    add_sides(patch_sides(surface(), surface().probes[face.element]));
    return caps;
  }
  add_sides(cut[face.patch].sides);
  for (const PatchCap& c : cut[face.patch].caps) {
    caps.push_back({c.axis, c.cosine, 2 * (1 - c.cosine)});
  }
  return caps;
}

Vec3d CurveComplex::normal_on(std::uint32_t curve, const Vec3d& point) const {
  const auto toward = [&](std::uint32_t face) {
    const SphereFace& f = spheres[face];
    const Vec3d out = unit(point - f.sphere.center);
    return f.concave ? -1.0 * out : out;
  };
  const auto& [right, left] = curves.arcs[curve].balls;
  switch (rims_[curve].kind) {
    case Kind::contact:
      return toward(std::min(right, left));
    case Kind::waist: {
      const RolledArc& arc = surface().arcs[saddles[left - spheres.size()].arc];
      const Vec3d radial = unit(point - curves.arcs[curve].center);
      return unit(arc.center + arc.circle_radius * radial - point);
    }
    case Kind::side:
      return unit(curves.arcs[curve].center - point);
    case Kind::crease:
      break;
  }
  const Vec3d sum = toward(right) + toward(left);
  return squared_norm(sum) > 1e-12 ? unit(sum) : toward(right);
}

void CurveComplex::refuse(std::uint32_t probe, const std::string& why) const {
  std::string atoms;
  for (const std::uint32_t v : surface().triangle_of(surface().probes[probe].corner).vertices) {
    atoms += fmt::format("{}{}", atoms.empty() ? "" : ", ", grown_.triangulation.ids[v]);
  }
  throw LimitExceeded(
      fmt::format("the excluded surface has no mesh: the concave patch of the probe at spheres {} "
                  "is not certified, {}",
                  atoms, why));
}

}  // namespace vdwmesh::excluded

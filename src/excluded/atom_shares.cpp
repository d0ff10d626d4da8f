// atom_shares(): divides a patch by the great circles between the points of contact.
//
// The area of a region on the unit sphere is the sum over its boundary of signed fans from a point
// z: fan(arc) is the area between the arc and the great circles from z to its ends. Boundary
// segments of the patch are cut where they cross the bisecting great circles, and each part counts
// for the atom that is nearest to it. The bisecting circles themselves bound the shares too. For
// three atoms all of them run through the point that is equally far from the three, which is z, so
// that their fans are empty; for more atoms their parts in the patch are found and added.
#include "excluded/atom_shares.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "arrangement/directions.hpp"
#include "excluded/cap_arrangement.hpp"
#include "excluded/cap_face.hpp"

namespace vdwmesh::excluded {
namespace {

// The signed solid angle of a spherical triangle of unit vectors (Van Oosterom and Strackee 1983).
double triangle_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return 2 * std::atan2(triple_product(a, b, c), 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

// A directed circular arc on the unit sphere.
struct SphereArc {
  Vec3d axis;
  double cosine;  // of the circle
  Vec3d from;
  double angle;  // counter-clockwise about the axis; negative: clockwise

  Vec3d at(double fraction) const {
    const Vec3d arm = from - cosine * axis;
    const double phi = fraction * angle;
    return cosine * axis + std::cos(phi) * arm + std::sin(phi) * cross(axis, arm);
  }
};

// The fan from z over an arc of at most a radian: over the chord, and between chord and arc, which
// is the difference of the fans from the circle's axis.
double short_fan(const Vec3d& z, const SphereArc& arc, const Vec3d& p, const Vec3d& q,
                 double angle) {
  return triangle_angle(z, p, q) + angle * (1 - arc.cosine) - triangle_angle(arc.axis, p, q);
}

double fan(const Vec3d& z, const SphereArc& arc, double begin, double end) {
  const double angle = (end - begin) * arc.angle;
  const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(angle))));
  double sum = 0;
  Vec3d p = arc.at(begin);
  for (int i = 1; i <= steps; ++i) {
    const Vec3d q = arc.at(begin + (end - begin) * i / steps);
    sum += short_fan(z, arc, p, q, angle / steps);
    p = q;
  }
  return sum;
}

class ShareFinder {
 public:
  ShareFinder(const AccessibleSurface& surface, const ConcavePatch& patch)
      : surface_(surface), patch_(patch) {
    find_atoms();
    if (shares_.size() < 3) return;
    apex_ = cross(toward(1, 0), toward(2, 0));
    const double size = norm(apex_);
    apex_ = size > 0 ? (1 / size) * apex_ : touch_[0];
    if (dot(apex_, touch_[0]) < 0) apex_ = -1.0 * apex_;
  }

  std::vector<AtomShare> find() && {
    if (shares_.empty()) return {};
    for (const PatchSegment& s : patch_.segments) add_segment(arc_of(s));
    if (shares_.size() > 3) add_bisectors();
    for (std::size_t i = 0; i < shares_.size(); ++i) {
      shares_[i].cones = (shares_[i].solid_angle + flat_cones(i)) / 3;
    }
    return std::move(shares_);
  }

 private:
  void find_atoms() {
    const Probe& probe = surface_.probes[patch_.probe];
    for (const CornerIndex c : surface_.corners_of(probe)) {
      for (const std::uint32_t v : surface_.triangle_of(c).vertices) {
        const auto is_v = [&](const AtomShare& s) { return s.ball == v; };
        if (std::any_of(shares_.begin(), shares_.end(), is_v)) continue;
        shares_.push_back({v, 0, 0});
        touch_.push_back(unit(surface_.between(probe, v)));
      }
    }
  }

  // The vector from the point of contact with atom j to that with atom i, at right angles to the
  // plane that bisects them. It is the difference of (c - x) / R for the grown balls of both, in
  // which atoms that all but coincide keep their digits.
  Vec3d toward(std::size_t i, std::size_t j) const {
    const auto& balls = surface_.triangulation().balls;
    const Sphere &a = balls[shares_[i].ball], &b = balls[shares_[j].ball];
    return (1 / a.radius) * ((a.center - b.center) + (b.radius - a.radius) * touch_[j]);
  }

  SphereArc arc_of(const PatchSegment& s) const {
    const auto caps = static_cast<std::uint32_t>(patch_.caps.size());
    if (s.circle >= caps) return {patch_.sides[s.circle - caps].inward, 0, s.from, s.angle};
    const PatchCap& cap = patch_.caps[s.circle];
    return {cap.axis, cap.cosine, s.from, -s.angle};
  }

  std::size_t nearest(const Vec3d& w) const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < touch_.size(); ++i) {
      if (dot(toward(i, best), w) > 0) best = i;
    }
    return best;
  }

  void add_segment(const SphereArc& arc) {
    std::vector<double> cuts{0, 1};
    for (std::size_t i = 0; i < touch_.size(); ++i) {
      for (std::size_t j = i + 1; j < touch_.size(); ++j) add_cuts(arc, toward(i, j), cuts);
    }
    std::sort(cuts.begin(), cuts.end());
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
      const std::size_t atom = nearest(arc.at((cuts[k] + cuts[k + 1]) / 2));
      shares_[atom].solid_angle += fan(apex_, arc, cuts[k], cuts[k + 1]);
    }
  }

  // Adds the fractions of the arc at which it crosses the plane with this normal.
  static void add_cuts(const SphereArc& arc, const Vec3d& normal, std::vector<double>& cuts) {
    const Vec3d arm = arc.from - arc.cosine * arc.axis;
    const double x = dot(normal, arm), y = dot(normal, cross(arc.axis, arm));
    const double ratio = -arc.cosine * dot(normal, arc.axis) / std::hypot(x, y);
    if (!(std::abs(ratio) < 1)) return;
    for (const double sign : {-1.0, 1.0}) {
      double phi = std::atan2(y, x) + sign * std::acos(ratio);
      if (arc.angle < 0) phi = -phi;
      phi = std::remainder(phi, 2 * std::numbers::pi);
      if (phi < 0) phi += 2 * std::numbers::pi;
      const double fraction = phi / std::abs(arc.angle);
      if (fraction < 1) cuts.push_back(fraction);
    }
  }

  // Each part of a bisecting circle in the patch bounds the shares of both atoms.
  void add_bisectors() {
    for (std::size_t i = 0; i < touch_.size(); ++i) {
      for (std::size_t j = i + 1; j < touch_.size(); ++j) add_bisector(i, j);
    }
  }

  static CapCircle<double> circle(const Vec3d& axis, double cosine) {
    return cap_circle(vector_in<double>(axis), cosine);
  }

  void add_bisector(std::size_t i, std::size_t j) {
    const Vec3d axis = unit(toward(i, j));
    std::vector<CapCircle<double>> others;
    for (const PatchCap& c : patch_.caps) others.push_back(circle(c.axis, c.cosine));
    for (const PatchSide& s : patch_.sides) others.push_back(circle(-1.0 * s.inward, 0));
    for (std::size_t k = 0; k < touch_.size(); ++k) {
      if (k != i && k != j) others.push_back(circle(unit(toward(k, i)), 0));
    }
    const CapCircle<double> self = circle(axis, 0);
    std::vector<Covered<double>> covered;
    double margin = 1;
    for (const CapCircle<double>& other : others) {
      Covered<double> part{};
      const Overlap overlap = covered_part(self, other, 0, part, margin);
      if (overlap == Overlap::whole) return;
      if (overlap == Overlap::crossing) covered.push_back(part);
    }
    if (covered.empty()) return;
    for (const Uncovered<double>& part : uncovered_parts(covered, margin)) {
      const double share = fan(apex_, {axis, 0, to_vec(part.behind.to.point), part.angle}, 0, 1);
      shares_[i].solid_angle += share;
      shares_[j].solid_angle -= share;
    }
  }

  // Three times the volume of the cones over the parts of the caps' flat faces that belong to atom
  // i.
  double flat_cones(std::size_t i) const {
    std::vector<HalfSpace> within;
    for (std::size_t j = 0; j < touch_.size(); ++j) {
      if (j != i) within.push_back({toward(j, i), 0});
    }
    return flat_faces(patch_, within);
  }

  const AccessibleSurface& surface_;
  const ConcavePatch& patch_;
  std::vector<AtomShare> shares_;
  std::vector<Vec3d> touch_;  // unit vectors to the points of contact
  Vec3d apex_{0, 0, 1};
};

}  // namespace

std::vector<AtomShare> atom_shares(const AccessibleSurface& surface, const ConcavePatch& patch) {
  return ShareFinder(surface, patch).find();
}

}  // namespace vdwmesh::excluded

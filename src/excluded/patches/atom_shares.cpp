// atom_shares(): divides a patch by the great circles between the points of contact.
//
// The area of a share is a sum of fans from a point z (share_formulas.hpp). Boundary segments of
// the patch are cut where they cross the bisecting great circles, and each part counts for the atom
// that is nearest to it. Parts of the bisecting circles bound the shares too. With three atoms all
// these circles run through z, the point that is equally far from the three, so their fans have no
// area. With more atoms the parts that lie in the patch are found, and their fans are added.
//
// Fans give the area of a region only if the point opposite to z is outside of it. That point may
// be in the patch if the patch is a half-sphere or larger, as that of a probe that its atoms hold
// from all sides. Then z is taken opposite to the point of contact with an atom, which is inside of
// that atom's share, and the whole sphere is added to this share.
#include "excluded/patches/atom_shares.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "spheres/directions.hpp"

namespace vdwmesh::excluded {
namespace {

// A whole sphere is missing where fans do not give an area, and otherwise rounding.
constexpr double kWhole = 1e-3;

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
    if (!add_fans()) turn_apex();
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

  // How far the shares are from the whole patch in sum.
  double missing() const {
    double sum = 0;
    for (const PatchPiece& piece : patch_.pieces) sum += piece.solid_angle;
    for (const AtomShare& share : shares_) sum -= share.solid_angle;
    return sum;
  }

  // Whether the shares make up the patch.
  bool add_fans() {
    for (const PatchSegment& s : patch_.segments) add_segment(patch_.arc_of(s));
    if (shares_.size() > 3) add_bisectors();
    return std::abs(missing()) < kWhole;
  }

  // If no apex makes the shares whole, they stay as they were first.
  void turn_apex() {
    const std::vector<AtomShare> first = shares_;
    for (std::size_t k = 0; k < touch_.size(); ++k) {
      for (AtomShare& share : shares_) share.solid_angle = 0;
      apex_ = -1.0 * touch_[k];
      shares_[k].solid_angle = 4 * std::numbers::pi;
      if (add_fans()) return;
    }
    shares_ = first;
  }

  // The vector from the point of contact with atom j to that with atom i, at right angles to the
  // plane that bisects them. The unit vector to a point of contact is (c - x) / R, with the centre
  // c and the radius R of the grown ball and the probe's centre x. The difference of two such
  // vectors is formed so that atoms that all but coincide lose no digits.
  Vec3d toward(std::size_t i, std::size_t j) const {
    const auto& balls = surface_.triangulation().balls;
    const Sphere &a = balls[shares_[i].ball], &b = balls[shares_[j].ball];
    return (1 / a.radius) * ((a.center - b.center) + (b.radius - a.radius) * touch_[j]);
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
      for (std::size_t j = i + 1; j < touch_.size(); ++j) {
        cross_plane(arc, toward(i, j), [&](double fraction) { cuts.push_back(fraction); });
      }
    }
    std::sort(cuts.begin(), cuts.end());
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
      const std::size_t atom = nearest(arc.at((cuts[k] + cuts[k + 1]) / 2));
      shares_[atom].solid_angle += fan(apex_, arc, cuts[k], cuts[k + 1]);
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
    std::vector<CoveredArc<double>> covered;
    double margin = 1;
    for (const CapCircle<double>& other : others) {
      CoveredArc<double> part{};
      const Overlap overlap = covered_part(self, other, 0, part, margin);
      if (overlap == Overlap::whole) return;
      if (overlap == Overlap::crossing) covered.push_back(part);
    }
    if (covered.empty()) return;
    visit_uncovered<HeapLists, kMostCaps>(
        covered, margin,
        [&](const CoveredArc<double>& behind, const CoveredArc<double>&, double angle) {
          const double share = fan(apex_, {axis, 0, to_vec(behind.to.point), angle}, 0, 1);
          shares_[i].solid_angle += share;
          shares_[j].solid_angle -= share;
        });
  }

  // Three times the volume of the cones over the parts of the caps' flat faces that belong to atom
  // i.
  double flat_cones(std::size_t i) const {
    return flat_faces(patch_, [&](CapFace<HeapLists>& face) {
      for (std::size_t j = 0; j < touch_.size(); ++j) {
        if (j != i) face.clip(toward(j, i), 0);
      }
    });
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

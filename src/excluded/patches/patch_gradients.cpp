// patch_gradients(): what each patch does to area and volume if its centre moves.
//
// With the unit normal n of the solid, a surface of speed v along n changes its volume by ∫ v dA
// and its area by ∫ (div n) v dA. On a contact patch of radius r, div n = 2/r. On the others the
// surface is the probe's: v = n·dx - dp, with the motion dx of the probe's centre x.
//
// A probe keeps touching its atoms. With P_a = x - c_a for an atom at c_a, and R_a = |P_a|,
//   P_a·dx = P_a·dc_a + R_a (dr_a + dp),
// so that of a measure with the derivative f by x, atom a has k_a P_a by its centre and k_a R_a by
// its radius, where Σ k_a P_a = f, as of forces in balance.
//
// Saddle, in the letters of saddle_formulas.hpp: per angle φ of the arc f = F e + G u, with
// integrals over α of cos α, -sin α and what follows:
//   volume: p (ρ - p cos α) dα          area: (2 p cos α - ρ) dα
// With the heights t_a, t_b and the distance D = t_a + t_b of the atoms, k_a = (F t_b/ρ + G) / D
// and k_b = (F t_a/ρ - G) / D. The integral of P_a along the arc is ρ E + t_a Φ u.
//
// Concave, with the probe's unit sphere of points w = -n: f = -p² ∫ w dω for the volume and
// 2 p ∫ w dω - p Σ h ∫ w dψ for the area, where the sum is over the creases: in a crease two
// patches meet at an angle, and the area between them changes as the crease moves. With circles of
// cosine h on the unit sphere, half of it is -p h ∫ (w·dx + dp) dψ from either side.
#include "excluded/patches/patch_gradients.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/sum.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh::excluded {
namespace {

// Probes nearer than this (scaled) to a case without derivative count as that case. The motion of a
// probe across the plane of its atoms grows with the inverse of its height over it.
constexpr double kKink = 1e-9;

// What one ball has from one patch.
struct BallShareGradient {
  std::uint32_t ball;
  BallGradient gradient;
};

// Shares of balls, and derivatives of the area and the volume by the probe's radius in which the
// balls' radii stay.
struct PatchGradient {
  std::vector<BallShareGradient> shares;
  double area_probe, volume_probe;
};

// Integrals over profile angles α of 1, cos α, sin α, cos² α and sin α cos α.
struct ProfileSums {
  double one = 0, cosine = 0, sine = 0, cosine2 = 0, sine_cosine = 0;

  // Adds a range of a width about its middle.
  void add(double middle, double width) {
    const double chord = 2 * std::sin(width / 2), twice = std::sin(width);
    one += width;
    cosine += chord * std::cos(middle);
    sine += chord * std::sin(middle);
    cosine2 += (width + twice * std::cos(2 * middle)) / 2;
    sine_cosine += twice * std::sin(2 * middle) / 2;
  }
};

// Over the whole saddle. The distance of the atoms gives the width of a profile without cusps,
// which keeps its digits where atoms all but coincide.
ProfileSums profile_sums(const ArcShape& arc, double distance) {
  const Profile profile = profile_of(arc);
  const auto& [from, to] = profile.end;
  ProfileSums sums;
  if (profile.spindle) {
    sums.add((from - profile.cusp) / 2, -profile.cusp - from);
    sums.add((to + profile.cusp) / 2, to - profile.cusp);
  } else {
    const double rho = arc.circle_radius;
    sums.add((from + to) / 2,
             std::atan2(rho * distance, rho * rho - arc.height[0] * arc.height[1]));
  }
  return sums;
}

BallGradient sum(const BallGradient& a, const BallGradient& b) {
  return {a.area_center + b.area_center, a.area_radius + b.area_radius,
          a.volume_center + b.volume_center, a.volume_radius + b.volume_radius};
}

// The shares g of atoms in the motion of a probe: dx = Σ g_a (P_a·dc_a + R_a dr_a).
std::vector<Vec3d> inverse_arms(const std::vector<Vec3d>& arms) {
  const double inverse = 1 / triple_product(arms[0], arms[1], arms[2]);
  return {inverse * cross(arms[1], arms[2]), inverse * cross(arms[2], arms[0]),
          inverse * cross(arms[0], arms[1])};
}

// Those of least squares, of any number of arms. Across the plane of arms that are flat there is no
// motion.
std::vector<Vec3d> fitted_arms(const std::vector<Vec3d>& arms, bool flat) {
  std::array<Vec3d, 3> m{};  // Σ P Pᵀ
  Vec3d normal{0, 0, 0};
  double trace = 0;
  for (std::size_t i = 0; i < arms.size(); ++i) {
    const Vec3d& a = arms[i];
    m = {m[0] + a.x * a, m[1] + a.y * a, m[2] + a.z * a};
    trace += squared_norm(a);
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3d across = cross(arms[j], a);
      if (squared_norm(across) > squared_norm(normal)) normal = across;
    }
  }
  if (flat) {
    const Vec3d n = unit(normal);
    m = {m[0] + trace * n.x * n, m[1] + trace * n.y * n, m[2] + trace * n.z * n};
  }
  const std::vector<Vec3d> columns = inverse_arms({m[0], m[1], m[2]});
  std::vector<Vec3d> fitted;
  for (const Vec3d& a : arms) {
    fitted.push_back(a.x * columns[0] + a.y * columns[1] + a.z * columns[2]);
    if (flat) fitted.back() = fitted.back() - dot(fitted.back(), unit(normal)) * unit(normal);
  }
  return fitted;
}

class GradientSum {
 public:
  GradientSum(const AccessibleSurface& surface, const PatchRecords& records,
              std::span<const std::uint8_t> included, std::span<const double> radius)
      : surface_(surface),
        records_(records),
        included_(included),
        radius_(radius),
        balls_(surface.triangulation().balls),
        p_(surface.probe_radius),
        by_ball_(balls_.size(), BallGradient{}) {}

  void run(Monitor* monitor) {
    add_contacts();
    advance(monitor, 0);
    add_saddles();
    advance(monitor, 0);
    add_concave();
    advance(monitor, 0);
  }

  ExcludedGradients result(std::size_t count) const {
    const PowerTriangulation& t = surface_.triangulation();
    const int length = t.scale_exponent, square = 2 * length;
    const auto scaled = [](const Vec3d& v, int exponent) {
      return Vec3d{std::ldexp(v.x, exponent), std::ldexp(v.y, exponent), std::ldexp(v.z, exponent)};
    };
    ExcludedGradients out{};
    out.per_atom.assign(count, BallGradient{});
    for (std::size_t v = 0; v < balls_.size(); ++v) {
      const BallGradient& g = by_ball_[v];
      out.per_atom[t.ids[v]] = {scaled(g.area_center, length), std::ldexp(g.area_radius, length),
                                scaled(g.volume_center, square),
                                std::ldexp(g.volume_radius, square)};
    }
    out.area_probe = std::ldexp(area_probe_.value(), length);
    out.volume_probe = std::ldexp(volume_probe_.value(), square);
    out.kink_probes = kink_probes();
    return out;
  }

 private:
  void add(std::uint32_t ball, const BallGradient& g) { by_ball_[ball] = sum(by_ball_[ball], g); }

  // Atoms that follow the probe grow with it.
  void add(const PatchGradient& patch) {
    for (const BallShareGradient& share : patch.shares) {
      add(share.ball, share.gradient);
      area_probe_.add(share.gradient.area_radius);
      volume_probe_.add(share.gradient.volume_radius);
    }
    area_probe_.add(patch.area_probe);
    volume_probe_.add(patch.volume_probe);
  }

  void add_contacts() {
    for (const ContactPiece& c : surface_.contacts) {
      if (!included_[c.component]) continue;
      const double r = radius_[c.ball];
      add(c.ball,
          {(2 * r) * c.vector, 2 * r * c.solid_angle, (r * r) * c.vector, r * r * c.solid_angle});
    }
  }

  void add_saddles() {
    make_and_add(
        surface_.arcs.size(), [&](std::size_t i) { return saddle_gradient(surface_.arcs[i]); },
        [&](std::size_t, const PatchGradient& patch) { add(patch); });
  }

  PatchGradient saddle_gradient(const RolledArc& arc) const {
    const double rho = arc.circle_radius, distance = surface_.shapes().edge(arc.edge).length;
    if (!surface_.counts(arc, included_) || !(rho > 0)) return {};
    const ProfileSums sum = profile_sums(arc, distance);
    const double area_across = 2 * p_ * sum.cosine2 - rho * sum.cosine,
                 area_along = rho * sum.sine - 2 * p_ * sum.sine_cosine,
                 volume_across = p_ * (rho * sum.cosine - p_ * sum.cosine2),
                 volume_along = p_ * (p_ * sum.sine_cosine - rho * sum.sine);
    PatchGradient out{{},
                      arc.angle * (rho * sum.one - 2 * p_ * sum.cosine),
                      arc.angle * p_ * (p_ * sum.cosine - rho * sum.one)};
    for (std::size_t k = 0; k < 2; ++k) {
      const double sign = k == 0 ? 1 : -1, lever = arc.height[1 - k] / rho;
      const double area = (area_across * lever + sign * area_along) / distance,
                   volume = (volume_across * lever + sign * volume_along) / distance;
      const Vec3d arm = rho * radial_integral(arc) + (sign * arc.height[k] * arc.angle) * arc.axis;
      const double grown = balls_[arc.ball[k]].radius * arc.angle;
      out.shares.push_back({arc.ball[k], {area * arm, area * grown, volume * arm, volume * grown}});
    }
    return out;
  }

  void add_concave() {
    make_and_add(
        records_.pieces.size(), [&](std::size_t i) { return concave_gradient(records_.pieces[i]); },
        [&](std::size_t, const PatchGradient& patch) { add(patch); });
  }

  PatchGradient concave_gradient(const ConcavePiece& piece) const {
    const Probe& probe = surface_.probes[piece.probe];
    const Vec3d area = p_ * (2.0 * piece.vector - piece.crease_vector),
                volume = (-p_ * p_) * piece.vector;
    PatchGradient out{
        {}, p_ * (2 * piece.solid_angle - piece.crease_turn), -p_ * p_ * piece.solid_angle};
    const std::vector<std::uint32_t> atoms = atoms_at(probe);
    std::vector<Vec3d> arms;
    for (const std::uint32_t a : atoms) arms.push_back(-1.0 * surface_.between(probe, a));
    const bool flat = is_flat(probe);
    const std::vector<Vec3d> inverse =
        atoms.size() == 3 && !flat ? inverse_arms(arms) : fitted_arms(arms, flat);
    for (std::size_t i = 0; i < atoms.size(); ++i) {
      const double by_area = dot(area, inverse[i]), by_volume = dot(volume, inverse[i]),
                   grown = balls_[atoms[i]].radius;
      out.shares.push_back(
          {atoms[i], {by_area * arms[i], by_area * grown, by_volume * arms[i], by_volume * grown}});
    }
    return out;
  }

  std::vector<std::uint32_t> atoms_at(const Probe& probe) const {
    std::vector<std::uint32_t> atoms;
    for (const CornerIndex c : surface_.corners_of(probe)) {
      for (const std::uint32_t v : surface_.triangle_of(c).vertices) {
        if (std::find(atoms.begin(), atoms.end(), v) == atoms.end()) atoms.push_back(v);
      }
    }
    return atoms;
  }

  double height(CornerIndex corner) const {
    return surface_.shapes().corners(corner / 2).half_chord;
  }

  bool is_flat(const Probe& probe) const {
    const auto corners = surface_.corners_of(probe);
    return std::all_of(corners.begin(), corners.end(),
                       [&](CornerIndex c) { return height(c) <= kKink; });
  }

  // Whether the mirror image of a probe is one too and all but touches it, from outside. Pairs that
  // overlap have creases.
  bool touches_image(const Probe& probe) const {
    const auto corners = surface_.corners_of(probe);
    return std::any_of(corners.begin(), corners.end(), [&](CornerIndex c) {
      const bool both = surface_.triangle_of(c).exposed[0] && surface_.triangle_of(c).exposed[1];
      return both && !probe.low && height(c) <= p_ + kKink;
    });
  }

  std::uint64_t kink_probes() const {
    std::vector<std::uint8_t> kink(surface_.probes.size(), 0);
    for (std::size_t i = 0; i < kink.size(); ++i) {
      const Probe& probe = surface_.probes[i];
      if (!included_[probe.component]) continue;
      kink[i] = probe.corner_count > 1 || is_flat(probe) || touches_image(probe);
    }
    for (const Crease& c : records_.creases) {
      if (c.from != c.to || !(c.from.name[1] == kNoIndex)) continue;  // no whole circle
      const Vec3d apart = surface_.between(surface_.probes[c.probe], surface_.probes[c.other]);
      if (norm(apart) >= 2 * (p_ - kKink)) kink[c.probe] = 1;
    }
    return static_cast<std::uint64_t>(std::count(kink.begin(), kink.end(), 1));
  }

  const AccessibleSurface& surface_;
  const PatchRecords& records_;
  std::span<const std::uint8_t> included_;
  std::span<const double> radius_;
  const std::vector<Sphere>& balls_;
  const double p_;
  std::vector<BallGradient> by_ball_;
  WideSum area_probe_, volume_probe_;
};

// How many atoms equal one of a lower index.
std::uint64_t equal_atoms(const SphereSet& atoms) {
  using Row = std::array<double, 4>;
  std::vector<Row> rows;
  for (const Sphere& s : atoms.spheres()) {
    rows.push_back({s.center.x, s.center.y, s.center.z, s.radius});
  }
  std::sort(rows.begin(), rows.end());
  std::uint64_t count = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) count += rows[i] == rows[i - 1];
  return count;
}

void require_finite_gradients(const ExcludedGradients& gradients) {
  const auto is_finite = [](const BallGradient& g) {
    const auto [a, v] = std::pair(g.area_center, g.volume_center);
    return std::isfinite(a.x + a.y + a.z + g.area_radius) &&
           std::isfinite(v.x + v.y + v.z + g.volume_radius);
  };
  if (std::isfinite(gradients.area_probe) && std::isfinite(gradients.volume_probe) &&
      std::all_of(gradients.per_atom.begin(), gradients.per_atom.end(), is_finite)) {
    return;
  }
  throw InvalidInput(
      "derivatives of the excluded surface are not finite in double precision: the sizes of atoms "
      "and probe, or the distances of the atoms, differ by too many powers of ten");
}

}  // namespace

ExcludedGradients patch_gradients(const AccessibleSurface& surface, const PatchRecords& records,
                                  std::span<const std::uint8_t> included,
                                  std::span<const double> radius, const SphereSet& atoms,
                                  Monitor* monitor) {
  GradientSum sum(surface, records, included, radius);
  sum.run(monitor);
  ExcludedGradients out = sum.result(atoms.size());
  // Balls of one centre are one ball of the triangulation.
  if (surface.triangulation().balls.size() < atoms.size()) out.kink_atoms = equal_atoms(atoms);
  require_finite_gradients(out);
  return out;
}

}  // namespace vdwmesh::excluded

// excluded_measures(): sums over the patches of the excluded surface.
//
// The triangulation, the dual complex and everything after them are those of the balls grown by the
// probe, with lengths divided by 2^scale_exponent, which is exact. The volume is the flux of the
// position, ∫ q · n dA / 3, from a point near each closed part. The second volume takes the layer
// between the accessible and the excluded surface away from the accessible solid: cones and sectors
// along the segments from each point of the accessible surface to the points of contact below it.
#include "excluded/excluded_measures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/sum.hpp"
#include "excluded/patches/atom_shares.hpp"
#include "excluded/patches/patch_gradients.hpp"
#include "excluded/patches/patch_records.hpp"
#include "excluded/probes/excluded_shells.hpp"
#include "excluded/probes/kept_surface.hpp"
#include "measures/measures.hpp"

namespace vdwmesh {
namespace {

using namespace excluded;

// A sum of vectors in more than double precision.
struct WideVector {
  WideSum x, y, z;
  void add(const Vec3d& v) {
    x.add(v.x);
    y.add(v.y);
    z.add(v.z);
  }
  Vec3d value() const { return {x.value(), y.value(), z.value()}; }
};

// Sums over the patches that belong to some components of the accessible surface.
class SurfaceSums {
 public:
  SurfaceSums(const AccessibleSurface& surface, const PatchRecords& records,
              std::span<const std::uint8_t> included, std::span<const double> radius)
      : surface_(surface), records_(records), included_(included), radius_(radius) {
    add_contacts();
    add_saddles();
    add_concave();
    count_probes();
  }

  // Areas and volumes in units of 2^(2 exponent) and 2^(3 exponent).
  ExcludedSurface result(int exponent) const {
    const auto area_of = [&](const WideSum& s) { return std::ldexp(s.value(), 2 * exponent); };
    const auto volume_of = [&](const WideSum& s) { return std::ldexp(s.value(), 3 * exponent); };
    ExcludedSurface out{};
    out.area_by_kind = {area_of(area_[0]), area_of(area_[1]), area_of(area_[2])};
    out.layer_by_kind = {volume_of(layer_[0]), volume_of(layer_[1]), volume_of(layer_[2])};
    out.area = out.area_by_kind.sum();
    WideSum flux;
    for (const WideSum& part : flux_) flux.add(part);
    out.volume = volume_of(flux);
    for (std::size_t c = 0; c < surface_.components.size(); ++c) {
      if (!included_[c]) continue;
      out.accessible_area += std::ldexp(surface_.components[c].area, 2 * exponent);
      out.accessible_volume += std::ldexp(surface_.components[c].volume, 3 * exponent);
    }
    out.counts = counts_;
    out.checks.closure = std::ldexp(norm(vector_.value()), 2 * exponent) / out.area;
    out.checks.check_volume = out.accessible_volume - out.layer_by_kind.sum();
    out.checks.extended_decisions = records_.extended_decisions;
    out.checks.ties = records_.ties;
    out.checks.uncertified_patches = records_.uncertified;
    return out;
  }

 private:
  enum Kind : std::size_t { contact, saddle, concave };

  void add(Kind kind, double area, double flux, const Vec3d& vector) {
    area_[kind].add(area);
    flux_[kind].add(flux);
    vector_.add(vector);
  }

  const Vec3d& home_of(const RolledArc& arc) const {
    return records_.home[surface_.component_of(arc)];
  }

  void add_contacts() {
    for (const ContactPiece& c : surface_.contacts) {
      if (!included_[c.component]) continue;
      const double r = radius_[c.ball], grown = surface_.triangulation().balls[c.ball].radius;
      const Vec3d center = surface_.place(c.ball, records_.home[c.component]);
      add(contact, r * r * c.solid_angle, flux_through(r, center, c.solid_angle, c.vector),
          (r * r) * c.vector);
      layer_[contact].add(c.solid_angle * (grown * grown * grown - r * r * r) / 3);
    }
  }

  void add_saddles() {
    const double p = surface_.probe_radius;
    make_and_add(
        surface_.arcs.size(),
        [&](std::size_t i) {
          const RolledArc& arc = surface_.arcs[i];
          const Profile profile = profile_of(arc);
          return std::array{measure_saddle(arc, p, profile, 0), measure_saddle(arc, p, profile, 1)};
        },
        [&](std::size_t i, const std::array<SaddleMeasures, 2>& halves) {
          const RolledArc& arc = surface_.arcs[i];
          if (!surface_.counts(arc, included_)) return;
          const Vec3d at = surface_.place(arc, home_of(arc));
          for (const SaddleMeasures& m : halves) {
            add(saddle, m.area, m.flux + dot(at, m.vector) / 3, m.vector);
            layer_[saddle].add(m.layer);
          }
          ++counts_.arcs;
          counts_.whole_rings += arc.is_ring();
          counts_.spindle_saddles += profile_of(arc).spindle;
        });
  }

  void add_concave() {
    const double p = surface_.probe_radius;
    for (const ConcavePiece& c : records_.pieces) {
      const Probe& probe = surface_.probes[c.probe];
      const Vec3d x = surface_.place(probe, records_.home[probe.component]);
      add(concave, p * p * c.solid_angle, -flux_through(p, x, c.solid_angle, c.vector),
          (-p * p) * c.vector);
    }
    layer_[concave].add(records_.layer);
    counts_.crease_arcs = records_.creases.size() / 2;
  }

  void count_probes() {
    for (const Probe& probe : surface_.probes) {
      if (!included_[probe.component]) continue;
      ++counts_.probes;
      counts_.low_probes += probe.low;
      counts_.crowded_probes += probe.corner_count > 1;
      counts_.gathered_corners += probe.corner_count - 1;
    }
    for (const RolledArc& arc : surface_.arcs) {
      if (included_[surface_.component_of(arc)]) counts_.dropped_arcs += arc.dropped;
    }
  }

  const AccessibleSurface& surface_;
  const PatchRecords& records_;
  std::span<const std::uint8_t> included_;
  std::span<const double> radius_;
  std::array<WideSum, 3> area_, flux_, layer_;
  WideVector vector_;
  ExcludedCounts counts_{};
};

class ExcludedSum {
 public:
  ExcludedSum(const SphereSet& atoms, const ExcludedOptions& options, double no_length)
      : options_(options),
        atoms_(atoms),
        grown_(
            std::make_unique<const GrownAtoms>(atoms, options.probe, options.monitor, no_length)) {}

  ExcludedMeasures run() {
    ExcludedMeasures out{options_.probe, measure(std::vector<std::uint8_t>(components(), 1)), {}};
    if (options_.per_atom) out.complete.per_atom = atoms();
    if (!options_.exterior) return out;
    outer_ = surface_.outer_components();
    const bool all = std::find(outer_.begin(), outer_.end(), 0) == outer_.end();
    out.exterior = all ? out.complete : measure(outer_);
    out.exterior->per_atom.clear();
    return out;
  }

  // The parts of the surface that was measured last. Nothing else may be asked for after it.
  KeptSurface keep() && { return {std::move(grown_), std::move(outer_), std::move(records_)}; }

 private:
  std::size_t components() const { return surface_.components.size(); }

  ExcludedSurface measure(const std::vector<std::uint8_t>& included) {
    records_.reset();
    records_ = std::make_unique<const PatchRecords>(surface_, included, options_.monitor);
    const PatchRecords& records = *records_;
    const SurfaceSums sums(surface_, records, included, radius_);
    ExcludedSurface out = sums.result(exponent_);
    if (options_.shells) set_topology(out, records, included);
    if (options_.gradients) {
      out.gradients =
          patch_gradients(surface_, records, included, radius_, atoms_, options_.monitor);
    }
    return out;
  }

  // The shares of all atoms in the complete surface.
  std::vector<ExcludedAtom> atoms() const {
    const std::vector<std::uint8_t> all(components(), 1);
    std::vector<BallShare> shares(triangulation_.balls.size());
    const std::vector<SphereMeasures> solid = inclusion_exclusion(triangulation_, grown_->complex);
    for (std::size_t v = 0; v < shares.size(); ++v) shares[v].volume.add(solid[v].volume);
    share_contacts(shares);
    share_saddles(shares);
    share_concave(shares, all);
    std::vector<ExcludedAtom> out(atoms_.size(), ExcludedAtom{});
    for (std::size_t v = 0; v < shares.size(); ++v) {
      const auto area = [&](std::size_t k) { return std::ldexp(shares[v].area[k], 2 * exponent_); };
      out[triangulation_.ids[v]] = {{area(0), area(1), area(2)},
                                    std::ldexp(shares[v].volume.value(), 3 * exponent_)};
    }
    return out;
  }

  struct BallShare {
    std::array<double, 3> area{};
    WideSum volume;
  };

  void share_contacts(std::vector<BallShare>& shares) const {
    for (const ContactPiece& c : surface_.contacts) {
      const double r = radius_[c.ball], grown = triangulation_.balls[c.ball].radius;
      shares[c.ball].area[0] += r * r * c.solid_angle;
      shares[c.ball].volume.add(-c.solid_angle * (grown * grown * grown - r * r * r) / 3);
    }
  }

  void share_saddles(std::vector<BallShare>& shares) const {
    for (const RolledArc& arc : surface_.arcs) {
      if (arc.dropped) continue;
      const Profile profile = profile_of(arc);
      for (std::size_t k = 0; k < 2; ++k) {
        const SaddleMeasures m = measure_saddle(arc, surface_.probe_radius, profile, k);
        shares[arc.ball[k]].area[1] += m.area;
        shares[arc.ball[k]].volume.add(-m.layer);
      }
    }
  }

  void share_concave(std::vector<BallShare>& shares, std::span<const std::uint8_t> all) const {
    const LowProbes low(surface_, all);
    const double p = surface_.probe_radius;
    make_and_add(
        surface_.probes.size(),
        [&](std::size_t i) {
          const auto probe = static_cast<std::uint32_t>(i);
          return atom_shares(surface_, surface_.probes[i].low
                                           ? concave_patch(surface_, low, all, probe)
                                           : whole_patch(surface_, probe));
        },
        [&](std::size_t, const std::vector<AtomShare>& parts) {
          for (const AtomShare& part : parts) {
            shares[part.ball].area[2] += p * p * part.solid_angle;
            shares[part.ball].volume.add(-p * p * p * part.cones);
          }
        });
  }

  void set_topology(ExcludedSurface& out, const PatchRecords& records,
                    const std::vector<std::uint8_t>& included) {
    ShellTable table = excluded_shells(surface_, records, included, radius_);
    ExcludedTopology topology{};
    for (ExcludedShell& shell : table.shells) {
      shell.area = std::ldexp(shell.area, 2 * exponent_);
      shell.volume = std::ldexp(shell.volume, 3 * exponent_);
      topology.euler_characteristic += shell.euler_characteristic;
      topology.cavities += shell.volume < 0;
    }
    topology.shells = std::move(table.shells);
    topology.gauss_bonnet_residual = table.residual;
    topology.components = component_table(records, included);
    out.euler_characteristic = topology.euler_characteristic;
    out.topology = std::move(topology);
    out.counts.cusps = table.cusps;
    out.checks.uncertified_patches =
        std::max(out.checks.uncertified_patches, table.unmatched_patches);
  }

  std::vector<vdwmesh::AccessibleComponent> component_table(
      const PatchRecords& records, const std::vector<std::uint8_t>& included) const {
    std::vector<WideSum> area(components());
    for (const ContactPiece& c : surface_.contacts) {
      area[c.component].add(radius_[c.ball] * radius_[c.ball] * c.solid_angle);
    }
    const double p = surface_.probe_radius;
    for (const RolledArc& arc : surface_.arcs) {
      if (arc.dropped) continue;
      const Profile profile = profile_of(arc);
      for (std::size_t k = 0; k < 2; ++k) {
        area[surface_.component_of(arc)].add(measure_saddle(arc, p, profile, k).area);
      }
    }
    for (const ConcavePiece& c : records.pieces) {
      area[surface_.probes[c.probe].component].add(p * p * c.solid_angle);
    }
    std::vector<vdwmesh::AccessibleComponent> out;
    for (std::size_t c = 0; c < components(); ++c) {
      if (!included[c]) continue;
      const ComponentMeasures& accessible = surface_.components[c];
      out.push_back({std::ldexp(accessible.area, 2 * exponent_),
                     std::ldexp(accessible.volume, 3 * exponent_), accessible.volume < 0,
                     std::ldexp(area[c].value(), 2 * exponent_)});
    }
    std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) {
      if (a.is_cavity != b.is_cavity) return b.is_cavity;
      return std::abs(a.accessible_volume) > std::abs(b.accessible_volume);
    });
    return out;
  }

  const ExcludedOptions& options_;
  const SphereSet& atoms_;
  std::unique_ptr<const GrownAtoms> grown_;
  std::unique_ptr<const PatchRecords> records_;  // made last
  std::vector<std::uint8_t> outer_;              // components of the exterior surface
  const int exponent_ = grown_->exponent;
  const AccessibleSurface& surface_ = grown_->surface;
  const PowerTriangulation& triangulation_ = grown_->triangulation;
  const std::vector<double>& radius_ = grown_->radius;
};

bool is_certified(const ExcludedMeasures& m) {
  return m.complete.checks.uncertified_patches == 0 &&
         (!m.exterior || m.exterior->checks.uncertified_patches == 0);
}

// Corners some kNoLength apart may be gathered here and not there, so that patches around them do
// not fit each other. Then all corners stay apart, and wide numbers decide between their probes.
ExcludedMeasures measure_certified(const SphereSet& atoms, const ExcludedOptions& options,
                                   KeptSurface* kept) {
  ExcludedSum first(atoms, options, kNoLength);
  ExcludedMeasures gathered = first.run();
  if (!is_certified(gathered)) {
    ExcludedSum second(atoms, options, 0);
    ExcludedMeasures apart = second.run();
    if (is_certified(apart)) {
      if (kept != nullptr) *kept = std::move(second).keep();
      return apart;
    }
  }
  if (kept != nullptr) *kept = std::move(first).keep();
  return gathered;
}

}  // namespace

namespace {

// Shares of the area and of the volume that the checks of a sound surface may miss: the digits
// that a report prints. Rounding leaves some 1e-12 of them.
constexpr double kSound = 1e-6;
// No digit of a volume is right where two formulas differ by more than this share of it.
constexpr double kLost = 0.1;
// More than rounding does to the shares of a surface whose other checks hold.
constexpr double kRounding = 1e-3;
// Of the integral of the curvature over 2 π, which is even.
constexpr double kSoundCurvature = 1e-3;

// How far the sums of the atoms' shares are from the parts of the area and from the volume,
// relative to the whole; 0 without shares.
double missing_share(const ExcludedSurface& s) {
  if (s.per_atom.empty()) return 0;
  WideSum contact, saddle, concave, volume;
  for (const ExcludedAtom& atom : s.per_atom) {
    contact.add(atom.area.contact);
    saddle.add(atom.area.saddle);
    concave.add(atom.area.concave);
    volume.add(atom.volume);
  }
  const ByPatchKind& whole = s.area_by_kind;
  const double area =
      std::max({std::abs(contact.value() - whole.contact), std::abs(saddle.value() - whole.saddle),
                std::abs(concave.value() - whole.concave)});
  return std::max(area / s.area, std::abs(volume.value() / s.volume - 1));
}

}  // namespace

ShellFigures shell_figures(const ExcludedTopology& topology) {
  ShellFigures sum{};
  for (const ExcludedShell& shell : topology.shells) {
    const bool is_wall = shell.volume < 0;
    ++(is_wall ? sum.walls : sum.outer);
    (is_wall ? sum.wall_area : sum.outer_area) += shell.area;
    sum.genus += shell.genus;
  }
  return sum;
}

void check_digits(const ExcludedSurface& surface, double probe) {
  const auto is_positive = [](double value) { return value > 0 && std::isfinite(value); };
  const ExcludedChecks& checks = surface.checks;
  const bool is_lost = checks.uncertified_patches == 0 &&
                       !(std::abs(checks.check_volume / surface.volume - 1) < kLost);
  if (is_positive(surface.area) && is_positive(surface.volume) && !is_lost) return;
  throw InvalidInput(fmt::format(
      "rounding in double leaves nothing of the excluded surface: its area is {:.3g} Å², and its "
      "volume {:.3g} Å³ by one formula and {:.3g} by another: atoms are too small beside a probe "
      "of {:.3g} Å",
      surface.area, surface.volume, checks.check_volume, probe));
}

std::vector<std::string> doubts(const ExcludedSurface& s) {
  std::vector<std::string> lines;
  const auto doubt_if = [&]<class... Values>(bool holds, fmt::format_string<Values...> text,
                                             Values&&... values) {
    if (holds) lines.push_back(fmt::format(text, std::forward<Values>(values)...));
  };
  doubt_if(s.checks.uncertified_patches > 0,
           "{} concave patches of the excluded surface are not certified: area, volume and "
           "topology may be wrong there",
           s.checks.uncertified_patches);
  doubt_if(!(s.checks.closure <= kSound),
           "the excluded surface is not closed by {:.1e} of its area, which may be as wrong: the "
           "probe is too large for these atoms, or rounding decided about one",
           s.checks.closure);
  const double apart = std::abs(s.checks.check_volume / s.volume - 1);
  doubt_if(!(apart <= kSound),
           "the volume of the excluded solid is {:.6g} Å³ by one formula and {:.6g} by another: "
           "the probe is too large for these atoms, or rounding decided about one",
           s.volume, s.checks.check_volume);
  const double residual = s.topology ? s.topology->gauss_bonnet_residual : 0;
  doubt_if(!(residual <= kSoundCurvature),
           "the curvature of a shell is {:.1e} off its Euler characteristic, which may be wrong",
           residual);
  const double missing = missing_share(s);
  doubt_if(!(missing <= kSound), "the shares of atoms in the excluded surface miss {:.1e} of it",
           missing);
  return lines;
}

namespace {

ExcludedMeasures checked_measures(const SphereSet& atoms, const ExcludedOptions& options,
                                  KeptSurface* kept) {
  begin_stage(options.monitor, "excluded surface", 1);
  ExcludedMeasures out = measure_certified(atoms, options, kept);
  advance(options.monitor, 1);
  check_digits(out.complete, options.probe);
  if (out.exterior) check_digits(*out.exterior, options.probe);
  const std::vector<std::string> found = doubts(out.complete);
  if (found.size() == 1 && !(missing_share(out.complete) <= kRounding))
    throw InternalError(found[0]);
  return out;
}

}  // namespace

ExcludedMeasures excluded_measures(const SphereSet& atoms, const ExcludedOptions& options) {
  return checked_measures(atoms, options, nullptr);
}

ExcludedMeasures excluded::measure_and_keep(const SphereSet& atoms, const ExcludedOptions& options,
                                            KeptSurface& kept) {
  ExcludedOptions exterior = options;
  exterior.exterior = true;
  return checked_measures(atoms, exterior, &kept);
}

}  // namespace vdwmesh

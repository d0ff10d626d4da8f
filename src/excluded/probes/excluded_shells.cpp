// excluded_shells(): union-find over the faces of the surface, and sums over each set of faces.
//
// Faces are contact pieces, the two halves of each saddle, and pieces of concave patches. Halves
// are joined with the contact pieces along arcs, with each other unless the saddle is a spindle,
// and with concave pieces along the sides of probes; concave pieces are joined along creases.
//
// χ is the sum of the faces' Euler characteristics, less edges, plus vertices. It is counted in
// sixths, because an edge between two faces counts half for each, and a point of three creases a
// third for each of its corners. A closed edge without a vertex has χ = 0 and counts nothing.
#include "excluded/probes/excluded_shells.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/disjoint_sets.hpp"
#include "core/sum.hpp"
#include "excluded/probes/surface_faces.hpp"

namespace vdwmesh::excluded {
namespace {

constexpr double kPi = std::numbers::pi;

class ShellSum {
 public:
  ShellSum(const AccessibleSurface& surface, const PatchRecords& records,
           std::span<const std::uint8_t> included, std::span<const double> radius)
      : surface_(surface),
        records_(records),
        included_(included),
        radius_(radius),
        numbers_{surface, records, included, surface.contacts.size()},
        faces_(numbers_.end()) {}

  ShellTable run() {
    for (std::uint32_t i = 0; i < surface_.arcs.size(); ++i) {
      const RolledArc& arc = surface_.arcs[i];
      for (std::size_t k = 0; k < 2 && counts(arc); ++k) faces_.join(half(i, k), arc.contact[k]);
    }
    numbers_.join_saddles(faces_);
    table_.unmatched_patches = numbers_.join_creases(faces_);
    std::move(faces_).number_sets(shell_);
    sums_.resize(shell_.size());
    add_contacts();
    add_saddles();
    add_pieces();
    add_creases();
    return summary();
  }

 private:
  struct Sum {
    WideSum area, flux, bend;
    std::int64_t sixths = 0;
    bool used = false;
  };

  bool counts(const RolledArc& arc) const { return surface_.counts(arc, included_); }
  std::uint32_t half(std::size_t arc, std::size_t side) const { return numbers_.half(arc, side); }
  std::uint32_t piece(std::uint32_t i) const { return numbers_.piece(i); }

  Sum& at(std::uint32_t face) {
    Sum& sum = sums_[shell_[face]];
    sum.used = true;
    return sum;
  }

  void add_contacts() {
    for (std::uint32_t i = 0; i < surface_.contacts.size(); ++i) {
      const ContactPiece& c = surface_.contacts[i];
      if (c.point || !included_[c.component]) continue;
      const double r = radius_[c.ball];
      Sum& sum = at(i);
      sum.area.add(r * r * c.solid_angle);
      const Vec3d center = surface_.place(c.ball, records_.home[c.component]);
      sum.flux.add(flux_through(r, center, c.solid_angle, c.vector));
      sum.bend.add(c.solid_angle);
      sum.sixths += 6 * (2 - static_cast<std::int64_t>(c.loops));
    }
  }

  // Counts χ of the halves: -1 for the edge along each contact piece, +1 for a face, which is the
  // whole saddle, or either half of a spindle. A ring's edges are closed and count nothing, and its
  // saddle is an annulus with χ = 0 unless it is a spindle. A cusp bends the surface by 2 π less
  // the angles of the halves that end in it.
  void add_saddles() {
    for (std::uint32_t i = 0; i < surface_.arcs.size(); ++i) {
      const RolledArc& arc = surface_.arcs[i];
      if (!counts(arc)) continue;
      const Profile profile = profile_of(arc);
      const Vec3d middle = surface_.place(arc, records_.home[surface_.component_of(arc)]);
      for (std::size_t k = 0; k < 2; ++k) {
        const SaddleMeasures m = measure_saddle(arc, surface_.probe_radius, profile, k);
        Sum& sum = at(half(i, k));
        sum.area.add(m.area);
        sum.flux.add(m.flux + dot(middle, m.vector) / 3);
        sum.bend.add(m.bend);
        if (!arc.is_ring()) sum.sixths -= 6;
        if (profile.spindle) {
          sum.sixths += 6;
          sum.bend.add(-arc.angle * std::sin(profile.cusp));
          if (is_first_on_circle(i)) add_cusp(sum, arc.is_ring());
        } else if (k == 0 && !arc.is_ring()) {
          sum.sixths += 6;
        }
      }
    }
  }

  // The cusp of a ring lies inside of its face, a disk, and is no vertex.
  void add_cusp(Sum& sum, bool ring) {
    sum.bend.add(2 * kPi);
    ++table_.cusps;
    if (!ring) sum.sixths += 6;
  }

  // Whether this arc has the lowest number of the arcs of its circle that count.
  bool is_first_on_circle(std::uint32_t arc) const {
    for (std::uint32_t i = surface_.arcs[arc].beyond[1]; i != arc; i = surface_.arcs[i].beyond[1]) {
      if (i < arc && counts(surface_.arcs[i])) return false;
    }
    return true;
  }

  void add_pieces() {
    const double p = surface_.probe_radius;
    for (std::uint32_t i = 0; i < records_.pieces.size(); ++i) {
      const ConcavePiece& c = records_.pieces[i];
      Sum& sum = at(piece(i));
      sum.area.add(p * p * c.solid_angle);
      const Probe& probe = surface_.probes[c.probe];
      const Vec3d x = surface_.place(probe, records_.home[probe.component]);
      sum.flux.add(-flux_through(p, x, c.solid_angle, c.vector));
      sum.bend.add(c.bend);
      sum.sixths += 6 * (2 - static_cast<std::int64_t>(c.loops));
    }
    // A side counts for the vertex in which it ends, and for one edge, or for two if cusps cut it.
    for (std::size_t s = 0; s < surface_.sides.size(); ++s) {
      const auto& [near_a, near_b] = records_.side_piece[s];
      if (near_a == kNoIndex || near_b == kNoIndex) continue;
      const RolledArc& arc = surface_.arcs[surface_.sides[s].arc];
      const bool spindle = profile_of(arc).spindle;
      at(piece(surface_.sides[s].end == ArcEnd::end ? near_b : near_a)).sixths += 6;
      at(piece(near_a)).sixths -= 6;
      if (spindle) at(piece(near_b)).sixths -= 6;
    }
  }

  void add_creases() {
    for (const Crease& c : records_.creases) {
      if (c.from == c.to && c.from.name[1] == kNoIndex) continue;  // a whole circle
      Sum& sum = at(piece(c.piece));
      sum.sixths -= 3;
      if (!c.to.is_cusp()) sum.sixths += 2;
    }
  }

  ShellTable summary() {
    for (const Sum& sum : sums_) {
      if (!sum.used) continue;
      const std::int64_t euler = sum.sixths / 6;
      const double residual =
          std::abs(sum.bend.value() / (2 * kPi) - static_cast<double>(sum.sixths) / 6);
      table_.residual = std::max(table_.residual, residual);
      if (sum.sixths % 12 != 0) ++table_.unmatched_patches;
      table_.shells.push_back({sum.area.value(), sum.flux.value(), euler, 1 - euler / 2});
    }
    std::stable_sort(table_.shells.begin(), table_.shells.end(),
                     [](const ExcludedShell& a, const ExcludedShell& b) {
                       if ((a.volume < 0) != (b.volume < 0)) return b.volume < 0;
                       return std::abs(a.volume) > std::abs(b.volume);
                     });
    return std::move(table_);
  }

  const AccessibleSurface& surface_;
  const PatchRecords& records_;
  std::span<const std::uint8_t> included_;
  std::span<const double> radius_;
  SurfaceFaces numbers_;  // behind those of the contact pieces
  DisjointSets faces_;
  Buffer<std::uint32_t> shell_;  // by face
  std::vector<Sum> sums_;        // by shell
  ShellTable table_{};
};

}  // namespace

ShellTable excluded_shells(const AccessibleSurface& surface, const PatchRecords& records,
                           std::span<const std::uint8_t> included, std::span<const double> radius) {
  return ShellSum(surface, records, included, radius).run();
}

}  // namespace vdwmesh::excluded

// The excluded surface as its judge uses it: all patches, and the curves along which they meet at
// an angle. For the library's own use.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "analysis/survey/patch.hpp"
#include "excluded/excluded_measures.hpp"
#include "excluded/patches/concave_patch.hpp"
#include "excluded/probes/grown_atoms.hpp"

namespace vdwmesh::excluded {

// An arc of a circle: of a crease, of the accessible surface, or of radius 0, which is a cusp or
// the place of a probe that cannot roll.
// Lengths in Å.
class CircleArc {
 public:
  // `start` is a unit vector from the centre to the point where the arc begins; `sweep` in rad,
  // counter-clockwise about the axis; 2 π for a whole circle.
  CircleArc(const Vec3d& center, const Vec3d& axis, const Vec3d& start, double radius,
            double sweep);

  Vec3d at(double angle) const;
  double radius() const { return radius_; }
  double sweep() const { return sweep_; }
  bool is_whole() const;
  Box box() const;
  // Å²
  double squared_distance(const Vec3d& point) const;
  Vec3d nearest_point(const Vec3d& point) const;

 private:
  bool faces(const Vec3d& radial) const;

  Vec3d center_, axis_, start_;
  Vec3d middle_, first_, last_;  // unit vector to the middle; the ends
  double radius_, sweep_;
  double least_cosine_;  // of the angle from the middle to points of the arc
};

// Profile angles between which a saddle is one piece: two ranges of a spindle, one otherwise.
struct ProfileAngles {
  double from, to;
};
std::vector<ProfileAngles> profile_ranges(const RolledArc& arc);

struct JudgedSurface {
  // Throws as excluded_measures() does.
  JudgedSurface(const SphereSet& atoms, double probe, ExcludedPart part, Monitor* monitor);

  const GrownAtoms grown;
  const double unit;  // Å for each unit of scaled lengths: a power of two
  // Of each component of the accessible surface, whether its probes make the judged surface.
  const std::vector<std::uint8_t> included;
  std::vector<ConcavePatch> cut;      // of low probes, by probe, ascending
  std::vector<std::uint32_t> cut_of;  // by probe: the place in `cut`; kNoIndex: it is whole
  std::vector<CircleArc> curves;      // creases and cusps
  // On which the included probes roll, and of radius 0 the places of those that atoms hold.
  std::vector<CircleArc> arcs;

  bool includes(const RolledArc& arc) const { return grown.surface.counts(arc, included); }
  bool includes_all() const { return pieces_.empty(); }
  // Whether an exposed point, Å, of the sphere of a grown ball is the centre of an included probe.
  bool includes_point(SphereId sphere, const Vec3d& point) const;
  // Whether it may be one, if the point is exposed, or an exposed point within `reach`, Å.
  bool may_include(SphereId sphere, const Vec3d& point, double reach) const;

  // The sides of the patch of a probe, and the caps that are taken from the probe's sphere; the
  // patch is the rest: the caps are a half-sphere behind each side, and what other probes cover.
  std::vector<PatchSide> sides_of(std::uint32_t probe) const;
  std::vector<Cover> covers_of(std::uint32_t probe) const;
  // The point that the probe touches, at a turn along an arc, at a profile angle. Å
  Vec3d on_saddle(const RolledArc& arc, double turn, double profile) const;

  // A scaled position relative to the origin of the accessible surface, in Å.
  Vec3d in_angstrom(const Vec3d& position) const {
    return unit * (position + grown.surface.origin);
  }

 private:
  // The pieces of a ball's exposed part may belong to different components: then the arcs around
  // them tell the pieces apart.
  enum class Pieces : std::uint8_t { none_included, all_included, some_included };
  struct Border {
    CircleArc arc;
    bool included;
  };
  CircleArc in_place(const RolledArc& arc) const;
  CircleArc place_of(const Probe& held) const;  // of radius 0
  void classify_balls();
  bool has_certified_patch(std::uint32_t probe) const;
  void add_creases(const ConcavePatch& patch);
  void add_cusps(const RolledArc& arc);

  std::vector<Pieces> pieces_;  // by sphere; empty: all components are included
  std::unordered_map<SphereId, std::vector<Border>> borders_;
};

}  // namespace vdwmesh::excluded

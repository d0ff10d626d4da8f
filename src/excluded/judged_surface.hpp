// The excluded surface as its judge uses it: all patches, and the curves along which they meet at
// an angle. For the library's own use.
#pragma once

#include <cstdint>
#include <vector>

#include "excluded/concave_patch.hpp"
#include "excluded/grown_atoms.hpp"

namespace vdwmesh::excluded {

// A crease, which is an arc of a circle, or a cusp, which is a circle of radius 0. Lengths in Å.
struct SharpCurve {
  Vec3d center, axis;
  Vec3d start;    // unit vector from the centre to the point where the arc begins
  double radius;  // 0: a cusp
  double sweep;   // rad, counter-clockwise about the axis; 2 π for a whole circle

  Vec3d at(double angle) const;
  bool is_whole() const;
};

// Å²
double squared_distance(const SharpCurve& curve, const Vec3d& point);
Box box_of(const SharpCurve& curve);

// The complete surface.
struct JudgedSurface {
  // Throws as excluded_measures() does.
  JudgedSurface(const SphereSet& atoms, double probe, Monitor* monitor);

  const GrownAtoms grown;
  const double unit;                  // of scaled lengths, in Å: a power of two
  std::vector<ConcavePatch> cut;      // of low probes, by probe, ascending
  std::vector<std::uint32_t> cut_of;  // by probe: the place in `cut`; kNoIndex: it is whole
  std::vector<SharpCurve> curves;

  // A scaled position relative to the origin of the accessible surface, in Å.
  Vec3d in_angstrom(const Vec3d& position) const {
    return unit * (position + grown.surface.origin);
  }

 private:
  void make_patches(Monitor* monitor);
  bool has_certified_patch(std::uint32_t probe) const;
  void add_creases(const ConcavePatch& patch);
  void add_cusps(const RolledArc& arc);
};

}  // namespace vdwmesh::excluded

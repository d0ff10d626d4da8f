// The curves in which the patches of the excluded surface meet, and their ends, by name. Both
// patches beside a curve know it by the same number, so it has to be sampled only once.
//
// - An arc of the accessible surface gives two contact curves: its circle on either atom.
// - A side of a probe gives the curve between saddle and concave patch; or two of them, to the
//   cusps, if the saddle is a spindle.
// - A saddle that nearly touches its own axis has a waist, with a curve along the arc at either
// end.
// - A whole ring has no sides. Its saddle is cut open along a seam, with the same patch on either
//   side.
// - A crease is the curve between the concave patches of two probes.
//
// Lengths are scaled, and positions relative to AccessibleSurface::origin.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "creases/arcs/boundary_arcs.hpp"
#include "creases/arcs/patch_boundary.hpp"
#include "creases/plane/row_lists.hpp"
#include "excluded/patches/concave_patch.hpp"
#include "excluded/patches/patch_records.hpp"
#include "excluded/probes/grown_atoms.hpp"

namespace vdwmesh::excluded {

// A face that is a sphere less caps: all contact pieces of an atom together, or the concave patch
// of a probe.
struct SphereFace {
  bool concave;
  std::uint32_t element;  // a ball of the triangulation, or a probe
  Sphere sphere;
  std::uint32_t patch;  // in CurveComplex::cut, for a probe that others cut; else kNoIndex
};

// The part of a saddle between two profile angles: the whole saddle, one half of a spindle, or the
// waist of a saddle that nearly or just touches its own axis, or a part beside the waist. No point
// of the mesh lies inside of a waist, so that none lie on top of each other on the axis.
struct SaddlePart {
  double from, to;
  std::uint32_t half = kNoIndex;  // if half a spindle: 0 near ball a, 1 near ball b; else kNoIndex
  bool waist = false;
};

// A part as a face. Curves run from ball a to ball b, or along the arc.
struct SaddleFace {
  std::uint32_t arc;
  SaddlePart part;
  std::array<std::uint32_t, 2> contact;  // along the arc at from and to; kNoIndex: a cusp
  std::array<std::uint32_t, 2> profile;  // curves at start and end of the arc: a ring's seam twice
};

class CurveComplex {
 public:
  // `edge_length` is scaled. Throws LimitExceeded if a concave patch is not certified.
  CurveComplex(const GrownAtoms& grown, std::span<const std::uint8_t> included, double edge_length,
               Monitor* monitor);

  // BoundaryArc::balls are numbers of faces: the sphere faces, then the saddles.
  BoundaryArcs curves;
  std::vector<Vec3d> normals;  // unit, outward, by corner of `curves`
  std::vector<SphereFace> spheres;
  std::vector<SaddleFace> saddles;
  std::vector<ConcavePatch> cut;

  std::uint32_t face_count() const {
    return static_cast<std::uint32_t>(spheres.size() + saddles.size());
  }
  // The curves around a face, and how a sphere face sees them.
  std::span<const std::uint32_t> curves_of(std::uint32_t face) const { return curves_of_[face]; }
  std::vector<RimArc> rims_of(std::uint32_t face) const;
  // The caps that leave a sphere face of its sphere.
  PatchVector<CoveredCap> caps_of(const SphereFace& face) const;
  // The outward normal of the patches at a point of a curve that is not a corner.
  Vec3d normal_on(std::uint32_t curve, const Vec3d& point) const;
  const GrownAtoms& grown() const { return grown_; }

 private:
  enum class Kind : std::uint8_t { contact, waist, side, crease };
  // What a curve is to the face on its right (0) and on its left (1), if that is a sphere: an arc
  // of a circle with this name and this cosine of its angular radius.
  struct Rims {
    Kind kind;
    std::array<std::uint32_t, 2> circle;
    std::array<double, 2> cosine;
  };

  const AccessibleSurface& surface() const { return grown_.surface; }
  bool counts(const RolledArc& arc) const { return surface().counts(arc, included_); }
  Vec3d probe_center(std::uint32_t probe) const { return surface().probes[probe].center; }
  std::uint32_t saddle_face(std::uint32_t index) const {
    return static_cast<std::uint32_t>(spheres.size()) + index;
  }

  void list_faces();
  void place_corners();
  void place_named_corners();
  std::uint32_t contact_corner(std::uint32_t probe, std::uint32_t ball) const;
  std::uint32_t named_corner(const CreaseEnd& end) const;
  std::uint32_t add_corner(const Vec3d& position, const Vec3d& normal);
  std::uint32_t add_curve(const BoundaryArc& curve, const Rims& rims);

  // Where a saddle's part ends: the curve along the arc, and its corners at the arc's ends.
  struct PartEnd {
    std::uint32_t curve;
    std::array<std::uint32_t, 2> corners;
  };
  void add_arc(std::uint32_t arc, double edge_length);
  PartEnd add_waist(std::uint32_t arc, double profile, const std::array<Vec3d, 2>& radial,
                    std::uint32_t saddle);
  std::array<std::uint32_t, 2> ring_corners(const RolledArc& arc, const Vec3d& radial);
  std::uint32_t add_contact(std::uint32_t arc, std::uint32_t k, const Vec3d& radial,
                            std::array<std::uint32_t, 2> ends, std::uint32_t saddle);
  struct ProfileRange {
    double from, to;
    std::array<std::uint32_t, 2> ends;  // corners
  };
  std::uint32_t add_profile(std::uint32_t arc, std::size_t end, const Vec3d& radial,
                            const ProfileRange& range, std::uint32_t saddle);
  void add_creases();
  void add_crease(const ConcavePatch& patch, const PatchSegment& s, const CreaseEnd& from,
                  const CreaseEnd& to);
  [[noreturn]] void refuse(std::uint32_t probe, const std::string& why) const;

  const GrownAtoms& grown_;
  std::span<const std::uint8_t> included_;
  std::vector<std::uint32_t> face_of_ball_, face_of_probe_;  // kNoIndex: there is none
  std::vector<std::uint32_t> first_corner_;  // by probe: those of its sides, where they begin
  std::vector<CreaseEnd> names_;             // ascending: of the corners from first_named_ on
  std::uint32_t first_named_ = 0;
  std::vector<Rims> rims_;  // by curve
  RowLists curves_of_, neighbors_;
};

}  // namespace vdwmesh::excluded

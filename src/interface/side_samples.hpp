// Samples of one side's excluded surface near another side, and which of them that side buries. For
// the library's own use.
//
// Each patch is sampled by itself, in axes that turn with the atoms around it. Spheres of atoms and
// probes are cut into rings, of which the part in the patch is known in closed form, as is its
// buried part; points follow each other there at equal steps of area. Saddles are cut at the turns
// where the probe enters the other side. So the buried areas are nearly exact for few samples.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/monitor.hpp"
#include "excluded/distances/judged_surface.hpp"
#include "interface/covered_angles.hpp"
#include "interface/turning_axes.hpp"
#include "measures/arcs/arc_cap.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

struct PatchSample {
  Vec3d point, normal;  // outward
  double weight;        // Å² that it stands for
  std::uint32_t patch;  // of SideSampler
  bool is_buried;
};

struct SurfacePlace {
  Vec3d point, normal;
};

class SideSampler {
 public:
  // `others` are the grown atoms of the other side. What is farther than `rim` from all that they
  // bury is left out. Lengths in Å. Throws as excluded_measures() does.
  SideSampler(const SphereSet& own, const CellListView& others, const AxesSource& axes,
              double probe, double rim, Monitor* monitor);

  // About `density` samples per Å², at least one on each patch. Those of different numbers are
  // independent of each other.
  std::vector<PatchSample> samples(double density, std::uint64_t seed) const;

  // Points between what is buried and what is not, at distances of kBorderStep.
  static constexpr double kBorderStep = 0.15;  // Å
  const std::vector<Vec3d>& border() const { return border_; }

  // The nearest point of the whole sphere or tube on which a patch lies.
  SurfacePlace nearest_on(std::uint32_t patch, const Vec3d& place) const;
  // Whether a point of that sphere or tube is in the patch, but for rounding.
  bool holds(std::uint32_t patch, const Vec3d& point) const;

 private:
  // A part of the sphere of an atom or of a probe: what none of `covers` covers.
  struct SpherePatch {
    Sphere sphere;
    double outward;  // 1: of an atom; -1: of a probe, whose centre is outside
    TurningAxes axes;
    std::vector<arcs::Cap> covers, others;  // of the other side
    bool all_buried;
  };
  // The inner side of a tube around an arc, which turns from `first` towards `second`.
  struct Saddle {
    Vec3d center, axis, first, second;
    double circle_radius;
    double angle;
    std::vector<excluded::ProfileAngles> profile;
    bool turns_back, falls;  // the order of samples, which follows the axes there
    CoveredAngles buried;
  };
  struct Part;
  struct Placement;

  void add_contact(std::uint32_t ball, std::vector<SpherePatch>& found) const;
  void add_concave(std::uint32_t probe, std::vector<SpherePatch>& found) const;
  void add_saddle(const excluded::RolledArc& arc, std::vector<Saddle>& found) const;
  bool is_near(const Vec3d& place, double reach) const;
  void add_border(const SpherePatch& patch, std::vector<Vec3d>& border) const;
  void add_border(const Saddle& saddle, std::vector<Vec3d>& border) const;
  std::array<std::vector<Part>, 2> parts_of(const SpherePatch& patch,
                                            const std::array<Vec3d, 3>& axes, double density,
                                            double shift) const;
  void sample_sphere(std::uint32_t patch, double density, const Placement& placement,
                     std::vector<PatchSample>& found) const;
  void sample_saddle(std::uint32_t patch, double density, const Placement& placement,
                     std::vector<PatchSample>& found) const;
  Vec3d on_tube(const Saddle& saddle, double turn, double profile) const;

  const SphereSet grown_;
  const excluded::JudgedSurface surface_;
  const CellListView& others_;
  const AxesSource& axes_;
  const double probe_, rim_;
  std::vector<std::vector<std::uint32_t>> neighbors_;  // by ball of the triangulation
  std::vector<SpherePatch> spheres_;
  std::vector<Saddle> saddles_;
  std::vector<Vec3d> border_;
};

}  // namespace vdwmesh

// Samples on the excluded surface: spread evenly over its patches, and on curves and corners. For
// the library's own use.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/exposed_surface.hpp"
#include "analysis/patch.hpp"
#include "analysis/sphere_lattice.hpp"
#include "excluded/judged_surface.hpp"

namespace vdwmesh::excluded {

// The elements are numbered: contact patches, saddles, concave patches, creases and cusps. Each has
// a random stream of its own, so the samples do not depend on the number of threads.
class SurfaceSamples {
 public:
  // `accessible` is the boundary of all grown balls, `density` the points per Å². The probe's
  // radius is in Å.
  SurfaceSamples(const JudgedSurface& surface, const ExposedSurface& accessible, double probe,
                 double density, std::uint64_t seed)
      : surface_(surface),
        contacts_(accessible.patches()),
        sphere_of_(accessible.list().id),
        probe_(probe),
        density_(density),
        seed_(seed) {}

  std::size_t element_count() const;

  // Adds the samples of an element, Å: to `inside` those that count for all statistics, to `border`
  // those for the maximum alone.
  void add(std::size_t element, std::vector<Vec3d>& inside, std::vector<Vec3d>& border) const;

 private:
  void add_contact(const Patch& grown, Random random, std::vector<Vec3d>& inside,
                   std::vector<Vec3d>& border) const;
  void add_saddle(const RolledArc& arc, Random random, std::vector<Vec3d>& inside,
                  std::vector<Vec3d>& border) const;
  void add_concave(std::uint32_t probe, Random random, std::vector<Vec3d>& inside,
                   std::vector<Vec3d>& border) const;
  void add_curve(const CircleArc& curve, std::vector<Vec3d>& border) const;
  Vec3d on_saddle(const RolledArc& arc, double turn, double profile) const;

  const JudgedSurface& surface_;
  std::span<const Patch> contacts_;
  ByListPlace<SphereId> sphere_of_;
  double probe_, density_;
  std::uint64_t seed_;
};

}  // namespace vdwmesh::excluded

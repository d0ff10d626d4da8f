// Samples on the excluded surface: spread evenly over its patches, and on curves and corners. For
// the library's own use.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "analysis/distances/exposed_surface.hpp"
#include "analysis/distances/sphere_lattice.hpp"
#include "analysis/survey/patch.hpp"
#include "excluded/distances/judged_surface.hpp"

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
  // those for the maximum alone. Calls take() where either has kTogether, to take and remove them.
  static constexpr std::size_t kTogether = std::size_t{1} << 14;
  void add(std::size_t element, std::vector<Vec3d>& inside, std::vector<Vec3d>& border,
           const std::function<void()>& take) const;

 private:
  // Points go one after the other into both lists.
  struct Sink {
    std::vector<Vec3d>&inside, &border;
    const std::function<void()>& take;
    void add_inside(const Vec3d& point) const { add(inside, point); }
    void add_border(const Vec3d& point) const { add(border, point); }

   private:
    void add(std::vector<Vec3d>& points, const Vec3d& point) const {
      points.push_back(point);
      if (points.size() >= kTogether) take();
    }
  };
  void add_contact(const Patch& grown, Random random, const Sink& sink) const;
  void add_saddle(const RolledArc& arc, Random random, const Sink& sink) const;
  void add_concave(std::uint32_t probe, Random random, const Sink& sink) const;
  void add_curve(const CircleArc& curve, const Sink& sink) const;

  const JudgedSurface& surface_;
  std::span<const Patch> contacts_;
  ByListPlace<SphereId> sphere_of_;
  double probe_, density_;
  std::uint64_t seed_;
};

}  // namespace vdwmesh::excluded

// Where samples are taken: in strata of the area of a mesh, and on the exact surface inside exposed
// patches, on exposed arcs, and at corners. For host and device.
//
// The points inside a patch are the exposed points of a SphereLattice. The caller makes one Random
// per sphere, with a stream number of that sphere, so the points do not depend on the number of
// threads.
#pragma once

#include <cmath>
#include <cstdint>

#include "analysis/distances/sphere_lattice.hpp"
#include "analysis/survey/patch.hpp"
#include "core/host_device.hpp"

namespace vdwmesh {

// Strata of the area interval [0, area] of a mesh (mesh_area.hpp): `samples` parts of equal length,
// with one random position in each (stratified sampling).
struct AreaStrata {
  double area;            // Å²
  std::uint64_t samples;  // > 0
  std::uint64_t seed;

  // Returns the position of sample i < samples, Å². The random stream of sample i is ~i, which
  // counts downwards from 2^64 - 1. The streams of spheres count upwards from 0, so no stream is
  // used twice.
  VDWMESH_HD double position(std::uint64_t i) const {
    const double within = Random(seed, ~i).next();
    return (static_cast<double>(i) + within) / static_cast<double>(samples) * area;
  }
};

// Makes the lattice on the sphere of a patch, with `density` points per Å² on the whole sphere. The
// number of points is the area times the density, rounded up or down at random: adding a random
// number of [0, 1) before the cut to an integer makes its expected value exact. Small spheres thus
// have their share of the samples.
VDWMESH_HD inline SphereLattice lattice_on(const Patch& patch, double density, Random& random) {
  const double r = patch.ball.radius;
  const auto count = static_cast<std::uint64_t>(2 * kTwoPi * r * r * density + random.next());
  return SphereLattice(count, random);
}

// Calls visit(point), with the point in Å, for the exposed points of a lattice along its walk.
// Points are taken eight at a time, so that the loops over `lane` become vector instructions.
template <class Visit>
inline void sample_patch(const Patch& patch, double density, Random& random, Visit&& visit) {
  constexpr std::uint64_t kTogether = 8;
  const SphereLattice lattice = lattice_on(patch, density, random);
  for (std::uint64_t first = 0; first < lattice.size(); first += kTogether) {
    const std::uint64_t left = lattice.size() - first, count = left < kTogether ? left : kTogether;
    double number[kTogether], x[kTogether], y[kTogether], z[kTogether];
    std::int64_t covered[kTogether]{};
    for (std::uint64_t lane = 0; lane < kTogether; ++lane) {
      number[lane] = static_cast<double>(lattice.at(first + (lane < count ? lane : count - 1)));
    }
    for (std::uint64_t lane = 0; lane < kTogether; ++lane) {
      const Vec3d direction = lattice.point(number[lane]);
      x[lane] = direction.x, y[lane] = direction.y, z[lane] = direction.z;
    }
    for (std::uint32_t i = 0; i < patch.cover_count; ++i) {
      const arcs::Cap& cap = patch.covers[i].cap;
      const double limit = cap.cosine + kExposureTolerance;
      for (std::uint64_t lane = 0; lane < kTogether; ++lane) {
        const double inner = cap.axis.x * x[lane] + cap.axis.y * y[lane] + cap.axis.z * z[lane];
        covered[lane] |= inner > limit ? 1 : 0;
      }
    }
    for (std::uint64_t lane = 0; lane < count; ++lane) {
      if (covered[lane] != 0) continue;
      visit(patch.ball.center + patch.ball.radius * Vec3d{x[lane], y[lane], z[lane]});
    }
  }
}

// Points at even distances on one circle of a patch, `density` points per Å, of which the first is
// at a random angle. Lengths are in units of the sphere's radius.
class CircleSamples {
 public:
  VDWMESH_HD CircleSamples(const Patch& patch, std::uint32_t circle, double density, Random& random)
      : cap_(patch.covers[circle].cap),
        radius_(std::sqrt((1 - cap_.cosine) * (1 + cap_.cosine))),
        frame_(arcs::frame_of(cap_.axis)),
        size_(
            static_cast<std::uint64_t>(std::ceil(kTwoPi * radius_ * patch.ball.radius * density))),
        start_(random.next()) {}
  VDWMESH_HD std::uint64_t size() const { return size_; }
  VDWMESH_HD Vec3d operator[](std::uint64_t k) const {
    const CirclePoint at =
        point_of_circle((static_cast<double>(k) + start_) / static_cast<double>(size_));
    return cap_.cosine * cap_.axis + radius_ * at.cosine * frame_.first +
           radius_ * at.sine * frame_.second;
  }

 private:
  arcs::Cap cap_;
  double radius_;
  arcs::AxisBasis frame_;
  std::uint64_t size_;
  double start_;
};

// Calls visit(point), with the point in Å, for exposed points at even distances on the circles of
// the patch, `density` points per Å, and for its corners. Two spheres share a circle and three
// share a corner; only the sphere with the smallest list place visits the shared points.
template <class Visit>
VDWMESH_HD inline void sample_border(const Patch& patch, double density, Random& random,
                                     Visit&& visit) {
  const double r = patch.ball.radius;
  for (std::uint32_t i = 0; i < patch.circles; ++i) {
    if (patch.covers[i].place < patch.place) continue;
    const CircleSamples circle(patch, i, density, random);
    for (std::uint64_t k = 0; k < circle.size(); ++k) {
      const Vec3d direction = circle[k];
      if (is_exposed(patch, direction, i)) visit(patch.ball.center + r * direction);
    }
  }
  for (std::uint32_t i = 0; i < patch.corner_count; ++i) {
    const SphereCorner& corner = patch.corners[i];
    if (corner.first) visit(patch.ball.center + r * corner.position);
  }
}

}  // namespace vdwmesh

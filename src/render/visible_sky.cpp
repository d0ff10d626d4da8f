// How much of the sky each vertex sees, which is the light that reaches it from all sides (ambient
// occlusion). The sky is a number of directions, evenly spread. Along each axis two depth maps of
// the mesh are made by parallel projection: of what is seen from the one side, and from the other.
// A vertex sees the sky in a direction unless the map has something in front of it. All is computed
// on the CPU from integers that are compared, so the result is the same on every machine and for
// any number of threads.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "core/fixed_blocks.hpp"
#include "render/surface_source.hpp"

namespace vdwmesh {
namespace {

constexpr int kAxes = 96;            // each of them two directions
constexpr int kSide = 512;           // pixels of a map along each side
constexpr int kLift = 2;             // pixels by which a vertex is lifted off its own triangles
constexpr double kDepths = 1 << 24;  // steps of depth across the mesh

using Map = std::vector<std::int32_t>;

// Axes that are spread evenly over half of the sphere (a Fibonacci lattice; R. Swinbank and R. J.
// Purser, Q. J. R. Meteorol. Soc. 132, 2006).
Vec3d axis_of(int i) {
  const double z = (i + 0.5) / kAxes, angle = 2 * std::numbers::pi * i / std::numbers::phi;
  const double across = std::sqrt(1 - z * z);
  return {across * std::cos(angle), across * std::sin(angle), z};
}

// A parallel projection along an axis, to pixels and to steps of depth.
struct Projection {
  Axes axes;       // right, up and along the axis, unit
  Vec3d lowest;    // Å, along the axes
  double pixel;    // Å
  double to_step;  // steps in an Å

  // Pixels to the right and up, and depth in steps.
  Vec3d operator()(const Vec3d& p) const {
    return {(dot(axes[0], p) - lowest.x) / pixel, (dot(axes[1], p) - lowest.y) / pixel,
            (dot(axes[2], p) - lowest.z) * to_step};
  }
};

Projection along(const Vec3d& axis, const SurfaceExtent& extent) {
  const Vec3d beside = std::abs(axis.z) < 0.9 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0};
  const Vec3d across = cross(beside, axis), right = (1 / norm(across)) * across;
  const Axes axes{right, cross(axis, right), axis};
  const std::array<Vec3d, 6> sides{axes[0],        axes[1],        axes[2],
                                   -1.0 * axes[0], -1.0 * axes[1], -1.0 * axes[2]};
  const std::vector<double> reach = extent.support(sides);
  const double width = std::max(reach[0] + reach[3], reach[1] + reach[4]);
  const double pixel = width / (kSide - 2 * kLift - 2);  // room for vertices that are lifted
  const double rim = (kLift + 1) * pixel, depth = std::max(reach[2] + reach[5], pixel) + 2 * rim;
  return {axes, {-reach[3] - rim, -reach[4] - rim, -reach[5] - rim}, pixel, kDepths / depth};
}

// The larger of both values stays, whichever thread comes first.
void raise(std::int32_t& place, std::int32_t value) {
  const std::atomic_ref<std::int32_t> shared(place);
  std::int32_t known = shared.load(std::memory_order_relaxed);
  while (known < value && !shared.compare_exchange_weak(known, value, std::memory_order_relaxed)) {
  }
}

// A linear function over the map, by its value in the middle of pixel (0, 0) and its slopes.
struct Plane {
  double start, right, up;
  double operator()(int x, int y) const { return start + right * x + up * y; }
};

// The share of corner a in a point of the triangle a b c, whose doubled area is `area`.
Plane share_of(const Vec3d& b, const Vec3d& c, double area) {
  const double right = (b.y - c.y) / area, up = (c.x - b.x) / area;
  return {right * (0.5 - b.x) + up * (0.5 - b.y), right, up};
}

// Calls visit(pixel, depth) for the pixels whose centres the projected triangle covers.
template <class Visit>
void visit_pixels(const std::array<Vec3d, 3>& v, const Visit& visit) {
  const double area = (v[1].x - v[0].x) * (v[2].y - v[0].y) - (v[1].y - v[0].y) * (v[2].x - v[0].x);
  if (!(std::abs(area) > 1e-12)) return;
  const Plane a = share_of(v[1], v[2], area), b = share_of(v[2], v[0], area);
  const double to_a = v[0].z - v[2].z, to_b = v[1].z - v[2].z;
  const auto [left, right] = std::minmax({v[0].x, v[1].x, v[2].x});
  const auto [bottom, top] = std::minmax({v[0].y, v[1].y, v[2].y});
  for (int y = static_cast<int>(bottom); y <= static_cast<int>(top); ++y) {
    for (int x = static_cast<int>(left); x <= static_cast<int>(right); ++x) {
      const double of_a = a(x, y), of_b = b(x, y);
      if (of_a < 0 || of_b < 0 || of_a + of_b > 1) continue;
      visit(static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x),
            static_cast<std::int32_t>(v[2].z + of_a * to_a + of_b * to_b));
    }
  }
}

// What is seen along the axis from above, and from below with depths negated.
void draw_maps(const IndexedMesh& mesh, const Projection& project, Map& above, Map& below) {
  std::ranges::fill(above, std::numeric_limits<std::int32_t>::min());
  std::ranges::fill(below, std::numeric_limits<std::int32_t>::min());
  for_each_index(mesh.triangle_count(), [&](std::size_t t) {
    std::array<Vec3d, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = project(mesh.positions[mesh.triangles[t][k]]);
    visit_pixels(corners, [&](std::size_t pixel, std::int32_t depth) {
      raise(above[pixel], depth);
      raise(below[pixel], -depth);
    });
  });
}

// The light of the sky that reaches a vertex, and that without anything in its way.
struct SkyLight {
  float seen = 0, whole = 0;
};

// Adds both directions of an axis to the light of a vertex; its normal decides from which of them
// light can come at all. What lies no more than a pixel in front of it does not count.
void add_light(const Vec3d& point, const Vec3d& normal, const Projection& project, const Map& above,
               const Map& below, SkyLight& light) {
  const double cosine = dot(normal, project.axes[2]);
  const Vec3d p = project(point + (kLift * project.pixel) * normal);
  const std::size_t pixel = static_cast<std::size_t>(p.y) * kSide + static_cast<std::size_t>(p.x);
  const double slack = project.pixel * project.to_step;
  const bool is_free = cosine > 0 ? above[pixel] <= p.z + slack : below[pixel] <= slack - p.z;
  light.whole += static_cast<float>(std::abs(cosine));
  if (is_free) light.seen += static_cast<float>(std::abs(cosine));
}

}  // namespace

std::vector<float> visible_sky(const IndexedMesh& mesh, std::span<const Vec3f> normals,
                               const SurfaceExtent& extent) {
  Map above(std::size_t{kSide} * kSide), below(above.size());
  std::vector<SkyLight> lights(mesh.vertex_count());
  std::vector<std::uint8_t> is_used(mesh.vertex_count(), 0);
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) is_used[v] = 1;
  }
  for (int i = 0; i < kAxes; ++i) {
    const Projection project = along(axis_of(i), extent);
    draw_maps(mesh, project, above, below);
    for_each_index(lights.size(), [&](std::size_t v) {
      if (!is_used[v]) return;
      const Vec3d normal = cast<double>(normals[v]);
      add_light(mesh.positions[v], (1 / norm(normal)) * normal, project, above, below, lights[v]);
    });
  }
  std::vector<float> sky(lights.size());
  std::ranges::transform(lights, sky.begin(), [](const SkyLight& light) {
    return light.whole > 0 ? light.seen / light.whole : 1.0f;
  });
  return sky;
}

}  // namespace vdwmesh

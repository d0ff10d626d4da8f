// From where a surface is seen, and how it fills the picture. Lengths in Å.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/vec3.hpp"

namespace vdwmesh {

// Where a surface lies, as far as framing it needs to know.
class SurfaceExtent {
 public:
  virtual ~SurfaceExtent() = default;
  // For each direction d the largest d·p over the surface's points p (its support function).
  virtual std::vector<double> support(std::span<const Vec3d> directions) const = 0;
  // Middle of its area, Å, and the area's mean of (p - middle)(p - middle)ᵀ, Å²: xx xy xz yy yz zz.
  struct Moments {
    Vec3d middle;
    std::array<double, 6> covariance;
  };
  virtual Moments moments() const = 0;
};

// Three unit vectors at right angles, right-handed.
using Axes = std::array<Vec3d, 3>;

// Principal axes by descending spread. Each points to where the surface reaches farther from its
// middle, or, where that is equal, has its largest component positive; the third completes the
// right-handed set. A surface with the same spread everywhere has the axes of the coordinates.
Axes principal_axes(const SurfaceExtent& surface);

enum class ViewFrame { principal, coordinates };

// From the surface to the viewer, and what is up in the picture, in components along the axes of
// the frame; neither needs unit length, `up` only must not be parallel. The default sees the broad
// side of the surface with its long axis across.
struct View {
  ViewFrame frame = ViewFrame::principal;
  Vec3d toward_viewer{0, 0, 1};
  Vec3d up{0, 1, 0};
};

// The picture's right, up and toward the viewer. Throws InvalidInput where the view's vectors are
// zero, not finite or parallel.
Axes view_axes(const View& view, const SurfaceExtent& surface);

enum class CameraProjection { orthographic, perspective };

// How points become positions in the picture. View coordinates are along `axes` about `origin`.
struct Camera {
  CameraProjection projection = CameraProjection::orthographic;
  Axes axes{};
  Vec3d origin{};          // Å; what vertices are stored relative to, to keep float's digits
  Vec3d eye{};             // view coordinates, Å; orthographic: the middle, its z the near plane's
  double half_width = 1;   // orthographic: Å; perspective: at distance 1 from the eye
  double half_height = 1;  // as half_width
  double nearest = 1;      // distance from eye.z to the near plane, Å
  double farthest = 2;     // and to the far plane
};

inline constexpr double kVerticalFieldOfView = 30;  // degrees, of a perspective picture

// The camera whose picture of width/height `aspect` the surface fills but for a border of `margin`
// of the picture on the tightest pair of sides, and centred on the other: exactly, for both
// projections. Throws InvalidInput for a surface that is a single point.
Camera frame_surface(const SurfaceExtent& surface, const View& view, CameraProjection projection,
                     double aspect, double margin);

// Clip coordinates of OpenGL from a point relative to `origin`, column by column.
std::array<double, 16> clip_matrix(const Camera& camera);

// Position in the picture: x to the right and y up in [-1, 1], z from near (-1) to far (1).
Vec3d project(const Camera& camera, const Vec3d& point);

}  // namespace vdwmesh

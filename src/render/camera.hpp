// From where a surface is seen, and how it fills the picture. Lengths are in Å.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/vec3.hpp"

namespace vdwmesh {

// What framing needs to know of a surface: how far it reaches, and its principal axes.
class SurfaceExtent {
 public:
  virtual ~SurfaceExtent() = default;
  // For each direction d the largest d·p over the surface's points p (its support function).
  virtual std::vector<double> support(std::span<const Vec3d> directions) const = 0;
  // The centroid of the surface's area, and the covariance of its points: the mean over the area of
  // (p - middle)(p - middle)ᵀ.
  struct Moments {
    Vec3d middle;                      // Å
    std::array<double, 6> covariance;  // Å², as xx xy xz yy yz zz
  };
  virtual Moments moments() const = 0;
};

// Three unit vectors at right angles, right-handed.
using Axes = std::array<Vec3d, 3>;

// Returns the principal axes of the surface's area, by descending spread (variance of the area's
// points along the axis). The first two point to the side on which the surface extends farther from
// its middle; if both sides are equal, the component of largest magnitude is positive. The third
// completes the right-handed set. If the spread is the same in all directions, the axes are the
// coordinate axes.
Axes principal_axes(const SurfaceExtent& surface);

// Which axes a view's directions refer to: the surface's principal axes or the coordinate axes.
enum class ViewFrame { principal, coordinates };

// From which side a surface is seen. Both vectors are given by their components along the axes that
// `frame` selects. They may have any length above 0, but must not be parallel. The default shows
// the broad side of the surface, with its longest extent across the picture.
struct View {
  ViewFrame frame = ViewFrame::principal;
  Vec3d toward_viewer{0, 0, 1};
  Vec3d up{0, 1, 0};
};

// Returns three directions in space: to the picture's right side, to its top, and to the viewer.
// Throws InvalidInput if a vector of the view is zero or not finite, or if the two are parallel.
Axes view_axes(const View& view, const SurfaceExtent& surface);

enum class CameraProjection { orthographic, perspective };

// How points of space become positions in the picture. View coordinates are measured along `axes`
// from `origin`; z points toward the viewer.
struct Camera {
  CameraProjection projection = CameraProjection::orthographic;
  Axes axes{};     // right, up, toward the viewer
  Vec3d origin{};  // Å; vertices are stored relative to it, to keep the digits of floats
  // In view coordinates, Å. An orthographic picture has no eye: x and y are then the middle of the
  // picture, and z is where `nearest` and `farthest` are counted from.
  Vec3d eye{};
  double half_width = 1;   // orthographic: Å; perspective: at distance 1 from the eye
  double half_height = 1;  // like half_width
  double nearest = 1;      // from eye.z to the near plane, Å
  double farthest = 2;     // from eye.z to the far plane, Å
};

inline constexpr double kVerticalFieldOfView = 30;  // degrees, of a perspective picture

// Returns the camera whose picture the surface fills. `aspect` is width over height of the picture,
// and `margin` is the empty border on each side, as a share of the picture. The surface touches the
// border either at left and right or at top and bottom, whichever pair it reaches first, and is
// centred between the other two sides. This is exact for both projections, except for a needle
// whose end points at the viewer, which is drawn smaller. Throws InvalidInput for a surface that is
// a single point.
Camera frame_surface(const SurfaceExtent& surface, const View& view, CameraProjection projection,
                     double aspect, double margin);

// The matrix, in column-major order, that takes a point relative to `origin` to OpenGL's clip
// coordinates.
std::array<double, 16> clip_matrix(const Camera& camera);

// Position of a point of space in the picture: x to the right and y up, in [-1, 1] inside the
// picture; z from the near plane (-1) to the far plane (1).
Vec3d project(const Camera& camera, const Vec3d& point);

}  // namespace vdwmesh

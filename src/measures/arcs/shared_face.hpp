// What a ball shares with a neighbour: the face of its power cell towards it, as far as it lies in
// the ball, and the exposed part of the circle in which their spheres meet.
//
// All derivatives of measures are sums over these faces: the measures of a ball change as the plane
// of a face moves and its circle with it.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>

#include "core/vec3.hpp"
#include "measures/arcs/face_rates.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Lengths in Å, from the centre of the ball or that of the circle.
struct SharedFace {
  SphereId other;
  double other_radius;
  Vec3d axis;               // unit, from the ball's centre to the other one
  arcs::SharedPlane plane;  // in which the face lies
  double angle;             // exposed, of the circle
  Vec3d arc;                // integral over the exposed angle of the arm to the circle
  double area;              // of the face
  Vec3d moment;             // integral over the face of the place from circle's centre
};

// The same face, seen from the other ball.
inline SharedFace seen_from_other(const SharedFace& face, SphereId ball, double radius) {
  SharedFace turned = face;
  turned.other = ball;
  turned.other_radius = radius;
  turned.axis = -1.0 * face.axis;
  std::swap(turned.plane.height, turned.plane.other_height);
  return turned;
}

// What is told of balls by those who find their faces, on several threads at a time.
struct FaceVisitor {
  // Called once for each ball with its exposed area, Å². Balls without any volume of their own are
  // left out.
  std::function<void(SphereId, const Sphere&, double area, std::span<const SharedFace>)> visit;
  // Balls that may have no derivative (UnionGradients::kink_spheres).
  std::atomic<std::uint64_t> kinks = 0;
};

}  // namespace vdwmesh

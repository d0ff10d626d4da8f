// The vertex of a mesh at a corner or at a sample point of an arc, for host and device.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "creases/arcs/boundary_arcs.hpp"
#include "surface/vertex_labels.hpp"

namespace vdwmesh {

struct BoundaryVertex {
  Vec3d position;  // Å
  Vec3f normal;
  VertexSpheres label;  // ascending
};

// The balls of a set: PlacedBalls::balls, their ids, and Å for each unit of their lengths, a power
// of two, with which a product is exact.
struct BallsView {
  const Sphere* balls;
  const SphereId* ids;
  double unit;
};

// At p, which lies on the spheres of up to three balls; unused entries of `balls` are kNoIndex. The
// normal is the mean of the spheres' normals. If these cancel, as at a point of contact, the normal
// of the first sphere is taken: a sum shorter than 1e-6 would have no reliable direction.
VDWMESH_HD inline BoundaryVertex boundary_vertex(const Vec3d& p,
                                                 const std::array<std::uint32_t, 3>& balls,
                                                 const BallsView& of) {
  Vec3d sum{0, 0, 0}, first{0, 0, 0};
  SphereId label[3] = {kNoSphere, kNoSphere, kNoSphere};
  for (int k = 0; k < 3 && balls[k] != kNoIndex; ++k) {
    const Vec3d out = p - of.balls[balls[k]].center;
    sum = sum + (1 / norm(out)) * out;
    if (k == 0) first = sum;
    label[k] = of.ids[balls[k]];
  }
  const auto order = [&label](int a, int b) {
    const SphereId lower = label[a] < label[b] ? label[a] : label[b];
    label[b] = label[a] < label[b] ? label[b] : label[a];
    label[a] = lower;
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  if (!(squared_norm(sum) > 1e-12)) sum = first;
  return {of.unit * p, cast<float>((1 / norm(sum)) * sum), {label[0], label[1], label[2]}};
}

}  // namespace vdwmesh

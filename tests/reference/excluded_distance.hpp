// The signed distance of a point to the solvent-excluded surface, between bounds: a slow oracle
// that follows from the definition alone and knows no patch, crease or cusp.
//
// AccessibleDistance says of any place how far it is from the nearest accessible one; the solid is
// where that is at least the probe's radius, and it changes by no more than the place moves. So a
// cube whose middle is short of the radius by more than half its diagonal holds no point of the
// solid, and one whose middle exceeds it by as much holds nothing else. Cubes around the point are
// divided, those nearest to it first, until what is left of them cannot be nearer than some place
// on the other side of the surface that was met.
#pragma once

#include <vector>

#include "reference/accessible_distance.hpp"

namespace vdwmesh::reference {

struct DistanceBounds {
  double lower, upper;  // Å: positive outside the solid, negative inside
};

class ExcludedDistance {
 public:
  // Preconditions: those of AccessibleDistance; the probe, Å, is above 0.
  ExcludedDistance(const std::vector<Ball>& atoms, double probe);

  // Bounds that are `width` (Å) apart, or a little less.
  DistanceBounds bounds(const Point& at, double width) const;

  bool is_in_solid(const Point& at) const { return accessible_.nearest(at).distance >= probe_; }

 private:
  struct Cube;
  class Search;

  std::vector<Ball> atoms_;
  double probe_;
  AccessibleDistance accessible_;
};

}  // namespace vdwmesh::reference

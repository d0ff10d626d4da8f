// How far a point is from every place where the centre of a probe ball can be: the definition of
// the solvent-excluded surface as a function of a point.
//
// The solid is what no open probe ball reaches whose centre is outside the balls grown by the
// probe, or on their boundary. So a point belongs to it if it is at least a probe radius away from
// the closure of the grown balls' complement. The nearest point of that boundary is on one sphere,
// on the circle of two, or an end of an arc of such a circle; all of them are tried, without a
// triangulation and without any patch of the excluded surface.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "reference/point.hpp"

namespace vdwmesh::reference {

// What the nearest accessible point lies on, and so which part of the surface faces it: the inside
// of a sphere's exposed part (contact), of an arc (saddle), or a corner (concave).
enum class NearestOn { sphere, arc, corner, nothing };

struct NearestAccess {
  double distance;  // Å; 0 outside the grown balls, where `on` is `nothing`
  Point point;      // the nearest point of the grown balls' boundary
  NearestOn on;
};

class AccessibleDistance {
 public:
  // What may matter within some box: indices of balls, and of arcs.
  struct Candidates {
    std::vector<std::uint32_t> covering, spheres, arcs;
  };

  // Preconditions: there is an atom; radii are above 0, and the probe, Å, is not below 0.
  AccessibleDistance(const std::vector<Ball>& atoms, double probe);

  // The atoms grown by the probe, without those that lie inside others.
  const std::vector<Ball>& grown_balls() const { return balls_; }
  // Whose they are: places in the list of atoms.
  const std::vector<std::uint32_t>& atoms() const { return atoms_; }

  // Indices of the grown balls that a probe at an accessible place touches.
  std::vector<std::uint32_t> touched(const Point& place, const Candidates& among) const;

  // The distance changes by no more than the point moves.
  NearestAccess nearest(const Point& at) const { return nearest(at, all_); }

  // The same for a point for which the candidates were narrowed. If no accessible point is nearer
  // than `far`, the answer is `far` and `nothing`, which takes less time to find.
  NearestAccess nearest(const Point& at, const Candidates& among,
                        double far = std::numeric_limits<double>::infinity()) const;

  const Candidates& all() const { return all_; }

  // Leaves in `kept` what can matter for points at most `reach` from `middle`, and returns the
  // distance of `middle` itself. `among` must hold for these points already.
  double narrow(const Candidates& among, const Point& middle, double reach, Candidates& kept) const;

 private:
  // An exposed part of the circle of two spheres. The angle runs both ways from `to_middle`.
  struct Arc {
    Point center, axis, to_middle;
    double radius, cosine_of_half;  // the latter is -2 for a whole circle
    Point begin, end;
  };
  struct Circle;
  using Ids = std::vector<std::uint32_t>;

  static Circle circle_of(const Ball& a, const Ball& b);
  void add_arcs_of(std::uint32_t ball);
  void add_arcs(const Circle& circle, const Ids& covering);
  void add_arc(const Circle& circle, double begin, double end);
  static NearestAccess nearest_on(const Arc& arc, const Point& at);
  static bool is_circle_nearer(const Arc& arc, const Point& at, double far);
  bool is_covered(const Point& at, const Ids& covering) const;

  std::vector<Ball> balls_;
  std::vector<std::uint32_t> atoms_;
  std::vector<Arc> arcs_;
  Candidates all_;
};

}  // namespace vdwmesh::reference

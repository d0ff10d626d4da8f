// The pieces of a grown solid: areas and volumes by Gauss–Legendre quadrature over one angle each.
#include "reference/excluded_forms.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

namespace vdwmesh::reference {
namespace {

using std::size_t;

constexpr double kPi = std::numbers::pi;

Point unit(const Point& p) { return (1 / length(p)) * p; }

// Of the tripod of three directions of any length, by Van Oosterom and Strackee 1983.
double solid_angle(const Point& a, const Point& b, const Point& c) {
  const Point u = unit(a), v = unit(b), w = unit(c);
  return std::abs(2 *
                  std::atan2(inner(u, outer(v, w)), 1 + inner(u, v) + inner(v, w) + inner(w, u)));
}

struct Node {
  double at, weight;
};

// Nodes of Gauss–Legendre quadrature on [-1, 1]: roots of a Legendre polynomial by Newton's method.
std::vector<Node> legendre_nodes(int order) {
  std::vector<Node> nodes;
  for (int k = 0; k < order; ++k) {
    double x = std::cos(kPi * (k + 0.75) / (order + 0.5)), slope = 0;
    for (int step = 0; step < 10; ++step) {
      double before = 1, value = x;
      for (int n = 2; n <= order; ++n) {
        before = std::exchange(value, ((2 * n - 1) * x * value - (n - 1) * before) / n);
      }
      slope = order * (x * value - before) / (x * x - 1);
      x -= value / slope;
    }
    nodes.push_back({x, 2 / ((1 - x * x) * slope * slope)});
  }
  return nodes;
}

// The integrands below are analytic in a strip wider than a panel, so the error is rounding.
double integral(double from, double to, const std::function<double(double)>& f) {
  constexpr int kOrder = 40, kPanels = 8;
  static const std::vector<Node> nodes = legendre_nodes(kOrder);
  const double half = (to - from) / (2 * kPanels);
  double sum = 0;
  for (int panel = 0; panel < kPanels; ++panel) {
    const double middle = from + (2 * panel + 1) * half;
    for (const Node& node : nodes) sum += half * node.weight * f(middle + half * node.at);
  }
  return sum;
}

// The same for a function with kinks at ± `kink`.
double integral(double from, double to, double kink, const std::function<double(double)>& f) {
  if (to < from) return -integral(to, from, kink, f);
  std::vector<double> ends{from, to};
  for (const double place : {-kink, kink}) {
    if (place > from && place < to) ends.push_back(place);
  }
  std::sort(ends.begin(), ends.end());
  double sum = 0;
  for (size_t k = 0; k + 1 < ends.size(); ++k) sum += integral(ends[k], ends[k + 1], f);
  return sum;
}

// The circle on which the probe's centre rolls around two atoms.
struct Rolling {
  Point center, axis;
  double radius;            // Å; NaN if the grown balls do not meet
  double to_a, to_b;        // Å along the axis, from the circle's plane
  double grown_a, grown_b;  // Å
};

Rolling rolling(const Ball& a, const Ball& b, double probe) {
  const double d = distance(a.center, b.center), ra = a.radius + probe, rb = b.radius + probe;
  const double along = (d * d + ra * ra - rb * rb) / (2 * d);
  const Point axis = unit(b.center - a.center);
  return {
      a.center + along * axis, axis, std::sqrt(ra * ra - along * along), -along, d - along, ra, rb};
}

// What the triangle of a, b and a probe takes of the directions at a, for each radian of turn.
double directions_at_a(const Rolling& r) { return 1 + r.to_a / r.grown_a; }
double directions_at_b(const Rolling& r) { return 1 - r.to_b / r.grown_b; }

// How far the probe turns about the axis from one place to another, past the side `outward`.
double turn_between(const Rolling& r, const Point& from, const Point& to, const Point& outward) {
  const Point zero = unit(outward - inner(outward, r.axis) * r.axis), quarter = outer(r.axis, zero);
  const auto angle = [&](const Point& p) {
    return std::atan2(inner(p - r.center, quarter), inner(p - r.center, zero));
  };
  return std::abs(angle(from) - angle(to));
}

// Centre of a probe that touches three atoms, on the side from which they run counter-clockwise.
Point touching_probe(const std::array<Ball, 3>& atoms, double probe) {
  const Rolling r = rolling(atoms[0], atoms[1], probe);
  const Point third = atoms[2].center - r.center;
  const Point beside = unit(third - inner(third, r.axis) * r.axis), up = outer(r.axis, beside);
  const double y = inner(third, beside), grown = atoms[2].radius + probe;
  const double toward = (r.radius * r.radius + inner(third, third) - grown * grown) / (2 * y);
  return r.center + toward * beside + std::sqrt(r.radius * r.radius - toward * toward) * up;
}

}  // namespace

void add_cone(double solid_angle, double r, ExcludedForm& sum) {
  sum.contact += solid_angle * r * r;
  sum.volume += solid_angle * r * r * r / 3;
}

namespace {

// The part of a turned triangle between the circle's plane and an atom, by the atom's place along
// the axis. At the angle α from the plane, the excluded solid begins at the distance p from the
// probe's centre, and the axis ends the triangle at ρ / cos α.
void add_half_triangle(double turn, double rho, double to_atom, double p, ExcludedForm& sum) {
  const double kink = p > rho ? std::acos(rho / p) : 0, end = std::atan2(to_atom, rho);
  const auto ring = [&](double alpha) { return std::max(0.0, rho - p * std::cos(alpha)); };
  const auto layer = [&](double alpha) {
    const double cosine = std::cos(alpha), depth = std::min(p, rho / cosine);
    return rho * depth * depth / 2 - cosine * depth * depth * depth / 3;
  };
  sum.saddle += turn * p * integral(0, end, kink, ring);
  sum.volume += turn * (to_atom * rho * rho / 6 - integral(0, end, kink, layer));
}

}  // namespace

void add_turned_triangle(double turn, const Ball& a, const Ball& b, double p, ExcludedForm& sum) {
  const Rolling r = rolling(a, b, p);
  add_half_triangle(turn, r.radius, r.to_b, p, sum);
  add_half_triangle(-turn, r.radius, r.to_a, p, sum);
}

namespace {

// Of a pyramid, the part over the triangle of the probe's foot and an edge of the polygon. With the
// distance s from the foot, the solid angle of a ring sector is h s ds dφ / (h² + s²)^(3/2).
struct PyramidPart {
  double height, probe, rim;  // Å; the rim is where the probe's sphere meets the plane, 0 if not

  double directions(double reach) const {  // for each radian
    return from(0, reach);
  }
  double concave(double reach) const { return reach < rim ? 0 : probe * probe * from(rim, reach); }
  double layer(double reach) const {
    const double flat = std::min(reach, rim);
    const double round = reach < rim ? 0 : probe * probe * probe / 3 * from(rim, reach);
    return height * flat * flat / 6 + round;
  }

 private:
  double from(double near, double far) const {
    return height / std::hypot(height, near) - height / std::hypot(height, far);
  }
};

}  // namespace

void add_pyramid(const Point& center, const std::vector<Point>& polygon, double probe,
                 MirrorProbe mirror, ExcludedForm& sum) {
  const Point up = unit(outer(polygon[1] - polygon[0], polygon[2] - polygon[1]));
  const double side = inner(center - polygon[0], up), height = std::abs(side);
  const Point foot = center - side * up;
  const bool cut = mirror == MirrorProbe::yes && height < probe;
  const PyramidPart part{height, probe, cut ? std::sqrt(probe * probe - height * height) : 0};
  for (size_t k = 0; k < polygon.size(); ++k) {
    const Point from = polygon[k] - foot, to = polygon[(k + 1) % polygon.size()] - foot;
    const Point along = unit(to - from);
    const double off = inner(outer(from, along), up);  // Å; below 0 if the foot is outside the edge
    const double reach = std::abs(off), sign = off < 0 ? -1 : 1;
    const double begin = std::atan2(inner(from, along), reach),
                 end = std::atan2(inner(to, along), reach);
    const double kink = part.rim > reach ? std::acos(reach / part.rim) : 0;
    const auto over = [&](double (PyramidPart::*value)(double) const) {
      return sign * integral(begin, end, kink,
                             [&](double angle) { return (part.*value)(reach / std::cos(angle)); });
    };
    sum.concave += over(&PyramidPart::concave);
    sum.volume += sign * height * reach * length(to - from) / 6 - over(&PyramidPart::layer);
  }
}

ExcludedForm excluded_two_balls(const Ball& a, const Ball& b, double probe) {
  ExcludedForm sum;
  const Rolling r = rolling(a, b, probe);
  const bool rolls = r.radius > 0;
  const double turn = rolls ? 2 * kPi : 0;
  add_cone(4 * kPi - turn * directions_at_a(r), a.radius, sum);
  add_cone(4 * kPi - turn * directions_at_b(r), b.radius, sum);
  if (rolls) add_turned_triangle(turn, a, b, probe, sum);
  return sum;
}

ExcludedForm share_of_first(const Ball& a, const Ball& b, double probe) {
  ExcludedForm sum;
  const Rolling r = rolling(a, b, probe);
  add_cone(4 * kPi - 2 * kPi * directions_at_a(r), a.radius, sum);
  add_half_triangle(2 * kPi, r.radius, -r.to_a, probe, sum);
  return sum;
}

ExcludedForm excluded_three_balls(const std::array<Ball, 3>& atoms, double probe) {
  ExcludedForm sum;
  const Point above = touching_probe(atoms, probe),
              below = touching_probe({atoms[1], atoms[0], atoms[2]}, probe);
  std::array<double, 3> directions{4 * kPi, 4 * kPi, 4 * kPi};
  std::vector<Point> corners;
  for (size_t k = 0; k < 3; ++k) {
    const Ball &a = atoms[k], &b = atoms[(k + 1) % 3], &third = atoms[(k + 2) % 3];
    const Rolling r = rolling(a, b, probe);
    const double turn = turn_between(r, above, below, r.center - third.center);
    add_turned_triangle(turn, a, b, probe, sum);
    directions[k] -=
        turn * directions_at_a(r) +
        2 * solid_angle(b.center - a.center, third.center - a.center, above - a.center);
    directions[(k + 1) % 3] -= turn * directions_at_b(r);
    corners.push_back(a.center);
  }
  for (size_t k = 0; k < 3; ++k) add_cone(directions[k], atoms[k].radius, sum);
  for (const Point& center : {above, below}) {
    add_pyramid(center, corners, probe, MirrorProbe::yes, sum);
  }
  return sum;
}

namespace {

// The pieces on one side of a cage's faces, and the directions that they leave to each atom.
class CageLayer {
 public:
  CageLayer(const Cage& cage, double atom_radius, double probe, MirrorProbe mirror)
      : cage_(cage), radius_(atom_radius), probe_(probe), mirror_(mirror) {
    middle_ = Point{{0, 0, 0}};
    for (const Point& c : cage.centers) {
      middle_ = middle_ + (1.0 / static_cast<double>(cage.centers.size())) * c;
    }
  }

  // `side` is 1 outside and -1 inside.
  void add(double side, std::vector<double>& directions, ExcludedForm& sum) const {
    std::map<std::pair<size_t, size_t>, Point> probes;  // by the edge, as a face has it
    for (const auto& face : cage_.faces) {
      const Point center = probe_over(face, side);
      std::vector<Point> corners;
      for (size_t k = 0; k < face.size(); ++k) {
        const size_t i = face[k], next = face[(k + 1) % face.size()],
                     before = face[(k + face.size() - 1) % face.size()];
        probes[{i, next}] = center;
        corners.push_back(cage_.centers[i]);
        directions[i] -= solid_angle(from(i, cage_.centers[next]), from(i, cage_.centers[before]),
                                     from(i, center));
      }
      add_pyramid(center, corners, probe_, mirror_, sum);
    }
    for (const auto& [edge, center] : probes) {
      const auto [i, j] = edge;
      if (i < j) add_edge(i, j, center, probes.at({j, i}), side, directions, sum);
    }
  }

  // What the polyhedron itself takes of each atom's directions, and its volume.
  void add_core(std::vector<double>& directions, ExcludedForm& sum) const {
    for (const auto& face : cage_.faces) {
      for (size_t k = 0; k < face.size(); ++k) {
        const size_t i = face[k], next = face[(k + 1) % face.size()],
                     before = face[(k + face.size() - 1) % face.size()];
        const Point a = from(i, cage_.centers[next]), b = from(i, cage_.centers[before]);
        directions[i] -= solid_angle(a, b, from(i, middle_));
        const Point first = cage_.centers[face[0]];
        sum.volume += std::abs(inner(middle_ - first, outer(cage_.centers[i] - first,
                                                            cage_.centers[next] - first))) /
                      6;
      }
    }
  }

 private:
  Point from(size_t i, const Point& p) const { return p - cage_.centers[i]; }
  Ball atom(size_t i) const { return {cage_.centers[i], radius_}; }

  Point probe_over(const std::vector<size_t>& face, double side) const {
    const std::array<Ball, 3> corners =
        side > 0 ? std::array<Ball, 3>{atom(face[0]), atom(face[1]), atom(face[2])}
                 : std::array<Ball, 3>{atom(face[1]), atom(face[0]), atom(face[2])};
    return touching_probe(corners, probe_);
  }

  void add_edge(size_t i, size_t j, const Point& p, const Point& q, double side,
                std::vector<double>& directions, ExcludedForm& sum) const {
    const Rolling r = rolling(atom(i), atom(j), probe_);
    const double turn = turn_between(r, p, q, side * (r.center - middle_));
    add_turned_triangle(turn, atom(i), atom(j), probe_, sum);
    directions[i] -= turn * directions_at_a(r);
    directions[j] -= turn * directions_at_b(r);
  }

  const Cage& cage_;
  double radius_, probe_;
  MirrorProbe mirror_;
  Point middle_;
};

}  // namespace

ExcludedForm excluded_cage(const Cage& cage, double atom_radius, double probe, CageSides sides) {
  ExcludedForm sum;
  const bool flat = cage.faces.size() == 2, both = sides == CageSides::both;
  const CageLayer layer(cage, atom_radius, probe,
                        flat || both ? MirrorProbe::yes : MirrorProbe::no);
  std::vector<double> directions(cage.centers.size(), 4 * kPi);
  layer.add(1, directions, sum);
  if (both) layer.add(-1, directions, sum);
  if (!both && !flat) layer.add_core(directions, sum);
  for (const double solid_angle : directions) add_cone(solid_angle, atom_radius, sum);
  return sum;
}

}  // namespace vdwmesh::reference

// AccessibleSurface: arcs, probes, pieces and components of the boundary of the grown balls.
//
// 1. Each exposed arc gets its shape. Points in which balls touch are no arcs and are left out.
// 2. Corners at the ends of arcs without length are gathered into one probe (union-find).
// 3. A loop of a ball's exposed part is a cycle of arcs, joined at corners (union-find). Loops
//    bound the same piece if a way through cells outside the complex, all around the ball, leads
//    from one to the other.
// 4. The Euler characteristic of a piece with n loops is 2 - n. Gauss–Bonnet gives its solid angle,
//    ω = 2 π (2 - n) + Σ φ cos β - Σ ε, with the angles φ of arcs, the angular radii β of their
//    circles and the turning angles ε. The integral of its normal is ½ ∮ w × dw.
#include "excluded/probes/accessible_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "core/disjoint_sets.hpp"
#include "core/fixed_blocks.hpp"
#include "core/monitor.hpp"
#include "core/sum.hpp"
#include "excluded/probes/short_arcs.hpp"
#include "excluded/probes/wide_probes.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh::excluded {
namespace {

// For each cell of the triangulation whether it is in the outer region: a way through facets
// outside the complex leads from it to a cell with an auxiliary point.
std::vector<std::uint8_t> outer_cells(const PowerTriangulation& t, const DualComplex& complex) {
  std::vector<std::uint8_t> outer(t.cells.size(), 0);
  std::vector<std::uint32_t> open;
  for (std::uint32_t c = 0; c < t.cells.size(); ++c) {
    const auto& v = t.cells[c];
    if (std::all_of(v.begin(), v.end(), [&](std::uint32_t i) { return t.is_ball(i); })) continue;
    outer[c] = 1;
    open.push_back(c);
  }
  while (!open.empty()) {
    const std::uint32_t c = open.back();
    open.pop_back();
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t n = t.neighbors[c][k];
      if (n == kNoIndex || outer[n] || complex.cell_triangles[c][k] != kNoIndex) continue;
      outer[n] = 1;
      open.push_back(n);
    }
  }
  return outer;
}

std::size_t side_of(const RolledArc& arc, std::uint32_t ball) {
  return arc.ball[0] == ball ? 0 : 1;
}

// A whole sphere, before loops are cut from it.
ContactPiece uncut_piece(std::uint32_t ball) {
  ContactPiece piece{};
  piece.ball = ball;
  piece.solid_angle = 4 * std::numbers::pi;
  return piece;
}

// The middle of the box around the centres.
Vec3d middle_of(const std::vector<Sphere>& balls) {
  Vec3d lower = balls[0].center, upper = lower;
  for (const Sphere& b : balls) {
    for (int k = 0; k < 3; ++k) {
      lower[k] = std::min(lower[k], b.center[k]);
      upper[k] = std::max(upper[k], b.center[k]);
    }
  }
  return 0.5 * (lower + upper);
}

// Finds a cell at the edge of each ring that is asked for. Arcs with corners know such cells from
// the triangles of the corners; a ring has none.
class RingCells {
 public:
  RingCells(const PowerTriangulation& t, const std::vector<std::array<std::uint32_t, 2>>& rings) {
    if (rings.empty()) return;
    for (const auto& pair : rings) cell_.emplace(key(pair[0], pair[1]), kNoIndex);
    for (std::uint32_t c = 0; c < t.cells.size(); ++c) {
      const auto& v = t.cells[c];
      for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = i + 1; j < 4; ++j) {
          const auto found = cell_.find(key(v[i], v[j]));
          if (found != cell_.end()) found->second = c;
        }
      }
    }
  }
  std::uint32_t of(const std::array<std::uint32_t, 2>& pair) const {
    return cell_.at(key(pair[0], pair[1]));
  }

 private:
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    return (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
  }
  std::unordered_map<std::uint64_t, std::uint32_t> cell_;
};

// The cells around a ball that can be reached from the cell `start` through the ball's facets that
// are outside the complex. They lie over one piece of its exposed part.
std::unordered_set<std::uint32_t> cells_of_piece(const PowerTriangulation& t,
                                                 const DualComplex& complex, std::uint32_t ball,
                                                 std::uint32_t start) {
  std::unordered_set<std::uint32_t> seen{start};
  std::vector<std::uint32_t> open{start};
  while (!open.empty()) {
    const std::uint32_t c = open.back();
    open.pop_back();
    for (std::size_t k = 0; k < 4; ++k) {
      if (t.cells[c][k] == ball || complex.cell_triangles[c][k] != kNoIndex) continue;
      const std::uint32_t n = t.neighbors[c][k];
      if (n != kNoIndex && seen.insert(n).second) open.push_back(n);
    }
  }
  return seen;
}

}  // namespace

// A boundary loop of the exposed part of a ball.
struct ContactLoop {
  std::uint32_t ball;
  std::uint32_t element;  // its first arc: 2 × arc + side
  bool real;              // has an arc that is not dropped
};

// All loops, and for each ball that has several the list of them, ascending.
struct ContactLoops {
  explicit ContactLoops(std::uint32_t count) : loops(count, ContactLoop{kNoIndex, 0, false}) {}

  // Adds an element to a loop. Elements come in ascending order.
  void add(std::uint32_t loop, const ContactLoop& element) {
    loops[loop].real = loops[loop].real || element.real;
    if (loops[loop].ball != kNoIndex) return;
    const bool real = loops[loop].real;
    loops[loop] = element;
    loops[loop].real = real;
    const auto [first, is_first] = first_of_ball.emplace(element.ball, loop);
    if (is_first) return;
    std::vector<std::uint32_t>& list = several[element.ball];
    if (list.empty()) list.push_back(first->second);
    list.push_back(loop);
  }

  std::vector<ContactLoop> loops;
  std::unordered_map<std::uint32_t, std::uint32_t> first_of_ball;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> several;
};

AccessibleSurface::AccessibleSurface(const PowerTriangulation& triangulation,
                                     const DualComplex& complex, const BoundaryShapes& shapes,
                                     double probe_radius_in, double no_length, Monitor* monitor)
    : probe_radius(probe_radius_in),
      origin(middle_of(triangulation.balls)),
      triangulation_(triangulation),
      complex_(complex),
      shapes_(shapes) {
  place_arcs(no_length);
  advance(monitor, 0);
  gather_corners();
  list_sides();
  link_circles();
  find_pieces();
  advance(monitor, 0);
  measure_pieces();
  find_components();
}

std::uint32_t& AccessibleSurface::arc_at(CornerIndex corner, std::uint32_t edge) {
  const auto& edges = triangle_of(corner).edges;
  const auto slot = std::find(edges.begin(), edges.end(), edge) - edges.begin();
  return arc_at_[corner][static_cast<std::size_t>(slot)];
}

void AccessibleSurface::place_arcs(double no_length) {
  for (const ExposedArc& arc : exposed_arcs(triangulation_, complex_)) {
    const DualEdge& e = complex_.edges[arc.edge];
    if (!(e.singular && e.contact == Contact::touching)) exposed_.push_back(arc);
  }
  arcs.resize(exposed_.size());
  arc_at_.assign(2 * complex_.triangles.size(), {kNoIndex, kNoIndex, kNoIndex});
  for_each_index(arcs.size(), [&](std::size_t i) {
    const ExposedArc& in = exposed_[i];
    const auto& ball = complex_.edges[in.edge].vertices;
    const EdgeShape& shape = shapes_.edge(in.edge);
    RolledArc& out = arcs[i];
    out = {};
    out.edge = in.edge;
    out.ball = ball;
    out.probe = {kNoIndex, kNoIndex};
    out.beyond = {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i)};
    out.angle = shapes_.angle(in);
    out.circle_radius = std::sqrt(shape.squared_circle_radius);
    out.height = shape.height;
    const Sphere &a = triangulation_.balls[ball[0]], &b = triangulation_.balls[ball[1]];
    out.spindle = shape.height[0] > 0 && shape.height[1] > 0 &&
                  is_circle_below(a, b, probe_radius, out.circle_radius);
    out.cusp_height = out.spindle ? cusp_height(a, b, probe_radius, out.circle_radius) : 0;
    out.axis = unit(b.center - a.center);
    out.center = center(ball[0]) + shape.height[0] * out.axis;
    if (in.start == kNoCorner) return;
    const std::array<CornerIndex, 2> corner{in.start, in.end};
    for (std::size_t end = 0; end < 2; ++end) {
      const Vec3d arm = shapes_.corner_from_circle(in.edge, corner[end]);
      const Vec3d flat = arm - dot(arm, out.axis) * out.axis;
      out.radial[end] = squared_norm(flat) > 0 ? unit(flat) : any_orthogonal(out.axis);
      arc_at(corner[end], in.edge) = static_cast<std::uint32_t>(i);
    }
  });
  drop_short_arcs(*this, exposed_, no_length, arcs);
  for (RolledArc& arc : arcs) {
    if (arc.dropped) arc.radial = {};
  }
}

// Numbers the probes in the order of their first corners, and lists the corners of each.
void AccessibleSurface::gather_corners() {
  DisjointSets same(arc_at_.size());
  for (std::size_t i = 0; i < arcs.size(); ++i) {
    if (!arcs[i].dropped) continue;
    same.join(static_cast<std::uint32_t>(exposed_[i].start),
              static_cast<std::uint32_t>(exposed_[i].end));
    ++dropped_arcs;
  }
  probe_at_.assign(arc_at_.size(), kNoIndex);
  for (std::uint32_t c = 0; c < arc_at_.size(); ++c) {
    if (arc_at_[c][0] == kNoIndex) continue;
    const std::uint32_t root = same.find(c);
    if (root == c) {
      probe_at_[c] = static_cast<std::uint32_t>(probes.size());
      probes.push_back({});
      probes.back().corner = c;
    } else {
      probe_at_[c] = probe_at_[root];
      ++gathered_corners;
    }
    ++probes[probe_at_[c]].corner_count;
  }
  std::uint32_t first = 0;
  for (Probe& p : probes) {
    p.corners_begin = first;
    first += std::exchange(p.corner_count, 0);
  }
  corners.resize(first);
  for (std::uint32_t c = 0; c < probe_at_.size(); ++c) {
    if (probe_at_[c] == kNoIndex) continue;
    Probe& p = probes[probe_at_[c]];
    corners[p.corners_begin + p.corner_count++] = c;
  }
}

bool AccessibleSurface::is_low(CornerIndex corner) const {
  const auto& v = triangle_of(corner).vertices;
  const auto& balls = triangulation_.balls;
  return is_corner_below({balls[v[0]], balls[v[1]], balls[v[2]]}, probe_radius,
                         shapes_.corners(corner / 2).half_chord);
}

// Places the probes, and lists the arcs that end at each.
void AccessibleSurface::list_sides() {
  sides.reserve(3 * probes.size());
  for (std::uint32_t i = 0; i < probes.size(); ++i) {
    Probe& p = probes[i];
    p.sides_begin = static_cast<std::uint32_t>(sides.size());
    for (const CornerIndex c : corners_of(p)) {
      const DualTriangle& f = triangle_of(c);
      p.low = p.low || is_low(c);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t arc = arc_at_[c][k];
        if (arcs[arc].dropped) continue;
        const auto end = leading_side(f, k) == c % 2 ? ArcEnd::start : ArcEnd::end;
        sides.push_back({arc, end});
        arcs[arc].probe[static_cast<std::size_t>(end)] = i;
      }
    }
    p.side_count = static_cast<std::uint32_t>(sides.size()) - p.sides_begin;
    p.center = corner_point(p.corner);
  }
}

void AccessibleSurface::link_circles() {
  for_each_index(arcs.size(), [&](std::size_t i) {
    if (exposed_[i].start == kNoCorner) return;
    const std::uint32_t edge = arcs[i].edge;
    const CornerIndex start = next_start(triangulation_, complex_, edge, exposed_[i].end);
    const std::uint32_t next = arc_at(start, edge);
    arcs[i].beyond[1] = next;
    arcs[next].beyond[0] = static_cast<std::uint32_t>(i);
  });
}

std::uint32_t AccessibleSurface::element_at(CornerIndex corner, std::size_t k) const {
  const std::uint32_t arc = arc_at_[corner][(k + 1) % 3];
  return static_cast<std::uint32_t>(2 * arc + side_of(arcs[arc], triangle_of(corner).vertices[k]));
}

// Joins the arcs that follow each other around a ball.
std::uint32_t AccessibleSurface::number_loops(Buffer<std::uint32_t>& loop_of) const {
  DisjointSets cycle(2 * arcs.size());
  for_each_index(arc_at_.size(), [&](std::size_t c) {
    if (arc_at_[c][0] == kNoIndex) return;
    const DualTriangle& f = triangle_of(c);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t m = arc_at_[c][(k + 1) % 3], n = arc_at_[c][(k + 2) % 3];
      cycle.join(static_cast<std::uint32_t>(2 * m + side_of(arcs[m], f.vertices[k])),
                 static_cast<std::uint32_t>(2 * n + side_of(arcs[n], f.vertices[k])));
    }
  });
  return std::move(cycle).number_sets(loop_of);
}

void AccessibleSurface::find_pieces() {
  Buffer<std::uint32_t> loop_of;
  ContactLoops table(number_loops(loop_of));
  for (std::uint32_t x = 0; x < loop_of.size(); ++x) {
    table.add(loop_of[x], {arcs[x / 2].ball[x % 2], x, !arcs[x / 2].dropped});
  }
  const std::vector<std::uint32_t> lowest = lowest_loops(table);
  std::vector<std::uint32_t> piece_of_loop(lowest.size());
  std::vector<std::uint8_t> has_piece(triangulation_.balls.size(), 0);
  for (std::uint32_t l = 0; l < lowest.size(); ++l) {
    const ContactLoop& loop = table.loops[l];
    if (lowest[l] == l) {
      piece_of_loop[l] = static_cast<std::uint32_t>(contacts.size());
      contacts.push_back(uncut_piece(loop.ball));
      contacts.back().point = true;
      has_piece[loop.ball] = 1;
    }
    piece_of_loop[l] = piece_of_loop[lowest[l]];
    ContactPiece& piece = contacts[piece_of_loop[l]];
    piece.solid_angle -= 2 * std::numbers::pi;
    piece.loops += loop.real;
    piece.point = piece.point && !loop.real;
  }
  for (std::uint32_t x = 0; x < loop_of.size(); ++x) {
    arcs[x / 2].contact[x % 2] = piece_of_loop[loop_of[x]];
  }
  for (std::uint32_t v = 0; v < has_piece.size(); ++v) {
    if (complex_.exposed[v] && !has_piece[v]) {
      contacts.push_back(uncut_piece(v));
    }
  }
}

std::vector<std::uint32_t> AccessibleSurface::lowest_loops(const ContactLoops& table) const {
  std::vector<std::array<std::uint32_t, 2>> rings;
  for (const auto& [ball, list] : table.several) {
    for (const std::uint32_t l : list) {
      const std::uint32_t arc = table.loops[l].element / 2;
      if (exposed_[arc].start == kNoCorner) rings.push_back(arcs[arc].ball);
    }
  }
  const RingCells ring_cells(triangulation_, rings);
  const auto outside_cell = [&](std::uint32_t loop) {
    const std::uint32_t arc = table.loops[loop].element / 2;
    const CornerIndex start = exposed_[arc].start;
    if (start == kNoCorner) return ring_cells.of(arcs[arc].ball);
    return triangle_of(start).cells[start % 2];
  };
  std::vector<std::uint32_t> lowest(table.loops.size());
  std::iota(lowest.begin(), lowest.end(), 0u);
  for (const auto& [ball, list] : table.several) {
    std::vector<std::uint32_t> left = list;
    while (left.size() > 1) {
      const std::uint32_t first = left.front();
      const auto seen = cells_of_piece(triangulation_, complex_, ball, outside_cell(first));
      std::erase_if(left, [&](std::uint32_t l) {
        if (l != first && !seen.contains(outside_cell(l))) return false;
        lowest[l] = first;
        return true;
      });
    }
  }
  return lowest;
}

// Adds what arcs and corners contribute to the solid angles of the pieces, which are 2 π χ so far,
// to their vectors, and to the solid angles of the probes. At a point of contact, the turning angle
// of the contact patch is the angle of the concave patch.
void AccessibleSurface::measure_pieces() {
  std::vector<WideSum> bend(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) bend[i].add(contacts[i].solid_angle);
  for (const RolledArc& arc : arcs) {
    for (std::size_t k = 0; k < 2; ++k) {
      const double radius = triangulation_.balls[arc.ball[k]].radius;
      bend[arc.contact[k]].add(arc.angle * (arc.height[k] / radius));
      Vec3d& vector = contacts[arc.contact[k]].vector;
      vector = vector + contact_vector(arc, k, radius);
    }
  }
  make_and_add(
      corners.size(),
      [&](std::size_t i) {
        std::array<double, 3> turning;
        for (std::size_t k = 0; k < 3; ++k) turning[k] = shapes_.turning_angle(corners[i] / 2, k);
        return turning;
      },
      [&](std::size_t i, const std::array<double, 3>& turning) {
        const CornerIndex c = corners[i];
        Probe& probe = probes[probe_at_[c]];
        probe.solid_angle += turning[0] + turning[1] + turning[2] - std::numbers::pi;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t x = element_at(c, k);
          bend[arcs[x / 2].contact[x % 2]].add(-turning[k]);
        }
      });
  for (std::size_t i = 0; i < contacts.size(); ++i) contacts[i].solid_angle = bend[i].value();
}

void AccessibleSurface::find_components() {
  DisjointSets sets(contacts.size());
  for (const RolledArc& arc : arcs) sets.join(arc.contact[0], arc.contact[1]);
  Buffer<std::uint32_t> number;
  components.assign(std::move(sets).number_sets(number), ComponentMeasures{0, 0, {0, 0, 0}});
  std::vector<WideSum> area(components.size()), volume(components.size());
  for (std::size_t i = contacts.size(); i-- > 0;) {
    components[number[i]].home = triangulation_.balls[contacts[i].ball].center;
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    ContactPiece& piece = contacts[i];
    piece.component = number[i];
    const Vec3d& home = components[number[i]].home;
    const double r = triangulation_.balls[piece.ball].radius;
    area[piece.component].add(r * r * piece.solid_angle);
    volume[piece.component].add(
        flux_through(r, place(piece.ball, home), piece.solid_angle, piece.vector));
  }
  for (std::size_t i = 0; i < components.size(); ++i) {
    components[i].area = area[i].value();
    components[i].volume = volume[i].value();
  }
  for (Probe& p : probes) {
    p.component = component_of(arcs[arc_at_[p.corner][0]]);
  }
}

// A component with a probe is outer if the cell beside the corner of the probe is. A component
// without probes has rings alone, or is a whole sphere. Its balls are in no other component, so any
// cell at one of them decides.
std::vector<std::uint8_t> AccessibleSurface::outer_components() const {
  const std::vector<std::uint8_t> outer = outer_cells(triangulation_, complex_);
  std::vector<std::uint8_t> out(components.size(), 0), has_probe(components.size(), 0);
  for (const Probe& p : probes) {
    has_probe[p.component] = 1;
    if (outer[triangle_of(p.corner).cells[p.corner % 2]]) out[p.component] = 1;
  }
  if (std::find(has_probe.begin(), has_probe.end(), 0) == has_probe.end()) return out;
  std::vector<std::uint8_t> seen(triangulation_.balls.size(), 0);
  for (std::size_t c = 0; c < outer.size(); ++c) {
    for (const std::uint32_t v : triangulation_.cells[c]) {
      if (outer[c] && triangulation_.is_ball(v)) seen[v] = 1;
    }
  }
  for (const ContactPiece& piece : contacts) {
    if (!has_probe[piece.component] && seen[piece.ball]) out[piece.component] = 1;
  }
  return out;
}

}  // namespace vdwmesh::excluded

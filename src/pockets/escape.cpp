// escape_clearances(): the triangulation of the balls, all grown by one length, the level, says
// exactly whether a place is joined to infinity outside these balls, and which triangle is the
// narrowest of the widest way. The width of that triangle, the circle that touches its three balls,
// is the next level; when the way's narrowest triangle has the level as its width, that is the
// result. All places learn from the triangulations that are made for one of them.
#include "pockets/escape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <utility>

#include "complex/power_predicates.hpp"
#include "core/fixed_blocks.hpp"
#include "pockets/pocket_flow.hpp"

namespace vdwmesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Gate = std::array<std::uint32_t, 3>;  // balls, ascending

// The narrowest place of the widest way in one triangulation. For numbers of balls to be the same
// in all triangulations, they are ids of the set.
struct Narrowest {
  double alpha;
  Gate gate;  // all kNoIndex: the way's first cell is the narrowest
};

// The size of the face of a cell opposite to vertex k, and whether its smallest orthogonal sphere
// is in conflict with neither cell. Otherwise the face is no narrower than one of the cells.
std::pair<double, bool> passage(const PowerTriangulation& t, std::uint32_t c, std::size_t k) {
  const auto& v = t.cells[c];
  const auto& f = kFacetVertices[k];
  const Sphere &p = t.balls[v[f[0]]], &q = t.balls[v[f[1]]], &r = t.balls[v[f[2]]];
  if (side_sign(p, q, r, t.balls[v[k]]) == Sign::negative) return {cell_alpha(t, c), false};
  const std::uint32_t n = t.neighbors[c][k];
  if (is_finite_cell(t, n)) {
    const std::uint32_t d = t.apex(n, c);
    if (side_sign(p, q, r, t.balls[d]) == Sign::negative) return {cell_alpha(t, n), false};
  }
  return {face_alpha(t, c, k), true};
}

Gate gate_of(const PowerTriangulation& t, std::uint32_t c, std::size_t k) {
  const auto& f = kFacetVertices[k];
  Gate gate{t.ids[t.cells[c][f[0]]], t.ids[t.cells[c][f[1]]], t.ids[t.cells[c][f[2]]]};
  std::ranges::sort(gate);
  return gate;
}

// Dijkstra's algorithm for the widest path from a place to infinity. It ends at the first cell
// there.
Narrowest narrowest_in(const PowerTriangulation& t, const Vec3d& place) {
  constexpr Gate kNoGate{kNoIndex, kNoIndex, kNoIndex};
  std::vector<double> best(t.cells.size(), -kInfinity);
  std::map<std::uint32_t, Gate> gates;  // by cell: the narrowest gate of the way there
  std::priority_queue<std::pair<double, std::uint32_t>> widest;
  const std::uint32_t first = cell_at(t, place, first_finite_cell(t));
  best[first] = kInfinity;
  gates[first] = kNoGate;
  widest.push({kInfinity, first});
  while (!widest.empty()) {
    const auto [alpha, c] = widest.top();
    widest.pop();
    const Gate gate = gates[c];
    if (!is_finite_cell(t, c)) return {alpha, gate};
    if (alpha < best[c]) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t n = t.neighbors[c][k];
      if (best[n] >= alpha) continue;
      const auto [size, is_gate] = passage(t, c, k);
      if (std::min(alpha, size) <= best[n]) continue;
      best[n] = std::min(alpha, size);
      gates[n] = size >= alpha ? gate : is_gate ? gate_of(t, c, k) : kNoGate;
      widest.push({best[n], n});
    }
  }
  return {-kInfinity, kNoGate};
}

class EscapeFinder {
 public:
  EscapeFinder(const PowerTriangulation& t, const std::vector<ClearPlace>& places, Monitor* monitor)
      : t_(t), monitor_(monitor) {
    double smallest = kInfinity;
    for (std::size_t i = 0; i < t.balls.size(); ++i) {
      smallest = std::min(smallest, t.balls[i].radius);
    }
    lowest_ = -smallest;
    for (const ClearPlace& p : places) {
      searches_.push_back({.from = p, .low = lowest_, .high = p.clearance, .guess = 0});
    }
  }

  std::vector<std::optional<double>> run() && {
    look_at(t_, 0);
    for (;;) {
      const auto next = std::ranges::find(searches_, false, &Search::is_done);
      if (next == searches_.end()) break;
      advance(monitor_, 0);
      look_at(triangulate(grown(t_.balls, next->guess), monitor_), next->guess);
    }
    std::vector<std::optional<double>> out;
    for (const Search& s : searches_) {
      out.push_back(s.guess > lowest_ ? std::optional(s.guess) : std::nullopt);
    }
    return out;
  }

 private:
  // Between `low`, at which there is a way, and `high`, at which there is none.
  struct Search {
    ClearPlace from;
    double low, high;
    double guess;  // the result when done
    Gate low_gate{}, high_gate{};
    bool is_done = false;
    int rounds = 0;
  };

  // Narrows all searches between whose bounds the level lies.
  void look_at(const PowerTriangulation& t, double level) {
    const int scale = &t == &t_ ? 0 : t.scale_exponent;
    const auto scaled = [&](double x) { return std::ldexp(x, -scale); };
    for_each_block(searches_.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
      Search& s = searches_[i];
      if (s.is_done || level <= s.low || level >= s.high) return;
      const Vec3d& p = s.from.place;
      Narrowest found = narrowest_in(t, {scaled(p.x), scaled(p.y), scaled(p.z)});
      if (&t == &t_) found.gate = index_of(found.gate);
      narrow(s, found, level);
    });
  }

  // Gates of grown triangulations name balls of t_ by their indices.
  Gate index_of(Gate gate) const {
    if (gate[0] == kNoIndex) return gate;
    for (std::uint32_t& id : gate) {
      id = static_cast<std::uint32_t>(std::ranges::find(t_.ids, id) - t_.ids.begin());
    }
    std::ranges::sort(gate);
    return gate;
  }

  void narrow(Search& s, const Narrowest& found, double level) const {
    ++s.rounds;
    (found.alpha > 0 ? s.low : s.high) = level;
    (found.alpha > 0 ? s.low_gate : s.high_gate) = found.gate;
    const double width = width_of(found.gate, s);
    const bool is_inside = width > s.low && width < s.high;
    const bool is_settled = s.low_gate == s.high_gate && s.high - s.low <= kWindow && is_inside;
    if (std::abs(width - level) <= kSameWidth || is_settled) {
      s.is_done = true;
      s.guess = width;
    } else if (s.high - s.low <= kSameWidth) {
      s.is_done = true;
      s.guess = s.high;
    } else if (width >= s.high) {
      s.guess = s.high - kSameWidth / 2;  // perhaps nothing traps the probe
    } else {
      // A guess out of bounds, or many that did not help, makes way for the middle.
      s.guess = is_inside && s.rounds < kMostGuesses ? width : (s.low + s.high) / 2;
    }
  }

  double width_of(const Gate& gate, const Search& s) const {
    if (gate[0] == kNoIndex) return s.from.clearance;
    const std::array<Sphere, 3> balls{t_.balls[gate[0]], t_.balls[gate[1]], t_.balls[gate[2]]};
    const auto gate_at = gate_place(balls);
    return std::min(gate_at ? gate_at->clearance : s.low, s.from.clearance);
  }

  // Scaled: the largest radius is from 1/2 to 1. If the narrowest gate is the same at two levels no
  // farther apart than the window, it is that in between.
  static constexpr double kWindow = 0.03, kSameWidth = 1e-11;
  static constexpr int kMostGuesses = 30;

  const PowerTriangulation& t_;
  Monitor* monitor_;
  std::vector<Search> searches_;
  double lowest_;
};

}  // namespace

std::uint32_t first_finite_cell(const PowerTriangulation& t) {
  for (std::uint32_t c = 0; c < t.cells.size(); ++c) {
    if (is_finite_cell(t, c)) return c;
  }
  return 0;
}

std::uint32_t cell_at(const PowerTriangulation& t, const Vec3d& place, std::uint32_t from) {
  const Sphere point{place, 1};
  for (std::uint32_t c = from;;) {
    if (!is_finite_cell(t, c)) return c;
    const auto& v = t.cells[c];
    std::size_t k = 0;
    for (; k < 4; ++k) {
      const auto& f = kFacetVertices[k];
      // Seen from vertex k the face is counter-clockwise.
      if (orientation_sign(t.balls[v[f[0]]], t.balls[v[f[1]]], t.balls[v[f[2]]], point) ==
          Sign::negative) {
        break;
      }
    }
    if (k == 4) return c;
    c = t.neighbors[c][k];
  }
}

std::vector<std::optional<double>> escape_clearances(const PowerTriangulation& triangulation,
                                                     const std::vector<ClearPlace>& places,
                                                     Monitor* monitor) {
  return EscapeFinder(triangulation, places, monitor).run();
}

}  // namespace vdwmesh

// pocket_flow(): the faces that flow crosses, the cells from which it comes to infinity, and the
// components of the others. WidestWays: Dijkstra's algorithm for widest paths.
#include "pockets/pocket_flow.hpp"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

#include "complex/power_predicates.hpp"
#include "complex/simplex_shape.hpp"
#include "core/disjoint_sets.hpp"
#include "core/fixed_blocks.hpp"
#include "core/steps.hpp"

namespace vdwmesh {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

class FlowFinder {
 public:
  FlowFinder(const PowerTriangulation& t, const DualComplex& complex, Monitor* monitor)
      : t_(t), complex_(complex), monitor_(monitor) {
    out_.obtuse.assign(t.cells.size(), 0);
    out_.pocket.assign(t.cells.size(), kNoIndex);
  }

  PocketFlow run() && {
    find_obtuse_faces();
    mark_outside();
    join_pockets();
    return std::move(out_);
  }

 private:
  struct Ties {
    std::uint64_t faces = 0, cells = 0;
  };

  // The orthogonal centre of cell abcd lies beyond the face abc exactly if ball d conflicts with
  // the smallest sphere that is orthogonal to a, b and c: the power of d to that sphere is twice
  // the product of the heights of the centre and of d over the face. So no centre is computed.
  void find_obtuse_faces() {
    const auto found = collect<Ties>(
        t_.cells.size(),
        [&](std::size_t c, std::vector<Ties>& ties) {
          look_at(static_cast<std::uint32_t>(c), ties);
        },
        monitor_);
    for (const Ties& ties : found) {
      out_.face_ties += ties.faces;
      out_.cell_ties += ties.cells;
    }
  }

  void look_at(std::uint32_t c, std::vector<Ties>& found) {
    if (!is_finite_cell(t_, c)) return;
    const auto& v = t_.cells[c];
    Ties ties;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto& f = kFacetVertices[k];
      const Sign side = side_sign(ball(v[f[0]]), ball(v[f[1]]), ball(v[f[2]]), ball(v[k]));
      if (side == Sign::negative) {
        out_.obtuse[c] = static_cast<std::uint8_t>(out_.obtuse[c] | (1u << k));
      }
      if (complex_.cell_in_complex[c]) continue;
      ties.faces += side == Sign::zero;
      ties.cells += is_cell_tie(c, k);
    }
    if (ties.faces + ties.cells > 0) found.push_back(ties);
  }

  // Whether the neighbour across the face has the same orthogonal sphere; counted from one side.
  bool is_cell_tie(std::uint32_t c, std::size_t k) const {
    const std::uint32_t n = t_.neighbors[c][k];
    if (n < c || !is_finite_cell(t_, n)) return false;
    const std::uint32_t d = t_.apex(n, c);
    const auto& v = t_.cells[c];
    return power_side(ball(v[0]), ball(v[1]), ball(v[2]), ball(v[3]), ball(d)) == Sign::zero;
  }

  // Goes against the flow, from infinity on. Cells that are outside lose the mark kInPocket.
  void mark_outside() {
    std::vector<std::uint32_t> queue;
    for (std::uint32_t c = 0; c < t_.cells.size(); ++c) {
      if (!is_finite_cell(t_, c)) {
        queue.push_back(c);
      } else if (!complex_.cell_in_complex[c]) {
        out_.pocket[c] = kInPocket;
        ++out_.empty_cells;
      }
    }
    Steps steps(monitor_);
    while (!queue.empty()) {
      const std::uint32_t c = queue.back();
      queue.pop_back();
      steps.add(1);
      for (const std::uint32_t n : t_.neighbors[c]) {
        if (n == kNoIndex || out_.pocket[n] != kInPocket) continue;
        if (!(out_.obtuse[n] >> t_.slot_of_neighbor(n, c) & 1)) continue;
        out_.pocket[n] = kNoIndex;
        queue.push_back(n);
      }
    }
  }

  void join_pockets() {
    for (std::uint32_t c = 0; c < t_.cells.size(); ++c) {
      if (out_.pocket[c] == kInPocket) out_.cells.push_back(c);
    }
    DisjointSets sets(t_.cells.size());
    for (const std::uint32_t c : out_.cells) {
      for (std::size_t k = 0; k < 4; ++k) {
        const std::uint32_t n = t_.neighbors[c][k];
        if (n > c && out_.pocket[n] == kInPocket && complex_.cell_triangles[c][k] == kNoIndex) {
          sets.join(c, n);
        }
      }
    }
    // The representative of a set is its lowest member, which comes first here.
    for (const std::uint32_t c : out_.cells) {
      const std::uint32_t root = sets.find(c);
      out_.pocket[c] = root == c ? out_.pockets++ : out_.pocket[root];
    }
  }

  static constexpr std::uint32_t kInPocket = 0;  // until pockets are numbered

  const Sphere& ball(std::uint32_t i) const { return t_.balls[i]; }

  const PowerTriangulation& t_;
  const DualComplex& complex_;
  Monitor* monitor_;
  PocketFlow out_;
};

}  // namespace

bool is_finite_cell(const PowerTriangulation& t, std::uint32_t cell) {
  const auto& v = t.cells[cell];
  return t.is_ball(v[0]) && t.is_ball(v[1]) && t.is_ball(v[2]) && t.is_ball(v[3]);
}

PocketFlow pocket_flow(const PowerTriangulation& triangulation, const DualComplex& complex,
                       Monitor* monitor) {
  return FlowFinder(triangulation, complex, monitor).run();
}

double cell_alpha(const PowerTriangulation& t, std::uint32_t cell) {
  const auto& v = t.cells[cell];
  const std::array<Sphere, 4> balls{t.balls[v[0]], t.balls[v[1]], t.balls[v[2]], t.balls[v[3]]};
  return squared_norm(orthogonal_center(balls)) - balls[0].radius * balls[0].radius;
}

double face_alpha(const PowerTriangulation& t, std::uint32_t cell, std::size_t k) {
  const auto& v = t.cells[cell];
  const auto& f = kFacetVertices[k];
  return orthogonal_size(t.balls[v[f[0]]], t.balls[v[f[1]]], t.balls[v[f[2]]]);
}

// All cells at infinity are where the paths begin.
WidestWays::WidestWays(const PowerTriangulation& t, const std::vector<std::uint8_t>& obtuse,
                       const std::vector<std::uint32_t>& wanted, Monitor* monitor)
    : alpha_(t.cells.size(), -kUnbounded) {
  std::vector<std::uint8_t> is_wanted(t.cells.size(), 0), settled(t.cells.size(), 0);
  std::size_t open = 0;
  for (const std::uint32_t c : wanted) open += !std::exchange(is_wanted[c], std::uint8_t{1});
  std::priority_queue<std::pair<double, std::uint32_t>> widest;
  // The size of the face between a cell and the neighbour n, in which it is opposite to vertex k.
  const auto face = [&](std::uint32_t from, std::uint32_t n, std::size_t k) {
    const std::size_t back = t.slot_of_neighbor(from, n);
    const bool near = obtuse[n] >> k & 1, far = obtuse[from] >> back & 1;
    if (!near && !far) return face_alpha(t, n, k);
    return near ? cell_alpha(t, n) : cell_alpha(t, from);
  };
  const auto leave = [&](std::uint32_t c) {
    for (const std::uint32_t n : t.neighbors[c]) {
      if (n == kNoIndex || settled[n]) continue;
      const double alpha = std::min(alpha_[c], face(c, n, t.slot_of_neighbor(n, c)));
      if (alpha <= alpha_[n]) continue;
      alpha_[n] = alpha;
      widest.push({alpha, n});
    }
  };
  for (std::uint32_t c = 0; c < t.cells.size(); ++c) {
    if (is_finite_cell(t, c)) continue;
    settled[c] = 1;
    alpha_[c] = kUnbounded;
  }
  for (std::uint32_t c = 0; c < t.cells.size(); ++c) {
    if (!is_finite_cell(t, c)) leave(c);
  }
  Steps steps(monitor);
  while (open > 0 && !widest.empty()) {
    const std::uint32_t c = widest.top().second;
    widest.pop();
    if (std::exchange(settled[c], std::uint8_t{1})) continue;
    steps.add(1);
    open -= is_wanted[c];
    leave(c);
  }
}

}  // namespace vdwmesh

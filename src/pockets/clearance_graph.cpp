// clearance_graph(): at each level, the sinks of the flow are where climbs to summits begin, and
// the triangles of the triangulation are asked whether they have a pass.
#include "pockets/clearance_graph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "complex/dual_complex.hpp"
#include "complex/simplex_shape.hpp"
#include "core/disjoint_sets.hpp"
#include "core/fixed_blocks.hpp"
#include "pockets/escape.hpp"
#include "pockets/pocket_flow.hpp"

namespace vdwmesh {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
// Shares of the largest radius: summits nearer to each other than the first are one, and clearances
// that differ by less than the second are equal up to rounding.
constexpr double kSamePlace = 1e-6, kSameGap = 1e-11;

using BallTriple = std::array<std::uint32_t, 3>;  // ascending

// A triangulation of all balls grown by `clearance`, with the components outside of them.
struct GrownBalls {
  double clearance;
  PowerTriangulation t;
  int scale;  // lengths in t times 2^scale are lengths in the graph
  PocketFlow flow;
  std::vector<std::uint32_t> component;  // per cell; 0 is the outside, kNoIndex in the complex
  std::uint32_t components = 0;

  bool is_sink(std::uint32_t c) const {
    return component[c] != kNoIndex && flow.obtuse[c] == 0 && is_finite_cell(t, c);
  }
  Vec3d center_of(std::uint32_t c) const {
    const auto& v = t.cells[c];
    const std::array<Sphere, 4> balls{t.balls[v[0]], t.balls[v[1]], t.balls[v[2]], t.balls[v[3]]};
    return std::ldexp(1.0, scale) * (balls[0].center + orthogonal_center(balls));
  }
};

// Numbers the components of cells outside the complex, joined across faces that are outside it.
void find_components(GrownBalls& level, const DualComplex& k) {
  const PowerTriangulation& t = level.t;
  const auto count = static_cast<std::uint32_t>(t.cells.size());
  DisjointSets sets(count + 1);  // the last stands for infinity
  for (std::uint32_t c = 0; c < count; ++c) {
    if (!is_finite_cell(t, c)) sets.join(c, count);
    if (k.cell_in_complex[c]) continue;
    for (std::size_t f = 0; f < 4; ++f) {
      const std::uint32_t n = t.neighbors[c][f];
      if (n != kNoIndex && k.cell_triangles[c][f] == kNoIndex) sets.join(c, n);
    }
  }
  std::vector<std::uint32_t> number(count + 1, kNoIndex);
  number[sets.find(count)] = level.components++;
  level.component.assign(count, kNoIndex);
  for (std::uint32_t c = 0; c < count; ++c) {
    if (k.cell_in_complex[c]) continue;
    std::uint32_t& n = number[sets.find(c)];
    if (n == kNoIndex) n = level.components++;
    level.component[c] = n;
  }
}

// Where a climb ends: on a summit, or in a component above the ceiling.
struct ClimbEnd {
  ClearPlace at;
  std::uint32_t component = kNoIndex;
  std::uint32_t node = kNoIndex;
};

// A place beside a pass with more clearance. The clearance rises with the square of the distance,
// until another ball is near.
std::optional<Vec3d> rise(const std::vector<Sphere>& balls, const ClearancePass& pass,
                          std::size_t side) {
  constexpr double kFirstStep = 1e-3;  // scaled: far shorter than the distance to another ball
  constexpr int kHalvings = 10;
  double step = kFirstStep;
  for (int i = 0; i < kHalvings; ++i, step /= 2) {
    const Vec3d place = pass.at.place + (side == 0 ? step : -step) * pass.normal;
    if (clearance_at(balls, place) > pass.at.clearance) return place;
  }
  return std::nullopt;
}

class ClearanceGraphFinder {
 public:
  ClearanceGraphFinder(const SphereSet& balls, double ceiling, Monitor* monitor,
                       std::uint64_t memory_limit)
      : monitor_(monitor), memory_limit_(memory_limit) {
    graph_.base = triangulate(balls, monitor, std::nullopt, memory_limit);
    ceiling_ = std::ldexp(ceiling, -graph_.base.scale_exponent);
    for (const Sphere& b : this->balls()) largest_ = std::max(largest_, b.radius);
  }

  ClearanceGraph run(std::span<const Vec3d> starts) && {
    top_ = level_at(ceiling_);
    add_large();
    take(top_);
    const double step = kStep * largest_;
    const double count = std::max(1.0, std::ceil(ceiling_ / step));
    for (double i = 0; i < count; ++i) take(level_at(ceiling_ * i / count));
    for (const Vec3d& start : starts) {
      starts_.push_back(climb(std::ldexp(1.0, -graph_.base.scale_exponent) * start));
    }
    build();
    for (int round = 0; round < kMostRounds && refine(); ++round) build();
    graph_.is_complete = std::ranges::all_of(
        graph_.enclosed, [&](const auto& level) { return missing(level) == 0; });
    for (const ClimbEnd& end : starts_) graph_.start_nodes.push_back(end.node);
    return std::move(graph_);
  }

 private:
  // Levels are this share of the largest radius apart. Triangles of passes come and go with the
  // level as radii differ; most live much longer.
  static constexpr double kStep = 0.12;
  static constexpr int kMostRounds = 6;  // each halves the steps where something is missing

  const std::vector<Sphere>& balls() const { return graph_.base.balls; }

  GrownBalls level_at(double clearance) const {
    advance(monitor_, 0);
    GrownBalls level{
        .clearance = clearance,
        .t = triangulate(grown(balls(), clearance), monitor_, std::nullopt, memory_limit_),
        .scale = 0,
        .flow = {},
        .component = {}};
    level.scale = level.t.scale_exponent;
    const DualComplex k = dual_complex(level.t, monitor_);
    level.flow = pocket_flow(level.t, k, monitor_);
    find_components(level, k);
    return level;
  }

  // The components above the ceiling. Each has a sink.
  void add_large() {
    graph_.large = top_.components - 1;
    large_.assign(top_.components, {{}, -kUnlimited});
    large_[kOutsideNode].clearance = kUnlimited;
    for (std::uint32_t c = 0; c < top_.t.cells.size(); ++c) {
      if (!top_.is_sink(c) || top_.component[c] == 0) continue;
      const auto summit = climb_clearance(balls(), top_.center_of(c));
      ClearPlace& best = large_[top_.component[c]];
      if (summit && summit->clearance > best.clearance) best = *summit;
    }
  }

  ClimbEnd climb(const Vec3d& start) const {
    // Beyond the ceiling by more than rounding, so that the place is outside the grown balls.
    const auto end = climb_clearance(balls(), start, ceiling_ + kSameGap * largest_);
    if (!end) return {{start, kUnlimited}, kOutsideNode};
    if (end->clearance <= ceiling_) return {*end};
    return {*end, component_of(end->place)};
  }

  std::uint32_t component_of(const Vec3d& place) const {
    const std::uint32_t c =
        cell_at(top_.t, std::ldexp(1.0, -top_.scale) * place, first_finite_cell(top_.t));
    return top_.component[c] == kNoIndex ? kOutsideNode : top_.component[c];
  }

  // Takes the sinks and the passes of a level.
  void take(const GrownBalls& level) {
    graph_.enclosed[level.clearance] = level.components - 1;
    std::vector<Vec3d> sinks;
    for (std::uint32_t c = 0; c < level.t.cells.size(); ++c) {
      if (!level.is_sink(c)) continue;
      const Vec3d place = level.center_of(c);
      if (clearance_at(balls(), place) > 0) sinks.push_back(place);
    }
    const std::size_t first = ends_.size();
    ends_.resize(first + sinks.size());
    for_each_block(sinks.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
      advance(monitor_, 0);
      ends_[first + i] = climb(sinks[i]);
    });
    take_passes(level);
  }

  void take_passes(const GrownBalls& level) {
    const auto candidates = collect<ClearancePass>(
        level.t.cells.size(),
        [&](std::size_t c, std::vector<ClearancePass>& found) {
          for (std::size_t k = 0; k < 4; ++k) {
            add_candidate(level.t, static_cast<std::uint32_t>(c), k, found);
          }
        },
        monitor_);
    std::vector<ClearancePass> passes;
    for (const ClearancePass& p : candidates) {
      if (seen_.insert(p.balls).second) passes.push_back(p);
    }
    std::vector<std::vector<ClimbEnd>> ends(passes.size());
    for_each_block(passes.size(), 16, [&](std::size_t, std::size_t begin, std::size_t end) {
      advance(monitor_, 0);
      for (std::size_t i = begin; i < end; ++i) ends[i] = ends_of(passes[i]);
    });
    for (std::size_t i = 0; i < passes.size(); ++i) {
      if (ends[i].size() < 2) continue;
      passes_.push_back(passes[i]);
      pass_ends_.insert(pass_ends_.end(), ends[i].begin(), ends[i].end());
    }
  }

  // The face of a cell opposite to vertex k, if its circle lies in it, and the balls of its two
  // cells are not nearer.
  void add_candidate(const PowerTriangulation& t, std::uint32_t c, std::size_t k,
                     std::vector<ClearancePass>& found) const {
    const std::uint32_t n = t.neighbors[c][k];
    // The other cell takes the face; `seen_` takes a face of the hull once.
    if (n != kNoIndex && n < c && is_finite_cell(t, n)) return;
    const auto& f = kFacetVertices[k];
    BallTriple face;
    for (std::size_t m = 0; m < 3; ++m) {
      const std::uint32_t v = t.cells[c][f[m]];
      if (!t.is_ball(v)) return;
      face[m] = t.ids[v];
    }
    std::ranges::sort(face);
    const Sphere &a = balls()[face[0]], &b = balls()[face[1]], &d = balls()[face[2]];
    const auto at = gate_place({a, b, d});
    if (!at || at->clearance <= 0 || at->clearance > ceiling_) return;
    const Vec3d normal = cross(b.center - a.center, d.center - a.center);
    const double area = squared_norm(normal);
    const auto weight = [&](const Vec3d& p, const Vec3d& q) {
      return dot(normal, cross(p - at->place, q - at->place));
    };
    constexpr double kOnEdge = -1e-9;  // of the area: rounding of a circle's centre on an edge
    const double least = std::min(
        {weight(a.center, b.center), weight(b.center, d.center), weight(d.center, a.center)});
    if (!(area > 0) || least < kOnEdge * area) return;
    for (const std::uint32_t opposite : {t.cells[c][k], n == kNoIndex ? n : t.apex(n, c)}) {
      if (opposite == kNoIndex || !t.is_ball(opposite)) continue;
      const Sphere& s = balls()[t.ids[opposite]];
      if (norm(at->place - s.center) - s.radius < at->clearance - kSameGap * largest_) return;
    }
    found.push_back({*at, face, 1 / std::sqrt(area) * normal, {kNoIndex, kNoIndex}});
  }

  // Where the clearance rises to on both sides; fewer than two if there is no pass.
  std::vector<ClimbEnd> ends_of(const ClearancePass& pass) const {
    if (clearance_at(balls(), pass.at.place) < pass.at.clearance - kSameGap * largest_) return {};
    std::vector<ClimbEnd> ends;
    for (std::size_t side = 0; side < 2; ++side) {
      if (const auto start = rise(balls(), pass, side)) ends.push_back(climb(*start));
    }
    return ends;
  }

  // Makes nodes of all ends, and the graph's passes.
  void build() {
    std::vector<ClimbEnd*> summits;
    const auto take_end = [&](ClimbEnd& end) {
      if (end.component == kNoIndex) summits.push_back(&end);
      end.node = end.component;
    };
    for (ClimbEnd& end : ends_) take_end(end);
    for (ClimbEnd& end : starts_) take_end(end);
    for (ClimbEnd& end : pass_ends_) take_end(end);
    graph_.nodes = large_;
    number_summits(summits);
    graph_.passes = passes_;
    for (std::size_t i = 0; i < passes_.size(); ++i) {
      graph_.passes[i].nodes = {pass_ends_[2 * i].node, pass_ends_[2 * i + 1].node};
    }
    std::ranges::sort(graph_.passes, [](const ClearancePass& a, const ClearancePass& b) {
      return std::pair(-a.at.clearance, a.balls) < std::pair(-b.at.clearance, b.balls);
    });
  }

  // Ends at one place are one summit. Sorted by x, they are found by looking back a little.
  void number_summits(std::vector<ClimbEnd*>& ends) {
    std::ranges::stable_sort(ends, {}, [](const ClimbEnd* e) {
      return std::array{e->at.place.x, e->at.place.y, e->at.place.z};
    });
    const double same = kSamePlace * largest_;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const ClearPlace& at = ends[i]->at;
      for (std::size_t j = i; j-- > 0 && at.place.x - ends[j]->at.place.x <= same;) {
        if (norm(at.place - ends[j]->at.place) <= same) {
          ends[i]->node = ends[j]->node;
          break;
        }
      }
      if (ends[i]->node == kNoIndex) {
        ends[i]->node = static_cast<std::uint32_t>(graph_.nodes.size());
        graph_.nodes.push_back(at);
      }
      ClearPlace& node = graph_.nodes[ends[i]->node];
      if (at.clearance > node.clearance) node = at;
    }
  }

  // Components that summits and passes say there are, less those that there are.
  std::int64_t missing(const std::pair<const double, std::uint64_t>& level) const {
    DisjointSets sets(graph_.nodes.size());
    std::int64_t components = -1;  // without the outside
    for (const ClearPlace& node : graph_.nodes) components += node.clearance > level.first;
    for (const ClearancePass& pass : graph_.passes) {
      if (pass.at.clearance <= level.first) break;
      const std::uint32_t a = sets.find(pass.nodes[0]), b = sets.find(pass.nodes[1]);
      components -= a != b;
      sets.join(a, b);
    }
    return components - static_cast<std::int64_t>(level.second);
  }

  // Takes levels in the middle where what is missing changes; whether there are any.
  bool refine() {
    std::vector<double> middles;
    for (auto low = graph_.enclosed.begin(), high = std::next(low); high != graph_.enclosed.end();
         ++low, ++high) {
      if (missing(*low) != missing(*high)) middles.push_back((low->first + high->first) / 2);
    }
    for (const double middle : middles) take(level_at(middle));
    return !middles.empty();
  }

  Monitor* monitor_;
  const std::uint64_t memory_limit_;
  double ceiling_ = 0, largest_ = 0;  // scaled
  GrownBalls top_{};
  std::vector<ClearPlace> large_;  // per component of the top
  std::vector<ClimbEnd> ends_, starts_;
  std::vector<ClearancePass> passes_;
  std::vector<ClimbEnd> pass_ends_;  // two for each pass
  std::set<BallTriple> seen_;
  ClearanceGraph graph_;
};

}  // namespace

ClearanceGraph clearance_graph(const SphereSet& balls, double ceiling,
                               std::span<const Vec3d> starts, Monitor* monitor,
                               std::uint64_t memory_limit) {
  return ClearanceGraphFinder(balls, ceiling, monitor, memory_limit).run(starts);
}

std::vector<ClearPlace> way_up(const std::vector<Sphere>& balls, const ClearancePass& pass,
                               std::size_t side, double ceiling) {
  std::vector<ClearPlace> trail;
  const auto start = rise(balls, pass, side);
  if (start) climb_clearance(balls, *start, ceiling, &trail);
  return trail;
}

}  // namespace vdwmesh

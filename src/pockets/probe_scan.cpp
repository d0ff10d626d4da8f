// probe_scan(): the merge tree of the summits of the clearance (clearance_graph.hpp), by Kruskal's
// algorithm over their passes by falling clearance. When two sets of summits join, the place of the
// lower one ends there (elder rule). way_out() follows that tree from a summit to the outside: no
// other way there has a wider narrowest pass.
#include "pockets/probe_scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "complex/simplex_shape.hpp"
#include "core/errors.hpp"
#include "pockets/clearance_graph.hpp"
#include "pockets/escape.hpp"
#include "pockets/pocket_flow.hpp"

namespace vdwmesh {
namespace {

// Converts a graph's scaled places and clearances to Å. Its balls are grown by `lowest`, which is
// added to a clearance to get the radius of the probe.
class GraphScale {
 public:
  GraphScale(const ClearanceGraph& graph, double lowest) : graph_(graph), lowest_(lowest) {}

  double radius(double clearance) const {
    return lowest_ + std::ldexp(clearance, graph_.base.scale_exponent);
  }
  Vec3d place(const Vec3d& scaled) const {
    return std::ldexp(1.0, graph_.base.scale_exponent) * scaled;
  }
  ProbeGate gate(const ClearancePass& pass) const {
    ProbeGate gate{place(pass.at.place), radius(pass.at.clearance), {}};
    for (std::size_t k = 0; k < 3; ++k) gate.spheres[k] = graph_.base.ids[pass.balls[k]];
    std::ranges::sort(gate.spheres);
    return gate;
  }

 private:
  const ClearanceGraph& graph_;
  const double lowest_;
};

// Whether node a is the elder of b: more clearance, which is infinite for the outside. Of equal
// places the coordinates decide, because the numbers of nodes depend on those of the balls.
bool is_elder(const ClearanceGraph& graph, std::uint32_t a, std::uint32_t b) {
  const auto key = [&](std::uint32_t i) {
    const auto& [place, clearance] = graph.nodes[i];
    return std::tuple(-clearance, place.x, place.y, place.z, i);
  };
  return key(a) < key(b);
}

// Joins sets of nodes at passes, in the order of graph.passes: by falling clearance. A set is named
// by its eldest node.
class MergeTree {
 public:
  explicit MergeTree(const ClearanceGraph& graph) : graph_(graph), parent_(graph.nodes.size()) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  // Calls join(younger, elder, pass) for each pass that joins two sets.
  template <class Join>
  void run(const Join& join) {
    for (const ClearancePass& pass : graph_.passes) {
      std::uint32_t elder = find(pass.nodes[0]), younger = find(pass.nodes[1]);
      if (elder == younger) continue;
      if (is_elder(graph_, younger, elder)) std::swap(elder, younger);
      parent_[younger] = elder;
      join(younger, elder, pass);
    }
  }

 private:
  const ClearanceGraph& graph_;
  std::vector<std::uint32_t> parent_;
};

void check_range(const SphereSet& atoms, double lowest, double highest) {
  if (!(std::isfinite(lowest) && std::isfinite(highest) && lowest < highest)) {
    throw InvalidInput(
        fmt::format("probes from {} to {} Å: the first must be the smaller one", lowest, highest));
  }
  for (const Sphere& s : atoms.spheres()) {
    if (!(s.radius + lowest > 0)) {
      throw InvalidInput(fmt::format("with a probe of {} Å, a sphere of radius {} Å would vanish",
                                     lowest, s.radius));
    }
  }
}

}  // namespace

ProbeScan probe_scan(const SphereSet& atoms, double lowest, double highest, Monitor* monitor,
                     std::uint64_t memory_limit) {
  check_range(atoms, lowest, highest);
  const ClearanceGraph graph =
      clearance_graph(grown(atoms.spheres(), lowest), highest - lowest, {}, monitor, memory_limit);
  const GraphScale scale(graph, lowest);
  std::vector<ScanPlace> found(graph.nodes.size());  // by node; kOutsideNode, 0, is no place
  for (std::size_t i = 1; i < found.size(); ++i) {
    found[i].center = scale.place(graph.nodes[i].place);
    found[i].radius = scale.radius(graph.nodes[i].clearance);
  }
  std::vector<std::uint32_t> joins(found.size(), kNoIndex);
  MergeTree(graph).run([&](std::uint32_t younger, std::uint32_t elder, const ClearancePass& pass) {
    joins[younger] = elder;
    found[younger].gate = scale.gate(pass);
  });
  std::vector<std::uint32_t> order(found.size() - 1);
  std::iota(order.begin(), order.end(), 1u);
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) { return is_elder(graph, a, b); });
  std::vector<std::size_t> index(found.size());
  for (std::size_t i = 0; i < order.size(); ++i) index[order[i]] = i;
  ProbeScan scan{.places = {}, .voids = {}, .is_complete = graph.is_complete};
  for (const std::uint32_t i : order) {
    ScanPlace& place = scan.places.emplace_back(found[i]);
    if (joins[i] == kNoIndex) continue;
    if (joins[i] == kOutsideNode) {
      place.opens_at = place.gate->radius;
    } else {
      place.joins = index[joins[i]];
    }
  }
  // A place that joined an elder opens when the elder does. The elder stands before it, so its
  // opens_at is final.
  for (ScanPlace& place : scan.places) {
    if (place.joins) place.opens_at = scan.places[*place.joins].opens_at;
  }
  for (const auto& [clearance, voids] : graph.enclosed) scan.voids[scale.radius(clearance)] = voids;
  return scan;
}

namespace {

// A pass of the tree, as it is seen from one of its nodes.
struct TreeEdge {
  std::uint32_t to;
  const ClearancePass* pass;
  std::size_t to_side;  // `to` is pass->nodes[to_side]
  std::size_t from_side() const { return 1 - to_side; }
};

// The passes from a node to the outside. Empty if there is no way, or the node is outside.
std::vector<TreeEdge> edges_to_outside(const ClearanceGraph& graph, std::uint32_t from) {
  std::vector<std::vector<TreeEdge>> edges(graph.nodes.size());
  MergeTree(graph).run([&](std::uint32_t, std::uint32_t, const ClearancePass& pass) {
    for (std::size_t side = 0; side < 2; ++side) {
      edges[pass.nodes[side]].push_back({pass.nodes[1 - side], &pass, 1 - side});
    }
  });
  // From the outside inwards: `towards` has the way back out.
  std::vector<TreeEdge> towards(graph.nodes.size(), {kNoIndex, nullptr, 0});
  std::vector<std::uint32_t> queue{kOutsideNode};
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const std::uint32_t at = queue[next];
    for (const TreeEdge& e : edges[at]) {
      if (e.to == kOutsideNode || towards[e.to].pass) continue;
      towards[e.to] = {at, e.pass, e.from_side()};
      queue.push_back(e.to);
    }
  }
  std::vector<TreeEdge> way;
  for (std::uint32_t at = from; at != kOutsideNode && towards[at].pass; at = towards[at].to) {
    way.push_back(towards[at]);
  }
  return way;
}

class WayMaker {
 public:
  WayMaker(const ClearanceGraph& graph, double lowest)
      : graph_(graph), scale_(graph, lowest), way_{} {}

  WayOut run(const std::vector<ClearPlace>& start, const std::vector<TreeEdge>& edges,
             double ceiling) && {
    add(start);
    for (const TreeEdge& e : edges) {
      // The climb to the node behind, reversed; below, that to the node ahead.
      std::vector<ClearPlace> down = way_up(graph_.base.balls, *e.pass, e.from_side(), ceiling);
      std::ranges::reverse(down);
      add(down);
      way_.gates.push_back(scale_.gate(*e.pass));
      add({e.pass->at}, true);
      add(way_up(graph_.base.balls, *e.pass, e.to_side, ceiling));
    }
    way_.length = way_.points.back().along;
    // Climbs only widen, so without a gate the start is narrowest. Else it does not count.
    way_.bottleneck = way_.points.front().radius;
    const auto narrowest = std::ranges::min_element(way_.gates, {}, &ProbeGate::radius);
    if (narrowest != way_.gates.end()) way_.bottleneck = narrowest->radius;
    for (const ProbeGate& g : way_.gates) {
      way_.spheres.insert(way_.spheres.end(), g.spheres.begin(), g.spheres.end());
    }
    std::ranges::sort(way_.spheres);
    way_.spheres.erase(std::unique(way_.spheres.begin(), way_.spheres.end()), way_.spheres.end());
    return std::move(way_);
  }

 private:
  void add(const std::vector<ClearPlace>& trail, bool is_gate = false) {
    for (const ClearPlace& p : trail) {
      const Vec3d center = scale_.place(p.place);
      double along = 0;
      if (!way_.points.empty()) {
        const WayPoint& last = way_.points.back();
        along = last.along + norm(center - last.center);
        if (!is_gate && center == last.center) continue;
      }
      const SphereId nearest = nearest_to(p.place);
      way_.points.push_back({.center = center,
                             .along = along,
                             .radius = scale_.radius(p.clearance),
                             .nearest = nearest,
                             .is_gate = is_gate});
      way_.spheres.push_back(nearest);
    }
  }

  SphereId nearest_to(const Vec3d& place) const {
    const auto gap = [&](const Sphere& s) { return norm(place - s.center) - s.radius; };
    const auto& balls = graph_.base.balls;
    return graph_.base
        .ids[static_cast<std::size_t>(std::ranges::min_element(balls, {}, gap) - balls.begin())];
  }

  const ClearanceGraph& graph_;
  const GraphScale scale_;
  WayOut way_;
};

// The largest probe, Å, that gets to the outside from the summit above `from`; at most the one that
// fits on the summit. Infinite if the climb from `from` ends outside.
double bottleneck_from(const SphereSet& atoms, const Vec3d& from, Monitor* monitor,
                       std::uint64_t memory_limit) {
  const PowerTriangulation t = triangulate(atoms, monitor, std::nullopt, memory_limit);
  const double scale = std::ldexp(1.0, t.scale_exponent);
  const auto summit = climb_clearance(t.balls, 1 / scale * from);
  if (!summit) return std::numeric_limits<double>::infinity();
  const auto found = escape_clearances(t, {*summit}, monitor).front();
  // A negative clearance shrinks the spheres, until the smallest has no radius left.
  if (!found) throw InvalidInput("there is no way to the outside before a sphere vanishes");
  return scale * *found;
}

}  // namespace

WayOut way_out(const SphereSet& atoms, const Vec3d& from, double outside_probe, Monitor* monitor,
               std::uint64_t memory_limit) {
  if (std::ranges::any_of(atoms.spheres(), [&](const Sphere& s) { return s.center == from; })) {
    throw InvalidInput("a way cannot begin in the centre of a sphere; take a place beside it");
  }
  // Å: the graph begins below the bottleneck by more than the error of its search, and spans a
  // range even if the bottleneck is as wide as the outer probe.
  constexpr double kBelow = 1e-3, kLeastRange = 1;
  const double bottleneck = bottleneck_from(atoms, from, monitor, memory_limit);
  const std::vector<Sphere> balls(atoms.spheres().begin(), atoms.spheres().end());
  for (;;) {
    const double lowest = std::min(bottleneck, outside_probe - kLeastRange) - kBelow;
    check_range(atoms, lowest, outside_probe);
    const std::vector<Vec3d> starts{from};
    const ClearanceGraph graph = clearance_graph(
        grown(atoms.spheres(), lowest), outside_probe - lowest, starts, monitor, memory_limit);
    const double scale = std::ldexp(1.0, graph.base.scale_exponent);
    const double ceiling = (outside_probe - lowest) / scale;
    const std::vector<TreeEdge> edges = edges_to_outside(graph, graph.start_nodes[0]);
    // A closed place where the outer probe fits is one node for all its summits (nodes 1 to
    // `large`), so the tree has no way through it. Twice the probe fits in fewer of them, and in
    // the end in none.
    const auto is_large = [&](std::uint32_t node) {
      return node != kOutsideNode && node <= graph.large;
    };
    const bool passes_large =
        is_large(graph.start_nodes[0]) ||
        std::ranges::any_of(edges, [&](const TreeEdge& e) { return is_large(e.to); });
    if (!passes_large) {
      std::vector<ClearPlace> start;
      climb_clearance(graph.base.balls, 1 / scale * from, ceiling, &start);
      return WayMaker(graph, lowest).run(start, edges, ceiling);
    }
    outside_probe *= 2;
  }
}

Vec3d place_beside(const SphereSet& atoms, SphereId sphere) {
  const PowerTriangulation t = triangulate(atoms);
  const double scale = std::ldexp(1.0, t.scale_exponent);
  std::optional<ClearPlace> best;
  for (std::uint32_t c = 0; c < t.cells.size(); ++c) {
    const auto& v = t.cells[c];
    if (!is_finite_cell(t, c)) continue;
    if (std::ranges::none_of(v, [&](std::uint32_t i) { return t.ids[i] == sphere; })) continue;
    const std::array<Sphere, 4> balls{t.balls[v[0]], t.balls[v[1]], t.balls[v[2]], t.balls[v[3]]};
    const Vec3d place = balls[0].center + orthogonal_center(balls);
    const double clearance = clearance_at(t.balls, place);
    if (scale * clearance > kOutsideProbe) continue;  // this place counts as outside
    if (!best || clearance > best->clearance) best = {place, clearance};
  }
  if (!best) throw InvalidInput("beside that sphere there is no place between spheres");
  return scale * best->place;
}

}  // namespace vdwmesh

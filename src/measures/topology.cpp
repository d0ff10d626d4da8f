// union_topology(): components, voids and tunnels, and the area and volume of every shell.
//
// 1. Components of the union are the connected components of the complex's graph (union-find).
// 2. "Regions" are the components of the complement. They are found by union-find over the cells
//    outside the complex. The outer region has the number kOuter; the cells at the auxiliary
//    points far outside all balls belong to it. All other regions are voids.
// 3. The surfaces of voids are measured cell by cell. The outer surfaces have the remaining area.
// 4. A region and a component that touch have exactly one shell in common, a connected piece of the
//    boundary. So regions and components are the nodes of a tree whose edges are the shells. Its
//    root is the outer region. The volume inside a shell is the sum over the subtree below it.
#include "measures/topology.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "complex/simplex_shape.hpp"
#include "core/disjoint_sets.hpp"
#include "core/fixed_blocks.hpp"
#include "core/sum.hpp"

namespace vdwmesh {
namespace {

constexpr std::uint32_t kOuter = 0;

// A partition into numbered sets.
struct Labels {
  std::vector<std::uint32_t> of;  // number of each element's set; kNoIndex: in none
  std::uint32_t count = 0;        // numbers go from 0 to count - 1
};

// Components of the union, for each ball in the complex. Components are numbered in the order of
// their lowest balls. The representative of a set in DisjointSets is its lowest member, so it is
// labelled before the other members.
Labels label_components(const DualComplex& complex) {
  const std::size_t n = complex.in_complex.size();
  DisjointSets sets(n);
  for (const DualEdge& e : complex.edges) sets.join(e.vertices[0], e.vertices[1]);
  Labels labels{std::vector<std::uint32_t>(n, kNoIndex), 0};
  for (std::uint32_t v = 0; v < n; ++v) {
    if (!complex.in_complex[v]) continue;
    const std::uint32_t root = sets.find(v);
    labels.of[v] = root == v ? labels.count++ : labels.of[root];
  }
  return labels;
}

// Regions, for each cell outside the complex. Two such cells are connected if their common facet is
// not in the complex. All cells with an auxiliary vertex are connected, so the first one names the
// outer region, number 0. The others follow in the order of their lowest cells.
Labels label_complement(const PowerTriangulation& t, const DualComplex& complex) {
  const std::size_t n = t.cells.size();
  DisjointSets sets(n);  // threads may join at the same time
  for_each_index(n, [&](std::size_t c) {
    if (complex.cell_in_complex[c]) return;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t other = t.neighbors[c][k];
      if (other != kNoIndex && other > c && complex.cell_triangles[c][k] == kNoIndex) {
        sets.join(static_cast<std::uint32_t>(c), other);
      }
    }
  });
  const auto is_outer = [&](const std::array<std::uint32_t, 4>& cell) {
    return std::any_of(cell.begin(), cell.end(), [&](std::uint32_t v) { return !t.is_ball(v); });
  };
  const auto outer = std::find_if(t.cells.begin(), t.cells.end(), is_outer);
  const std::uint32_t outer_root = sets.find(static_cast<std::uint32_t>(outer - t.cells.begin()));
  Labels labels{std::vector<std::uint32_t>(n, kNoIndex), 1};
  for (std::uint32_t c = 0; c < n; ++c) {
    if (complex.cell_in_complex[c]) continue;
    const std::uint32_t root = sets.find(c);
    if (root == outer_root) {
      labels.of[c] = kOuter;
    } else {
      labels.of[c] = root == c ? labels.count++ : labels.of[root];
    }
  }
  return labels;
}

// The shell between a region and a component of the union.
struct ShellMeasures {
  WideSum area;
  bool is_void = false;  // the component surrounds the region, not the other way round
  double enclosed = 0;   // volume inside the shell, with everything in there
};
using ShellTable =
    std::map<std::pair<std::uint32_t, std::uint32_t>, ShellMeasures>;  // key: region, component

class ShellFinder {
 public:
  ShellFinder(const PowerTriangulation& t, const DualComplex& complex,
              const std::vector<SphereMeasures>& measures)
      : t_(t),
        complex_(complex),
        measures_(measures),
        components_(label_components(complex)),
        regions_(label_complement(t, complex)),
        void_volume_(regions_.count),
        deepest_(regions_.count),
        lining_(regions_.count) {}

  UnionTopology run() {
    measure_voids();
    measure_outside();
    enclose();
    return summary();
  }

 private:
  // The largest orthogonal sphere of a void's cells. Its centre lies in the void: if it lay beyond
  // a facet of its cell, the neighbour across that facet, which belongs to the same void, would
  // have a larger one. So the power to the nearest ball is greatest there (Edelsbrunner, Facello
  // and Liang 1998, "On the definition and the construction of pockets in macromolecules").
  struct DeepestPoint {
    double squared_radius = -1;  // none yet: outside the complex it is 0 or more but for rounding
    Vec3d center{};
  };

  // A void is the union of its cells without the parts of balls in them. The part of a ball in a
  // cell is a spherical sector: a cone from its centre over area r² Ω. If balls overlap, the
  // sectors are corrected at edges and corners.
  void measure_voids() {
    if (regions_.count == 1) return;
    collect_void_edges();
    for (std::uint32_t c = 0; c < t_.cells.size(); ++c) {
      if (is_void_cell(c)) add_void_cell(c);
    }
  }

  // Adds area of ball v to its shell with the region. The sector between the area and the centre,
  // of volume area * r / 3, is not void. A negative area takes back what sectors counted too much.
  void add_area(std::uint32_t region, std::uint32_t v, double area) {
    shells_[{region, components_.of[v]}].area.add(area);
    in_voids_.push_back({v, area});
    void_volume_[region].add(-area * t_.balls[v].radius / 3);
  }

  void add_void_cell(std::uint32_t c) {
    const auto& v = t_.cells[c];
    const std::uint32_t region = regions_.of[c];
    const TetrahedronShape shape =
        tetrahedron_shape({t_.balls[v[0]], t_.balls[v[1]], t_.balls[v[2]], t_.balls[v[3]]});
    void_volume_[region].add(shape.volume);
    note_depth(region, v);
    for (const std::uint32_t ball : v) {
      if (complex_.exposed[ball]) lining_[region].push_back(ball);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      if (!complex_.in_complex[v[k]]) continue;
      const double r = t_.balls[v[k]].radius;
      add_area(region, v[k], r * r * shape.solid_angle[k]);
    }
    for (std::size_t p = 0; p < 6; ++p) {
      add_sector(region, v[kPairs[p][0]], v[kPairs[p][1]], shape.dihedral[p]);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      // The cell is outside, so a facet in the complex has an exposed corner on its side.
      const std::uint32_t facet = complex_.cell_triangles[c][k];
      if (facet != kNoIndex) add_corner(region, facet);
    }
  }

  // `v` has the vertices of a cell of the region.
  void note_depth(std::uint32_t region, const std::array<std::uint32_t, 4>& v) {
    const Sphere& first = t_.balls[v[0]];
    const Vec3d offset = orthogonal_center({first, t_.balls[v[1]], t_.balls[v[2]], t_.balls[v[3]]});
    const double squared_radius = squared_norm(offset) - first.radius * first.radius;
    if (!(squared_radius > deepest_[region].squared_radius)) return;  // NaN is not taken either
    deepest_[region] = {squared_radius, first.center + offset};
  }

  // Corrects for the circle of edge ab, if ab is in the complex, over an angle φ about the edge.
  // Its plane is at the height h over the ball's centre, ρ is its radius.
  // 1. The sectors of both balls have counted a piece of their caps in the other ball, of area
  //    φ r (r - h): it is taken back with the sector under it.
  // 2. The double cone from the circle's disk to both centres, of volume φ ρ² length / 6, is not
  //    void either.
  // A negative angle takes this back.
  void add_sector(std::uint32_t region, std::uint32_t a, std::uint32_t b, double angle) {
    if (!is_edge(a, b)) return;
    const EdgeShape shape = edge_shape(t_.balls[a], t_.balls[b]);
    const std::array<std::uint32_t, 2> ends{a, b};
    for (std::size_t k = 0; k < 2; ++k) {
      const double r = t_.balls[ends[k]].radius;
      add_area(region, ends[k], -angle * r * (r - shape.height[k]));
    }
    void_volume_[region].add(-angle * shape.squared_circle_radius * shape.length / 6);
  }

  // Corrects for an exposed corner: the tetrahedron of the three centres and the corner lies in the
  // balls, so its volume is not void. Its solid angles are taken from the sectors, and its dihedral
  // angles at the triangle's edges from the angles of the circles, because nothing in it is on the
  // boundary. Its other three edges, to the corner, are no edges of the complex.
  void add_corner(std::uint32_t region, std::uint32_t triangle) {
    const DualTriangle& f = complex_.triangles[triangle];
    const std::array<Sphere, 3> s{t_.balls[f.vertices[0]], t_.balls[f.vertices[1]],
                                  t_.balls[f.vertices[2]]};
    const CornerShape corner = corner_shape(s[0], s[1], s[2], triangle_shape(s[0], s[1], s[2]));
    void_volume_[region].add(-corner.volume);
    for (std::size_t k = 0; k < 3; ++k) {
      const double r = s[k].radius;
      add_area(region, f.vertices[k], -r * r * corner.solid_angle[k]);
      add_sector(region, f.vertices[(k + 1) % 3], f.vertices[(k + 2) % 3], -corner.dihedral[k]);
    }
  }

  // Collects the edges of the complex between balls that are vertices of void cells, as sorted keys
  // for is_edge().
  void collect_void_edges() {
    std::vector<std::uint8_t> at_void(t_.balls.size(), 0);
    for (std::uint32_t c = 0; c < t_.cells.size(); ++c) {
      if (!is_void_cell(c)) continue;
      for (const std::uint32_t v : t_.cells[c]) at_void[v] = 1;
    }
    for (const DualEdge& e : complex_.edges) {
      const auto& [a, b] = e.vertices;
      if (at_void[a] && at_void[b]) void_edges_.push_back(key(a, b));
    }
    std::sort(void_edges_.begin(), void_edges_.end());
  }

  bool is_void_cell(std::uint32_t c) const {
    return regions_.of[c] != kNoIndex && regions_.of[c] != kOuter;
  }
  // Whether ab is an edge of the complex. Answers for vertices of void cells only.
  bool is_edge(std::uint32_t a, std::uint32_t b) const {
    return std::binary_search(void_edges_.begin(), void_edges_.end(), key(a, b));
  }
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    return (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
  }

  // The outer surface of a component has the area of its balls at cells of the outer region, less
  // the area that they show to voids. A component that has no such ball is inside a void, so it has
  // no shell with the outer region.
  void measure_outside() {
    std::vector<std::uint8_t> outside(t_.balls.size(), 0);
    for (std::uint32_t c = 0; c < t_.cells.size(); ++c) {
      if (regions_.of[c] != kOuter) continue;
      for (const std::uint32_t v : t_.cells[c]) {
        if (t_.is_ball(v)) outside[v] = complex_.in_complex[v];
      }
    }
    std::vector<double> seen_in_voids(t_.balls.size(), 0);
    for (const auto& [v, area] : in_voids_) seen_in_voids[v] += area;
    std::vector<WideSum> area(components_.count);
    std::vector<std::uint8_t> touches(components_.count, 0);
    for (std::uint32_t v = 0; v < t_.balls.size(); ++v) {
      if (!outside[v]) continue;
      touches[components_.of[v]] = 1;
      area[components_.of[v]].add(measures_[v].area - seen_in_voids[v]);
    }
    for (std::uint32_t x = 0; x < components_.count; ++x) {
      if (touches[x]) shells_[{kOuter, x}].area = area[x];
    }
  }

  // Builds the tree of regions and components, rooted at the outer region, by breadth-first search.
  // Then, in reverse order, every node adds its volume, which by then includes its children's, to
  // its parent, and stores it as the volume inside the shell between them. The shell belongs to a
  // void if the node is a region. Node numbers: region r is r, component x is regions + x.
  void enclose() {
    const std::uint32_t regions = regions_.count, nodes = regions + components_.count;
    std::vector<WideSum> own(nodes);
    for (std::uint32_t r = 0; r < regions; ++r) own[r] = void_volume_[r];
    for (std::uint32_t v = 0; v < t_.balls.size(); ++v) {
      if (complex_.in_complex[v]) own[regions + components_.of[v]].add(measures_[v].volume);
    }
    std::vector<std::vector<std::uint32_t>> adjacent(nodes);
    for (const auto& [pair, unused] : shells_) {
      adjacent[pair.first].push_back(regions + pair.second);
      adjacent[regions + pair.second].push_back(pair.first);
    }
    std::vector<std::uint32_t> order{kOuter}, parent(nodes, kNoIndex);
    for (std::size_t i = 0; i < order.size(); ++i) {
      for (const std::uint32_t next : adjacent[order[i]]) {
        if (next == parent[order[i]]) continue;
        parent[next] = order[i];
        order.push_back(next);
      }
    }
    for (std::size_t i = order.size() - 1; i > 0; --i) {
      const std::uint32_t node = order[i], up = parent[node];
      const double enclosed = own[node].value();
      own[up].add(own[node]);
      const bool is_void = node < regions;
      ShellMeasures& shell =
          shells_[is_void ? std::pair{node, up - regions} : std::pair{up, node - regions}];
      shell.is_void = is_void;
      shell.enclosed = std::max(0.0, enclosed);
    }
  }

  // Betti numbers from Euler's formula: components - tunnels + voids = χ = V - E + F - T.
  UnionTopology summary() const {
    UnionTopology out{};
    const auto count = [](const auto& items) { return static_cast<std::int64_t>(items.size()); };
    const std::int64_t vertices =
        std::count(complex_.in_complex.begin(), complex_.in_complex.end(), std::uint8_t{1});
    const std::int64_t euler =
        vertices - count(complex_.edges) + count(complex_.triangles) - count(complex_.tetrahedra);
    out.components = components_.count;
    out.voids = regions_.count - 1;
    out.tunnels =
        static_cast<std::uint64_t>(components_.count + std::int64_t{regions_.count} - 1 - euler);
    out.euler_characteristic = 2 * euler;  // of the boundary: twice that of the union
    out.point_contacts = complex_.point_contacts;
    out.hidden_spheres = static_cast<std::uint64_t>(
        std::count(complex_.exposed.begin(), complex_.exposed.end(), std::uint8_t{0}));
    add_shells(out);
    return out;
  }

  // Adds the shells, outer surfaces before voids, whose volume is negative: the normal points in.
  // Either kind is sorted by falling absolute volume.
  void add_shells(UnionTopology& out) const {
    WideSum outer_area, void_area, void_volume;
    std::vector<Shell> voids;
    for (const auto& [pair, shell] : shells_) {
      const double area = shell.area.value();
      if (shell.is_void) {
        voids.push_back({area, -shell.enclosed});
        void_area.add(area);
      } else {
        out.shells.push_back({area, shell.enclosed});
        outer_area.add(area);
      }
    }
    for (std::uint32_t r = 1; r < regions_.count; ++r) void_volume.add(void_volume_[r]);
    const auto larger = [](const Shell& a, const Shell& b) {
      return std::abs(a.volume) > std::abs(b.volume);
    };
    std::stable_sort(out.shells.begin(), out.shells.end(), larger);
    std::stable_sort(voids.begin(), voids.end(), larger);
    out.shells.insert(out.shells.end(), voids.begin(), voids.end());
    add_void_table(out);
    out.outer_area = outer_area.value();
    out.void_area = void_area.value();
    out.void_volume = void_volume.value();
  }

  void add_void_table(UnionTopology& out) const {
    for (std::uint32_t r = 1; r < regions_.count; ++r) {
      WideSum area;
      for (auto shell = shells_.lower_bound({r, 0}); shell != shells_.end(); ++shell) {
        if (shell->first.first != r) break;
        area.add(shell->second.area);
      }
      Void v{.area = area.value(),
             .volume = void_volume_[r].value(),
             .center = deepest_[r].center,
             .clearance = std::numeric_limits<double>::infinity(),
             .lining = lining_[r]};
      std::ranges::sort(v.lining);
      const auto repeated = std::ranges::unique(v.lining);
      v.lining.erase(repeated.begin(), repeated.end());
      for (const std::uint32_t ball : v.lining) {
        const Sphere& s = t_.balls[ball];
        v.clearance = std::min(v.clearance, norm(s.center - v.center) - s.radius);
      }
      out.void_table.push_back(std::move(v));
    }
    std::ranges::stable_sort(out.void_table, std::ranges::greater{}, &Void::volume);
  }

  const PowerTriangulation& t_;
  const DualComplex& complex_;
  const std::vector<SphereMeasures>& measures_;
  Labels components_, regions_;
  // Per region; the outer region has none of these.
  std::vector<WideSum> void_volume_;
  std::vector<DeepestPoint> deepest_;
  std::vector<std::vector<std::uint32_t>> lining_;  // exposed balls of its cells, some repeatedly
  ShellTable shells_;
  std::vector<std::pair<std::uint32_t, double>> in_voids_;  // ball, a term of its area in voids
  std::vector<std::uint64_t> void_edges_;                   // sorted keys, see key()
};

}  // namespace

UnionTopology union_topology(const PowerTriangulation& triangulation, const DualComplex& complex,
                             const std::vector<SphereMeasures>& measures) {
  return ShellFinder(triangulation, complex, measures).run();
}

}  // namespace vdwmesh

#include "arrangement/complex/dual_complex.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "arrangement/complex/power_predicates.hpp"

namespace vdwmesh {
namespace {

// Pairs of vertices of a cell, and the pairs on the facet opposite to each vertex as a mask.
constexpr std::array<std::array<std::uint8_t, 2>, 6> kPairs{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
constexpr std::uint8_t kAllPairs = 63;
constexpr std::array<std::uint8_t, 4> kFacetPairs{{0b111000, 0b100110, 0b010101, 0b001011}};

bool contains(std::uint8_t mask, std::uint8_t bits) { return (mask & bits) == bits; }

std::size_t slot_of(const std::array<std::uint32_t, 4>& cell, std::uint32_t vertex) {
  return static_cast<std::size_t>(std::find(cell.begin(), cell.end(), vertex) - cell.begin());
}

// Edges by their two vertices. Buckets follow the vertices' order, so that edges near in space are
// near in memory, and a vertex of thousands of edges has them in as many buckets.
class EdgeTable {
 public:
  explicit EdgeTable(std::size_t vertices)
      : first_(std::bit_ceil(kBucketsPerVertex * vertices), kNoIndex) {}

  std::uint32_t find(std::uint32_t a, std::uint32_t b) const {
    if (a > b) std::swap(a, b);
    std::uint32_t e = first_[bucket(a, b)];
    while (e != kNoIndex && (links_[e].lower != a || links_[e].upper != b)) e = links_[e].next;
    return e;
  }
  std::uint32_t add(std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    const auto e = static_cast<std::uint32_t>(links_.size());
    std::uint32_t& first = first_[bucket(a, b)];
    links_.push_back({a, b, first});
    first = e;
    return e;
  }

 private:
  static constexpr std::size_t kBucketsPerVertex = 8;
  struct Link {
    std::uint32_t lower, upper, next;
  };
  std::size_t bucket(std::size_t a, std::size_t b) const {
    return (8 * a + 5 * b) & (first_.size() - 1);
  }

  std::vector<std::uint32_t> first_;  // per bucket, a power of two of them
  std::vector<Link> links_;
};

class Builder {
 public:
  explicit Builder(const PowerTriangulation& triangulation)
      : t_(triangulation), table_(triangulation.balls.size()) {
    out_.in_complex.assign(t_.balls.size(), 0);
    out_.exposed.assign(t_.balls.size(), 0);
    strict_.assign(t_.balls.size(), 0);
    overlaps_.resize(t_.cells.size());
    out_.cell_in_complex.resize(t_.cells.size());
    out_.cell_triangles.resize(t_.cells.size());
  }

  DualComplex build() && {
    for (std::uint32_t c = 0; c < t_.cells.size(); ++c) classify_cell(c);
    for (std::uint32_t c = 0; c < t_.cells.size(); ++c) classify_facets(c);
    for (std::uint32_t c = 0; c < t_.cells.size(); ++c) classify_edges(c);
    classify_vertices();
    mark_exposed();
    count_contacts();
    return std::move(out_);
  }

 private:
  // Pairs whose balls may meet: a floating-point sieve, wide enough never to lose one.
  std::uint8_t overlapping_pairs(const std::array<std::uint32_t, 4>& cell) const {
    constexpr double kSlack = 1 + 0x1p-40, kTiny = 1e-280;  // squares below it may be nothing
    std::uint8_t mask = 0;
    for (std::size_t p = 0; p < 6; ++p) {
      const std::uint32_t i = cell[kPairs[p][0]], j = cell[kPairs[p][1]];
      if (!t_.is_ball(i) || !t_.is_ball(j)) continue;
      const Sphere &a = t_.balls[i], &b = t_.balls[j];
      const double reach = a.radius + b.radius;
      if (!(squared_norm(b.center - a.center) > kSlack * reach * reach + kTiny)) {
        mask = static_cast<std::uint8_t>(mask | (1u << p));
      }
    }
    return mask;
  }

  const Sphere& ball(std::uint32_t i) const { return t_.balls[i]; }

  void mark_strict(const std::array<std::uint32_t, 4>& cell, std::size_t skipped) {
    for (std::size_t k = 0; k < 4; ++k) {
      if (k != skipped) strict_[cell[k]] = 1;
    }
  }

  void classify_cell(std::uint32_t c) {
    const auto& v = t_.cells[c];
    overlaps_[c] = overlapping_pairs(v);
    out_.cell_triangles[c].fill(kNoIndex);
    out_.cell_in_complex[c] = 0;
    if (overlaps_[c] != kAllPairs) return;
    const Sign size = size_sign(ball(v[0]), ball(v[1]), ball(v[2]), ball(v[3]));
    if (size == Sign::positive) return;
    out_.cell_in_complex[c] = 1;
    out_.tetrahedra.push_back(c);
    if (size == Sign::negative) mark_strict(v, 4);
  }

  // Whether the triangle opposite to vertex k is in the complex by itself, not through a cell; if
  // so and strict, its vertices are.
  bool is_free_triangle(std::uint32_t c, std::size_t k) {
    const auto& cell = t_.cells[c];
    const auto& f = kFacetVertices[k];
    const Sphere &p = ball(cell[f[0]]), &q = ball(cell[f[1]]), &r = ball(cell[f[2]]);
    const Sign size = size_sign(p, q, r);
    if (size == Sign::positive) return false;
    const std::uint32_t n = t_.neighbors[c][k];
    for (const std::uint32_t apex : {cell[k], opposite(n, c)}) {
      if (t_.is_ball(apex) && side_sign(p, q, r, ball(apex)) == Sign::negative) return false;
    }
    if (size == Sign::negative) mark_strict(cell, k);
    return true;
  }

  // Vertex of cell n that faces cell c.
  std::uint32_t opposite(std::uint32_t n, std::uint32_t c) const {
    return t_.cells[n][slot_of(t_.neighbors[n], c)];
  }

  void classify_facets(std::uint32_t c) {
    if (overlaps_[c] == 0) return;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t n = t_.neighbors[c][k];
      if (n == kNoIndex || n < c || !contains(overlaps_[c], kFacetPairs[k])) continue;
      const bool exposed0 = !out_.cell_in_complex[c], exposed1 = !out_.cell_in_complex[n];
      if (exposed0 && exposed1 && !is_free_triangle(c, k)) continue;
      add_triangle(c, k, n, {exposed0, exposed1});
    }
  }

  void add_triangle(std::uint32_t c, std::size_t k, std::uint32_t n, std::array<bool, 2> exposed) {
    const auto id = static_cast<std::uint32_t>(out_.triangles.size());
    out_.cell_triangles[c][k] = id;
    out_.cell_triangles[n][slot_of(t_.neighbors[n], c)] = id;
    DualTriangle triangle{};
    for (std::size_t m = 0; m < 3; ++m) triangle.vertices[m] = t_.cells[c][kFacetVertices[k][m]];
    triangle.cells = {c, n};
    triangle.exposed = exposed;
    for (std::size_t m = 0; m < 3; ++m) {
      triangle.edges[m] = edge(triangle.vertices[(m + 1) % 3], triangle.vertices[(m + 2) % 3]);
      DualEdge& e = out_.edges[triangle.edges[m]];
      e.exposed = e.exposed || exposed[0] || exposed[1];
      e.singular = false;
    }
    out_.triangles.push_back(triangle);
  }

  std::uint32_t edge(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t found = table_.find(a, b);
    return found != kNoIndex ? found : add_edge(a, b, Contact::strict);
  }

  std::uint32_t add_edge(std::uint32_t a, std::uint32_t b, Contact contact) {
    const std::uint32_t id = table_.add(a, b);
    out_.edges.push_back({{std::min(a, b), std::max(a, b)}, contact, false, false});
    out_.in_complex[a] = out_.in_complex[b] = 1;
    return id;
  }

  // Pairs of the cell that are on none of its facets in the complex: edges without triangles.
  void classify_edges(std::uint32_t c) {
    std::uint8_t open = overlaps_[c];
    for (std::size_t k = 0; k < 4; ++k) {
      if (out_.cell_triangles[c][k] != kNoIndex) {
        open = static_cast<std::uint8_t>(open & ~kFacetPairs[k]);
      }
    }
    for (std::size_t p = 0; open != 0 && p < 6; ++p) {
      if (!contains(open, static_cast<std::uint8_t>(1u << p))) continue;
      classify_edge(c, t_.cells[c][kPairs[p][0]], t_.cells[c][kPairs[p][1]]);
    }
  }

  void classify_edge(std::uint32_t c, std::uint32_t a, std::uint32_t b) {
    if (table_.find(a, b) != kNoIndex || !is_lowest_around(c, a, b)) return;
    const Sign size = size_sign(ball(a), ball(b));
    if (size == Sign::positive || is_attached(c, a, b)) return;
    DualEdge& e =
        out_.edges[add_edge(a, b, size == Sign::negative ? Contact::strict : Contact::touching)];
    e.exposed = e.singular = true;
    if (size == Sign::negative) strict_[a] = strict_[b] = 1;
  }

  // Visits the cells around edge ab from cell c on, until the visitor says false.
  template <class Visitor>
  bool around_edge(std::uint32_t c, std::uint32_t a, std::uint32_t b, Visitor visit) const {
    std::uint32_t current = c, from = kNoIndex;
    do {
      const auto& cell = t_.cells[current];
      std::array<std::size_t, 2> link{};
      std::size_t n = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        if (cell[k] != a && cell[k] != b) link[n++] = k;
      }
      if (!visit(current, cell[link[0]], cell[link[1]])) return false;
      const std::size_t exit = cell[link[0]] == from || from == kNoIndex ? link[0] : link[1];
      from = cell[exit == link[0] ? link[1] : link[0]];
      current = t_.neighbors[current][exit];
    } while (current != c);
    return true;
  }

  bool is_lowest_around(std::uint32_t c, std::uint32_t a, std::uint32_t b) const {
    return around_edge(c, a, b,
                       [&](std::uint32_t d, std::uint32_t, std::uint32_t) { return d >= c; });
  }

  bool is_attached(std::uint32_t c, std::uint32_t a, std::uint32_t b) const {
    return !around_edge(c, a, b, [&](std::uint32_t, std::uint32_t x, std::uint32_t y) {
      const auto clear = [&](std::uint32_t d) {
        return !t_.is_ball(d) || side_sign(ball(a), ball(b), ball(d)) != Sign::negative;
      };
      return clear(x) && clear(y);
    });
  }

  // Vertices without edges are in the complex where their own centre is in their power cell; so
  // are strict those that only touching simplices hold.
  void classify_vertices() {
    std::vector<std::uint8_t> attached(t_.balls.size(), 1);
    for (std::uint32_t v = 0; v < t_.balls.size(); ++v) {
      if (!out_.in_complex[v] || !strict_[v]) attached[v] = 0;
    }
    std::vector<std::uint8_t> seen(t_.balls.size(), 0);
    for (const auto& cell : t_.cells) {
      for (const std::uint32_t v : cell) {
        if (!t_.is_ball(v)) continue;
        seen[v] = 1;
        if (!attached[v]) attached[v] = has_closer_ball(cell, v);
      }
    }
    bool doubtful = false;
    for (std::uint32_t v = 0; v < t_.balls.size(); ++v) {
      if (seen[v] && !attached[v]) out_.in_complex[v] = strict_[v] = 1;
      doubtful = doubtful || (out_.in_complex[v] && !strict_[v]);
    }
    if (doubtful) find_strict_faces();
  }

  // Triangles and edges may be strict by themselves though every simplex on them only touches.
  void find_strict_faces() {
    for (std::uint32_t c = 0; c < t_.cells.size(); ++c) {
      const auto& v = t_.cells[c];
      for (std::size_t k = 0; k < 4; ++k) {
        if (out_.cell_triangles[c][k] == kNoIndex) continue;
        const auto& f = kFacetVertices[k];
        if (!strict_[v[f[0]]] || !strict_[v[f[1]]] || !strict_[v[f[2]]]) is_free_triangle(c, k);
      }
      for (const auto& pair : kPairs) find_strict_edge(c, v[pair[0]], v[pair[1]]);
    }
  }

  void find_strict_edge(std::uint32_t c, std::uint32_t a, std::uint32_t b) {
    if (!t_.is_ball(a) || !t_.is_ball(b) || (strict_[a] && strict_[b])) return;
    if (table_.find(a, b) == kNoIndex || size_sign(ball(a), ball(b)) != Sign::negative) return;
    if (!is_attached(c, a, b)) strict_[a] = strict_[b] = 1;
  }

  bool has_closer_ball(const std::array<std::uint32_t, 4>& cell, std::uint32_t v) const {
    return std::any_of(cell.begin(), cell.end(), [&](std::uint32_t d) {
      return d != v && t_.is_ball(d) && side_sign(ball(v), ball(d)) == Sign::negative;
    });
  }

  // Area is exposed where it is so for balls a little smaller and a little larger.
  void mark_exposed() {
    for (std::uint32_t c = 0; c < t_.cells.size(); ++c) {
      if (out_.cell_in_complex[c]) continue;
      for (const std::uint32_t v : t_.cells[c]) {
        if (t_.is_ball(v)) out_.exposed[v] = out_.in_complex[v] && strict_[v];
      }
    }
  }

  void count_contacts() {
    for (const DualEdge& e : out_.edges) {
      const bool touching = e.singular && e.contact == Contact::touching;
      out_.point_contacts +=
          touching && plane_between_centers(ball(e.vertices[0]), ball(e.vertices[1]));
    }
  }

  const PowerTriangulation& t_;
  DualComplex out_;
  EdgeTable table_;
  std::vector<std::uint8_t> strict_;    // per ball: still in the complex of balls a little smaller
  std::vector<std::uint8_t> overlaps_;  // per cell: pairs whose balls may meet
};

}  // namespace

DualComplex dual_complex(const PowerTriangulation& triangulation) {
  return Builder(triangulation).build();
}

}  // namespace vdwmesh

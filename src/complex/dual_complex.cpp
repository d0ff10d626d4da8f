// dual_complex(): decides for every simplex of the triangulation whether it is in the complex.
//
// The size of a simplex is the squared radius of the smallest sphere orthogonal to its balls;
// size_sign() gives its sign. The power of a point with respect to a ball is its squared distance
// from the ball's centre less the squared radius. The simplex is attached if the power of that
// sphere's centre is less with respect to a neighbouring ball d than with respect to the simplex's
// own balls: side_sign(..., d) is negative.
// By the rule for alpha complexes (Edelsbrunner and Mücke 1994, "Three-dimensional alpha shapes",
// here weighted and with alpha = 0), a simplex is in the complex if
// - it is a face of a larger simplex of the complex, or
// - it is "free": it is not attached and its size is <= 0.
// ComplexBuilder goes from tetrahedra to triangles, edges and vertices. Signs are exact. Most
// simplices are rejected before an exact predicate is needed, because two of their balls are far
// apart. Vertices of the triangulation for which is_ball() is false are the four auxiliary points
// far outside; they have no sphere, attach nothing and are in no simplex of the complex.
//
// A ball is strict if it remains in the complex when all balls shrink a little: it is a vertex of a
// simplex that is not attached and has a negative size. A ball that is not strict may be in the
// complex because of a simplex of size 0; it has no exposed area.
#include "complex/dual_complex.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <span>
#include <utility>

#include "complex/overlapping_pairs.hpp"
#include "complex/power_predicates.hpp"
#include "complex/regular_cells.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/order/sorted_rows.hpp"
#include "core/order/split_mix.hpp"
#include "core/steps.hpp"

namespace vdwmesh {
namespace {

// Edges, and the two sides of triangles, have numbers of 32 bits. There may be more of them than
// cells, whose number is checked when they are made.
void check_numbers(std::size_t count) {
  if (count >= kNoIndex) throw LimitExceeded("the dual complex has more than 2^32 simplices");
}

// Says that `triangle` has the edge from ball a to its upper ball, the one of higher number. The
// entry stands in row a of rows_. The entries of one edge follow each other there, by ascending
// triangle.
struct TriangleAtEdge {
  std::uint32_t upper, triangle;
  friend auto operator<=>(const TriangleAtEdge&, const TriangleAtEdge&) = default;
};

class ComplexBuilder {
 public:
  explicit ComplexBuilder(const PowerTriangulation& triangulation) : t_(triangulation) {
    out_.in_complex.assign(t_.balls.size(), 0);
    out_.exposed.assign(t_.balls.size(), 0);
    strict_.assign(t_.balls.size(), 0);
    overlaps_.resize(t_.cells.size());
    out_.cell_in_complex.resize(t_.cells.size());
    out_.cell_triangles.resize(t_.cells.size());
  }

  // Each step needs the results of all steps before it, for all cells. What is found about a cell
  // does not depend on other cells of the same step, so all cores find it; triangles and edges are
  // then numbered in the order of their vertices.
  DualComplex build(Monitor* monitor) && {
    monitor_ = monitor;
    for_each_cell([&](std::uint32_t c) { classify_cell(c); });
    out_.tetrahedra = collect_from_cells<std::uint32_t>(
        monitor, [&](std::uint32_t c, std::vector<std::uint32_t>& tetrahedra) {
          if (out_.cell_in_complex[c]) tetrahedra.push_back(c);
        });
    const auto facets = collect_from_cells<CellFacet>(
        monitor,
        [&](std::uint32_t c, std::vector<CellFacet>& found) { classify_facets(c, found); });
    add_triangles(facets);
    add_edges(collect_from_cells<DualEdge>(
        monitor, [&](std::uint32_t c, std::vector<DualEdge>& found) { classify_edges(c, found); }));
    classify_vertices();
    mark_exposed();
    count_contacts();
    return std::move(out_);
  }

 private:
  // A triangle of the complex: opposite to vertex `slot` of `cell`.
  struct CellFacet {
    std::uint32_t cell, slot;
    friend auto operator<=>(const CellFacet&, const CellFacet&) = default;
  };
  template <class Body>
  void for_each_cell(const Body& body) const {
    for_each_index(t_.cells.size(), [&](std::size_t c) { body(static_cast<std::uint32_t>(c)); });
  }

  // Returns in the order of the cells what add(c, found) appends to `found`. Asks the monitor once
  // in some thousand cells.
  template <class Item, class Add>
  std::vector<Item> collect_from_cells(Monitor* monitor, const Add& add) const {
    return collect<Item>(
        t_.cells.size(),
        [&](std::size_t c, std::vector<Item>& found) { add(static_cast<std::uint32_t>(c), found); },
        monitor);
  }

  // Sets a flag that several threads may set at once.
  static void set(std::uint8_t& flag) { std::atomic_ref(flag).store(1, std::memory_order_relaxed); }

  const Sphere& ball(std::uint32_t i) const { return t_.balls[i]; }

  // Marks the vertices of the cell as strict, except vertex `skipped` (4: none).
  void mark_strict(const std::array<std::uint32_t, 4>& cell, std::size_t skipped) {
    for (std::size_t k = 0; k < 4; ++k) {
      if (k != skipped) set(strict_[cell[k]]);
    }
  }

  // Decides whether cell c is in the complex. If its size is 0 or less, the centre of its smallest
  // orthogonal sphere lies in all four balls, so each two of them must meet. A tetrahedron of the
  // regular triangulation is never attached: at its orthogonal centre no other ball has less power.
  void classify_cell(std::uint32_t c) {
    const auto& v = t_.cells[c];
    overlaps_[c] = overlapping_pairs(t_, v);
    out_.cell_triangles[c].fill(kNoIndex);
    out_.cell_in_complex[c] = 0;
    if (overlaps_[c] != kAllPairs) return;
    const Sign size = size_sign(ball(v[0]), ball(v[1]), ball(v[2]), ball(v[3]));
    if (size == Sign::positive) return;
    out_.cell_in_complex[c] = 1;
    if (size == Sign::negative) mark_strict(v, 4);
  }

  // Whether the triangle opposite to vertex k of cell c is free. Not only a query: if the triangle
  // is free and its size is negative, its vertices are marked strict. Only the two vertices that
  // form a cell with the triangle can make it attached.
  bool is_free_triangle(std::uint32_t c, std::size_t k) {
    const auto& cell = t_.cells[c];
    const auto& f = kFacetVertices[k];
    const Sphere &p = ball(cell[f[0]]), &q = ball(cell[f[1]]), &r = ball(cell[f[2]]);
    const Sign size = size_sign(p, q, r);
    if (size == Sign::positive) return false;
    const std::uint32_t n = t_.neighbors[c][k];
    for (const std::uint32_t apex : {cell[k], t_.apex(n, c)}) {
      if (t_.is_ball(apex) && side_sign(p, q, r, ball(apex)) == Sign::negative) return false;
    }
    if (size == Sign::negative) mark_strict(cell, k);
    return true;
  }

  // Looks at every facet once, from the cell with the lower number, and lists its triangle if that
  // is in the complex. A facet of a tetrahedron of the complex is in the complex without a test.
  // Facets on the hull (no neighbour) have auxiliary vertices only.
  void classify_facets(std::uint32_t c, std::vector<CellFacet>& found) {
    if (overlaps_[c] == 0) return;
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t n = t_.neighbors[c][k];
      if (n == kNoIndex || n < c || !contains(overlaps_[c], kFacetPairs[k])) continue;
      const bool inside = out_.cell_in_complex[c] || out_.cell_in_complex[n];
      if (inside || is_free_triangle(c, k)) found.push_back({c, k});
    }
  }

  // A facet by its vertices b < c, in the row of its lowest vertex.
  struct FacetEntry {
    std::uint32_t b, c;
    CellFacet facet;
    friend auto operator<=>(const FacetEntry&, const FacetEntry&) = default;
  };

  // The vertices of a facet, ascending, and whether that is an odd permutation of kFacetVertices.
  std::pair<std::array<std::uint32_t, 3>, bool> sorted_vertices(const CellFacet& facet) const {
    std::array<std::uint32_t, 3> v;
    for (std::size_t m = 0; m < 3; ++m) {
      v[m] = t_.cells[facet.cell][kFacetVertices[facet.slot][m]];
    }
    const bool odd = sort_is_odd(v);
    return {v, odd};
  }

  // Adds triangles, sorted by their vertices, as yet without their edges.
  void add_triangles(const std::vector<CellFacet>& facets) {
    SortedRows<FacetEntry> sorted;
    sorted.fill(t_.balls.size(), facets.size(), [&](std::size_t i, const auto& add) {
      const auto v = sorted_vertices(facets[i]).first;
      add(v[0], {v[1], v[2], facets[i]});
    });
    check_numbers(2 * facets.size());
    out_.triangles.resize(facets.size());
    for_each_index(facets.size(), [&](std::size_t i) {
      out_.triangles[i] = triangle_at(sorted.entries()[i].facet, static_cast<std::uint32_t>(i));
    });
    rows_.fill(t_.balls.size(), out_.triangles.size(), [&](std::size_t i, const auto& add) {
      const auto& v = out_.triangles[i].vertices;
      for (std::size_t m = 0; m < 3; ++m) {
        const auto [lower, upper] = std::minmax(v[(m + 1) % 3], v[(m + 2) % 3]);
        add(lower, {upper, static_cast<std::uint32_t>(i)});
      }
    });
  }

  // The triangle of a facet, as yet without its edges. Writes the triangle's number into its two
  // cells.
  DualTriangle triangle_at(const CellFacet& facet, std::uint32_t number) {
    const auto [c, k] = facet;
    const std::uint32_t n = t_.neighbors[c][k];
    out_.cell_triangles[c][k] = number;
    out_.cell_triangles[n][t_.slot_of_neighbor(n, c)] = number;
    DualTriangle triangle{};
    const auto [vertices, odd] = sorted_vertices(facet);
    triangle.vertices = vertices;
    // From vertex k of c, the order of kFacetVertices is seen counter-clockwise. From cells[0] the
    // ascending order must be: so cells[0] is c, or n if sorting was an odd permutation.
    triangle.cells = {odd ? n : c, odd ? c : n};
    for (std::size_t s = 0; s < 2; ++s) {
      triangle.exposed[s] = !out_.cell_in_complex[triangle.cells[s]];
    }
    return triangle;
  }

  // Numbers and adds all edges, sorted by their vertices. Edges from ball a to upper balls are
  // those in row a of rows_, which are in triangles, and singular ones. The edges of triangles get
  // Contact::strict without a test, because only the contact of singular edges is ever asked for.
  // It does not make their balls strict, which is what strict_ tells.
  void add_edges(const std::vector<DualEdge>& singular) {
    SortedRows<DualEdge> alone;  // per ball: its singular edges to upper balls
    alone.fill(t_.balls.size(), singular.size(),
               [&](std::size_t i, const auto& add) { add(singular[i].vertices[0], singular[i]); });
    std::vector<std::size_t> first(t_.balls.size() + 1, 0);  // by ball: number of its first edge
    for_each_index(t_.balls.size(), [&](std::size_t a) {
      std::size_t count = alone[a].size();
      for_each_edge_of(a, [&](std::span<const TriangleAtEdge>) { ++count; });
      first[a + 1] = count;
    });
    std::partial_sum(first.begin(), first.end(), first.begin());
    check_numbers(first.back());
    out_.edges.resize(first.back());
    for_each_index(t_.balls.size(), [&](std::size_t a) {
      auto number = static_cast<std::uint32_t>(first[a]);
      auto next = alone[a].begin();
      const auto add_alone_before = [&](std::uint32_t upper) {
        while (next != alone[a].end() && next->vertices[1] < upper) add_edge(number++, *next++);
      };
      for_each_edge_of(a, [&](std::span<const TriangleAtEdge> edge) {
        add_alone_before(edge[0].upper);
        add_edge_of_triangles(number++, static_cast<std::uint32_t>(a), edge);
      });
      add_alone_before(kNoIndex);
    });
  }

  void add_edge(std::uint32_t number, const DualEdge& edge) {
    out_.edges[number] = edge;
    for (const std::uint32_t v : edge.vertices) set(out_.in_complex[v]);
  }

  // Edges of one triangle may be added by several threads at once, each of which writes its own.
  void add_edge_of_triangles(std::uint32_t number, std::uint32_t a,
                             std::span<const TriangleAtEdge> edge) {
    bool exposed = false;
    for (const TriangleAtEdge& entry : edge) {
      DualTriangle& triangle = out_.triangles[entry.triangle];
      triangle.edges[edge_slot(a, entry)] = number;
      exposed = exposed || triangle.exposed[0] || triangle.exposed[1];
    }
    add_edge(number, {.vertices = {a, edge[0].upper},
                      .contact = Contact::strict,
                      .exposed = exposed,
                      .singular = false});
  }

  // Calls visit(entries) for every edge from ball a to an upper ball that a triangle has, by
  // ascending upper ball. The entries, a part of row a, are the triangles that have the edge.
  template <class Visit>
  void for_each_edge_of(std::size_t a, const Visit& visit) const {
    const auto row = rows_[a];
    for (auto begin = row.begin(); begin != row.end();) {
      const auto end = std::find_if(begin, row.end(), [&](const TriangleAtEdge& entry) {
        return entry.upper != begin->upper;
      });
      visit(std::span(begin, end));
      begin = end;
    }
  }

  // Whether ab is an edge of a triangle.
  bool is_in_triangle(std::uint32_t a, std::uint32_t b) const {
    const auto row = rows_[std::min(a, b)];
    const TriangleAtEdge first{std::max(a, b), 0};
    const auto found = std::lower_bound(row.begin(), row.end(), first);
    return found != row.end() && found->upper == first.upper;
  }

  // The place of the edge from ball a to entry.upper in the entry's triangle: edge m is opposite to
  // vertex m, so m is the vertex that is neither of the two.
  std::size_t edge_slot(std::uint32_t a, const TriangleAtEdge& entry) const {
    const auto& v = out_.triangles[entry.triangle].vertices;
    std::size_t m = 0;
    while (v[m] == a || v[m] == entry.upper) ++m;
    return m;
  }

  // Finds the edges of cell c that are in the complex but in none of its triangles. `open`: the
  // pairs whose balls may meet and that are on no triangle of the complex in this cell.
  void classify_edges(std::uint32_t c, std::vector<DualEdge>& found) {
    std::uint8_t open = overlaps_[c];
    for (std::size_t k = 0; k < 4; ++k) {
      if (out_.cell_triangles[c][k] != kNoIndex) {
        open = static_cast<std::uint8_t>(open & ~kFacetPairs[k]);
      }
    }
    for (std::size_t p = 0; open != 0 && p < 6; ++p) {
      if (!contains(open, static_cast<std::uint8_t>(1u << p))) continue;
      classify_edge(c, t_.cells[c][kPairs[p][0]], t_.cells[c][kPairs[p][1]], found);
    }
  }

  // Lists edge ab if it is free. Tests it once, from one of the cells around it. If rows_
  // has the edge, it is an edge of a triangle of the complex in another cell around it, and is
  // listed already.
  void classify_edge(std::uint32_t c, std::uint32_t a, std::uint32_t b,
                     std::vector<DualEdge>& found) {
    if (is_in_triangle(a, b) || !is_chosen_around(c, a, b)) return;
    const Sign size = size_sign(ball(a), ball(b));
    if (size == Sign::positive || is_attached(c, a, b)) return;
    found.push_back({.vertices = {std::min(a, b), std::max(a, b)},
                     .contact = size == Sign::negative ? Contact::strict : Contact::touching,
                     .exposed = true,
                     .singular = true});
    if (size != Sign::negative) return;
    set(strict_[a]);
    set(strict_[b]);
  }

  // Visits the cells around edge ab, from cell c on: visit(cell, x, y), where x and y are the other
  // two vertices of the cell. If `visit` returns false, the walk stops and returns false. It ends
  // at c, since the auxiliary points surround every ball and the cells form a closed ring.
  template <class Visitor>
  bool around_edge(std::uint32_t c, std::uint32_t a, std::uint32_t b, Visitor visit) const {
    // `from` is the one of x and y that the cell shares with the cell visited before.
    std::uint32_t current = c, from = kNoIndex;
    Steps steps(monitor_);
    do {
      steps.add(1);
      const auto& cell = t_.cells[current];
      std::array<std::size_t, 2> link{};  // positions of x and y in the cell
      std::size_t n = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        if (cell[k] != a && cell[k] != b) link[n++] = k;
      }
      if (!visit(current, cell[link[0]], cell[link[1]])) return false;
      // Leave by the facet opposite to `from`, or from the first cell by the one opposite to x.
      const std::size_t exit = cell[link[0]] == from || from == kNoIndex ? link[0] : link[1];
      from = cell[exit == link[0] ? link[1] : link[0]];
      current = t_.neighbors[current][exit];
    } while (current != c);
    return true;
  }

  // Whether a cell has the lowest of the shuffled numbers of all cells around edge ab. Then the
  // walks around an edge with n cells, one from each of them, come to n log n steps in all, since
  // most meet a lower number soon. With the numbers themselves, which often rise around an edge,
  // they would come to n².
  bool is_chosen_around(std::uint32_t c, std::uint32_t a, std::uint32_t b) const {
    const std::uint64_t own = split_mix(c);
    return around_edge(c, a, b, [&](std::uint32_t d, std::uint32_t, std::uint32_t) {
      return split_mix(d) >= own;
    });
  }

  // Whether edge ab of cell c is attached. Only the vertices x, y of cells around the edge can make
  // it so; such a vertex is clear if it does not.
  bool is_attached(std::uint32_t c, std::uint32_t a, std::uint32_t b) const {
    return !around_edge(c, a, b, [&](std::uint32_t, std::uint32_t x, std::uint32_t y) {
      const auto clear = [&](std::uint32_t d) {
        return !t_.is_ball(d) || side_sign(ball(a), ball(b), ball(d)) != Sign::negative;
      };
      return clear(x) && clear(y);
    });
  }

  // A vertex has the negative size -r². So it is free, and then strict, exactly if no neighbour
  // makes it attached, that is, if its centre is in its own power cell. The test is needed only for
  // vertices that are not yet in the complex, and for those that are there because of simplices of
  // size 0 alone. All others are known to be strict.
  void classify_vertices() {
    // 1 for vertices that are known to be strict, and later also for those found to be attached. A
    // vertex of a cell that keeps 0 is not attached, and so is strict.
    std::vector<std::uint8_t> settled(t_.balls.size(), 1);
    for (std::uint32_t v = 0; v < t_.balls.size(); ++v) {
      if (!out_.in_complex[v] || !strict_[v]) settled[v] = 0;
    }
    // 1 for vertices of cells. The other balls have no power cell, so they are not in the complex.
    std::vector<std::uint8_t> seen(t_.balls.size(), 0);
    // A copy, because other threads write `settled` while this loop reads it.
    const std::vector<std::uint8_t> was_settled = settled;
    for_each_cell([&](std::uint32_t c) {
      const auto& cell = t_.cells[c];
      for (const std::uint32_t v : cell) {
        if (!t_.is_ball(v)) continue;
        set(seen[v]);
        if (!was_settled[v] && has_closer_ball(cell, v)) set(settled[v]);
      }
    });
    bool doubtful = false;  // some ball is in the complex, but not known to be strict
    for (std::uint32_t v = 0; v < t_.balls.size(); ++v) {
      if (seen[v] && !settled[v]) out_.in_complex[v] = strict_[v] = 1;
      doubtful = doubtful || (out_.in_complex[v] && !strict_[v]);
    }
    if (doubtful) find_strict_faces();
  }

  // Faces of a simplex of the complex were added without a test, so whether they make their
  // vertices strict is not known yet: those that are not attached and have negative size do. This
  // matters for a vertex whose larger simplices have size 0.
  void find_strict_faces() {
    for (std::uint32_t c = 0; c < t_.cells.size(); ++c) {
      const auto& v = t_.cells[c];
      for (std::size_t k = 0; k < 4; ++k) {
        if (out_.cell_triangles[c][k] == kNoIndex) continue;
        const auto& f = kFacetVertices[k];
        // Called for the marks on the vertices, not for its result.
        if (!strict_[v[f[0]]] || !strict_[v[f[1]]] || !strict_[v[f[2]]]) is_free_triangle(c, k);
      }
      for (const auto& pair : kPairs) find_strict_edge(c, v[pair[0]], v[pair[1]]);
    }
  }

  // The same for edge ab of cell c, if it is in a triangle of the complex. All other edges of the
  // complex were tested.
  void find_strict_edge(std::uint32_t c, std::uint32_t a, std::uint32_t b) {
    if (!t_.is_ball(a) || !t_.is_ball(b) || (strict_[a] && strict_[b])) return;
    if (!is_in_triangle(a, b) || size_sign(ball(a), ball(b)) != Sign::negative) return;
    if (is_chosen_around(c, a, b) && !is_attached(c, a, b)) strict_[a] = strict_[b] = 1;
  }

  // Whether a ball of the cell has less power than v at the centre of v, so that v is attached.
  bool has_closer_ball(const std::array<std::uint32_t, 4>& cell, std::uint32_t v) const {
    return std::any_of(cell.begin(), cell.end(), [&](std::uint32_t d) {
      return d != v && t_.is_ball(d) && side_sign(ball(v), ball(d)) == Sign::negative;
    });
  }

  // Sets exposed[v], which says that ball v has exposed area. The ball has an exposed point if it
  // is in the complex and a cell around it is outside. A lone point vanishes if all balls shrink a
  // little, or if all grow; so there is area if ball and cell stay as they are in both cases. The
  // cell stays outside, because its size is positive or it has an auxiliary vertex. The ball stays
  // in the complex when balls grow, and if it is strict, also when they shrink.
  void mark_exposed() {
    for_each_cell([&](std::uint32_t c) {
      if (out_.cell_in_complex[c]) return;
      for (const std::uint32_t v : t_.cells[c]) {
        if (t_.is_ball(v) && out_.in_complex[v] && strict_[v]) set(out_.exposed[v]);
      }
    });
  }

  // Counts the points of contact: the singular edges of size 0 whose balls touch from outside. If
  // the radical plane is not between the centres, one ball touches the other from inside.
  void count_contacts() {
    for (const DualEdge& e : out_.edges) {
      const bool touching = e.singular && e.contact == Contact::touching;
      out_.point_contacts +=
          touching && plane_between_centers(ball(e.vertices[0]), ball(e.vertices[1]));
    }
  }

  const PowerTriangulation& t_;
  Monitor* monitor_ = nullptr;
  DualComplex out_;
  SortedRows<TriangleAtEdge> rows_;     // per ball: its edges to upper balls, in triangles
  std::vector<std::uint8_t> strict_;    // per ball: still in the complex of balls a little smaller
  std::vector<std::uint8_t> overlaps_;  // per cell: pairs whose balls may meet
};

}  // namespace

DualComplex dual_complex(const PowerTriangulation& triangulation, Monitor* monitor) {
  return ComplexBuilder(triangulation).build(monitor);
}

}  // namespace vdwmesh

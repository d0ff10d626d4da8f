#include "reference/mesh_checks.hpp"

#include <algorithm>
#include <functional>
#include <numbers>
#include <numeric>
#include <sstream>

namespace vdwmesh::reference {
namespace {

struct Side {
  std::uint32_t low, high;
  bool ascending;  // whether the triangle runs it from low to high
};

std::vector<Side> sorted_sides(const TriangleMesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (const Corners& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) {
    return s.low != t.low ? s.low < t.low : s.high < t.high;
  });
  return sides;
}

void count_edges(const TriangleMesh& mesh, MeshFacts& facts) {
  const std::vector<Side> sides = sorted_sides(mesh);
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i;
    while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high)
      ++end;
    ++facts.edges;
    if (end - i == 1) ++facts.open_edges;
    if (end - i > 2) ++facts.crowded_edges;
    if (end - i == 2 && sides[i].ascending == sides[i + 1].ascending) ++facts.badly_oriented_edges;
    i = end;
  }
}

// One spoke per triangle at a vertex: the side opposite to the vertex, as the triangle runs it.
struct Spoke {
  std::uint32_t vertex, from, to;
};

// The far sides of a closed fan chain up: every end is the start of exactly one, in one cycle.
bool is_one_cycle(const std::vector<Spoke>& spokes, std::size_t begin, std::size_t end) {
  std::size_t at = begin, steps = 0;
  do {
    std::size_t next = end, matches = 0;
    for (std::size_t i = begin; i < end; ++i) {
      if (spokes[i].from == spokes[at].to) next = i, ++matches;
    }
    if (matches != 1) return false;
    at = next;
    ++steps;
  } while (at != begin && steps <= end - begin);
  return steps == end - begin;
}

void count_fans(const TriangleMesh& mesh, MeshFacts& facts) {
  std::vector<Spoke> spokes;
  spokes.reserve(3 * mesh.triangles.size());
  for (const Corners& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) spokes.push_back({t[k], t[(k + 1) % 3], t[(k + 2) % 3]});
  }
  std::sort(spokes.begin(), spokes.end(),
            [](const Spoke& a, const Spoke& b) { return a.vertex < b.vertex; });
  std::size_t used = 0;
  for (std::size_t i = 0; i < spokes.size();) {
    std::size_t end = i;
    while (end < spokes.size() && spokes[end].vertex == spokes[i].vertex) ++end;
    ++used;
    if (!is_one_cycle(spokes, i, end)) ++facts.split_vertices;
    i = end;
  }
  facts.unused_vertices = mesh.points.size() - used;
}

double angle(const Point& at, const Point& a, const Point& b) {
  return std::atan2(length(outer(a - at, b - at)), inner(a - at, b - at));
}

std::vector<std::size_t> shell_of_vertices(const TriangleMesh& mesh) {
  std::vector<std::size_t> parent(mesh.points.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const std::function<std::size_t(std::size_t)> root = [&](std::size_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Corners& t : mesh.triangles) {
    parent[root(t[1])] = root(t[0]);
    parent[root(t[2])] = root(t[0]);
  }
  for (std::size_t v = 0; v < parent.size(); ++v) parent[v] = root(v);
  return parent;
}

void measure(const TriangleMesh& mesh, MeshFacts& facts) {
  const std::vector<std::size_t> shell = shell_of_vertices(mesh);
  std::vector<double> volume(mesh.points.size(), 0);
  std::vector<char> is_shell(mesh.points.size(), 0);
  long double area = 0, angles = 0;
  for (const Corners& t : mesh.triangles) {
    const Point &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    const double twice = length(outer(b - a, c - a));
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || !(twice > 0)) ++facts.degenerate_triangles;
    area += twice / 2;
    angles += angle(a, b, c) + angle(b, c, a) + angle(c, a, b);
    const Point& base = mesh.points[shell[t[0]]];
    volume[shell[t[0]]] += inner(a - base, outer(b - base, c - base)) / 6;
    is_shell[shell[t[0]]] = 1;
  }
  facts.area = static_cast<double>(area);
  facts.angle_defect =
      2 * std::numbers::pi * static_cast<double>(mesh.points.size()) - static_cast<double>(angles);
  for (std::size_t v = 0; v < volume.size(); ++v) {
    if (!is_shell[v]) continue;
    facts.volume += volume[v];
    ++(volume[v] > 0 ? facts.positive_shells : facts.negative_shells);
  }
}

void count_bad_numbers(const TriangleMesh& mesh, MeshFacts& facts) {
  for (const Point& p : mesh.points) {
    if (!std::isfinite(p[0] + p[1] + p[2])) ++facts.bad_numbers;
  }
  for (const Corners& t : mesh.triangles) {
    if (std::max({t[0], t[1], t[2]}) >= mesh.points.size()) ++facts.bad_numbers;
  }
}

}  // namespace

bool MeshFacts::closed_oriented_manifold() const {
  return triangles > 0 && open_edges + crowded_edges + badly_oriented_edges + split_vertices +
                                  unused_vertices + bad_numbers ==
                              0;
}

std::int64_t MeshFacts::euler_characteristic() const {
  return static_cast<std::int64_t>(vertices + triangles) - static_cast<std::int64_t>(edges);
}

std::int64_t MeshFacts::genus() const {
  return static_cast<std::int64_t>(positive_shells + negative_shells) - euler_characteristic() / 2;
}

std::string MeshFacts::summary() const {
  std::ostringstream out;
  out << "V " << vertices << " E " << edges << " F " << triangles << ", open " << open_edges
      << ", crowded " << crowded_edges << ", badly oriented " << badly_oriented_edges
      << ", split vertices " << split_vertices << ", unused " << unused_vertices << ", degenerate "
      << degenerate_triangles << ", bad numbers " << bad_numbers << ", shells +" << positive_shells
      << " -" << negative_shells << ", chi " << euler_characteristic() << ", area " << area
      << ", volume " << volume;
  return out.str();
}

MeshFacts inspect(const TriangleMesh& mesh) {
  MeshFacts facts;
  facts.vertices = mesh.points.size();
  facts.triangles = mesh.triangles.size();
  count_bad_numbers(mesh, facts);
  if (facts.bad_numbers > 0) return facts;
  count_edges(mesh, facts);
  count_fans(mesh, facts);
  measure(mesh, facts);
  return facts;
}

}  // namespace vdwmesh::reference

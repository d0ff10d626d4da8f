// DynamicMesh against a plain list of triangles, on which the same operations are done by their
// definitions: the same triangles after each, every edge visited once.
#include "remesh/dynamic_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "support/dice.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh::remesh {
namespace {

using testing::Dice;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

// With the lowest vertex first; the orientation stays.
Triangle from_lowest(Triangle t) {
  std::ranges::rotate(t, std::ranges::min_element(t));
  return t;
}

class PlainMesh {
 public:
  explicit PlainMesh(const IndexedMesh& mesh) {
    for (const Triangle& t : mesh.triangles) triangles_.insert(from_lowest(t));
  }

  void collapse(std::uint32_t from, std::uint32_t to) {
    std::multiset<Triangle> left;
    for (Triangle t : triangles_) {
      std::ranges::replace(t, from, to);
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) left.insert(from_lowest(t));
    }
    triangles_ = std::move(left);
  }
  void flip(const Triangle& a, const Triangle& b, const Triangle& new_a, const Triangle& new_b) {
    remove(a), remove(b);
    triangles_.insert({from_lowest(new_a), from_lowest(new_b)});
  }
  void split(std::uint32_t u, std::uint32_t w, std::uint32_t middle) {
    std::multiset<Triangle> all;
    for (const Triangle& t : triangles_) {
      const bool is_at_edge = std::ranges::count(t, u) == 1 && std::ranges::count(t, w) == 1;
      if (!is_at_edge) {
        all.insert(t);
        continue;
      }
      Triangle first = t, second = t;
      std::ranges::replace(first, u, middle);
      std::ranges::replace(second, w, middle);
      all.insert({from_lowest(first), from_lowest(second)});
    }
    triangles_ = std::move(all);
  }

  const std::multiset<Triangle>& triangles() const { return triangles_; }
  std::set<Edge> edges() const {
    std::set<Edge> all;
    for (const Triangle& t : triangles_) {
      for (int k = 0; k < 3; ++k) all.insert(std::minmax(t[k], t[(k + 1) % 3]));
    }
    return all;
  }

 private:
  void remove(const Triangle& t) {
    const auto found = triangles_.find(from_lowest(t));
    ASSERT_NE(found, triangles_.end());
    triangles_.erase(found);
  }

  std::multiset<Triangle> triangles_;
};

std::multiset<Triangle> triangles_of(const DynamicMesh& mesh) {
  std::multiset<Triangle> all;
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (mesh.is_triangle(t)) all.insert(from_lowest(mesh.triangle(t)));
  }
  return all;
}

void expect_same(const DynamicMesh& mesh, const PlainMesh& plain) {
  ASSERT_EQ(triangles_of(mesh), plain.triangles());
  std::vector<Edge> visited;
  mesh.visit_edges([&](HalfEdge h) {
    ASSERT_EQ(mesh.from(mesh.opposite(h)), mesh.to(h));
    ASSERT_EQ(mesh.opposite(mesh.opposite(h)), h);
    ASSERT_EQ(mesh.find(mesh.from(h), mesh.to(h)), h);
    visited.emplace_back(mesh.from(h), mesh.to(h));
  });
  std::ranges::sort(visited);
  const std::set<Edge> expected = plain.edges();
  ASSERT_TRUE(std::ranges::equal(visited, expected));
}

std::vector<HalfEdge> edges_of(const DynamicMesh& mesh) {
  std::vector<HalfEdge> all;
  mesh.visit_edges([&](HalfEdge h) { all.push_back(h); });
  return all;
}

// One random operation, if it is allowed.
void change(DynamicMesh& mesh, PlainMesh& plain, Dice& dice) {
  const std::vector<HalfEdge> edges = edges_of(mesh);
  HalfEdge h = edges[static_cast<std::size_t>(dice.whole(0, static_cast<int>(edges.size()) - 1))];
  if (dice.one_in(2)) h = mesh.opposite(h);
  const HalfEdge g = mesh.opposite(h);
  const std::uint32_t u = mesh.from(h), w = mesh.to(h), a = mesh.apex(h), b = mesh.apex(g);
  switch (dice.whole(0, 3)) {
    case 0:
      if (!mesh.may_flip(h)) return;
      mesh.flip(h);
      return plain.flip({u, w, a}, {w, u, b}, {u, b, a}, {w, a, b});
    case 1: {
      const std::uint32_t middle = mesh.split(h);
      return plain.split(u, w, middle);
    }
    default:
      if (!mesh.may_collapse(h)) return;
      mesh.collapse(h);
      EXPECT_FALSE(mesh.is_vertex(u));
      return plain.collapse(u, w);
  }
}

TEST(DynamicMesh, OperationsAreThoseOfThePlainList) {
  const IndexedMesh meshes[] = {testing::octahedron(), testing::icosahedron(),
                                testing::icosphere(2)};
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    const IndexedMesh& given = meshes[seed % std::size(meshes)];
    DynamicMesh mesh(given);
    PlainMesh plain(given);
    for (int i = 0; i < 300; ++i) {
      change(mesh, plain, dice);
      if (i % 10 == 9) {
        ASSERT_NO_FATAL_FAILURE(expect_same(mesh, plain));
      }
    }
  }
}

// The largest set of collapses leaves a tetrahedron, and that none.
TEST(DynamicMesh, CollapsesEndAtATetrahedron) {
  DynamicMesh mesh(testing::icosphere(1));
  for (bool changed = true; changed;) {
    changed = false;
    for (const HalfEdge h : edges_of(mesh)) {
      if (!mesh.may_collapse(h)) continue;
      mesh.collapse(h);
      changed = true;
      break;
    }
  }
  EXPECT_EQ(triangles_of(mesh).size(), 4u);
}

TEST(DynamicMesh, MarksStayWithTheirEdges) {
  DynamicMesh mesh(testing::icosphere(1));
  const HalfEdge marked = edges_of(mesh)[7];
  mesh.set_mark(marked, 5);
  EXPECT_EQ(mesh.mark(mesh.opposite(marked)), 5u);
  const std::uint32_t u = mesh.from(marked), w = mesh.to(marked), middle = mesh.split(marked);
  EXPECT_EQ(mesh.mark(mesh.find(u, middle)), 5u);
  EXPECT_EQ(mesh.mark(mesh.find(w, middle)), 5u);
  int marks = 0;
  mesh.visit_edges([&](HalfEdge h) { marks += mesh.mark(h) != kNone; });
  EXPECT_EQ(marks, 2);
  mesh.collapse(mesh.find(middle, u));
  EXPECT_EQ(mesh.mark(mesh.find(u, w)), 5u);
}

TEST(DynamicMesh, RefusesWhatIsNoClosedManifold) {
  IndexedMesh open = testing::octahedron();
  open.triangles.pop_back();
  EXPECT_THROW(DynamicMesh{open}, InvalidInput);
  IndexedMesh turned = testing::octahedron();
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_THROW(DynamicMesh{turned}, InvalidInput);
}

}  // namespace
}  // namespace vdwmesh::remesh

// self_intersections(): finds the pairs of triangles that intersect.
//
// The candidates are the pairs whose bounding boxes overlap, found in a FacetTree. Most are decided
// by the filter of facet_pair.hpp, the others by exact predicates. The unit of work is one bottom
// node of the tree, called home: its 32 triangles are gathered, and paired with each other and with
// those of every bottom node behind it whose box overlaps. So each pair is found once, by one
// thread, and the result does not depend on the number of threads.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <functional>
#include <mutex>
#include <vector>

#include "analysis/facet_pair_exact.hpp"
#include "analysis/facet_tree.hpp"
#include "analysis/mesh_measures.hpp"
#include "core/fixed_blocks.hpp"
#include "core/multiversion.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kLeaf = FacetTree::kLeaf;
constexpr std::size_t kWidth = FacetTree::kWidth;
static_assert(kLeaf == kLanes);
constexpr std::size_t kNodesPerBlock = 64;

Facet facet_of(const IndexedMesh& mesh, std::uint32_t triangle) {
  const Triangle& v = mesh.triangles[triangle];
  return make_facet(v, mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]);
}

bool is_flat(const Facet& f) { return !has_area(f) && is_flat_exactly(f); }

bool do_intersect(const Facet& a, const Facet& b) {
  const Matching& m = match(a.vertex, b.vertex);
  const Meeting found = meeting(a, b, m);
  return found == Meeting::unsure ? intersect_exactly(a, b, m) : found == Meeting::intersect;
}

// The triangles of a leaf, gathered from the mesh. Boxes of triangles that are not there are empty.
struct Leaf {
  double lower[3][kLeaf], upper[3][kLeaf];  // the boxes of the triangles, by axis
  Box box;                                  // around all of them
  std::array<Facet, kLeaf> facet;
  std::array<std::uint32_t, kLeaf> triangle;
  std::size_t count = 0;

  Box box_at(std::size_t i) const {
    return {{lower[0][i], lower[1][i], lower[2][i]}, {upper[0][i], upper[1][i], upper[2][i]}};
  }
  void gather(const IndexedMesh& mesh, const FacetTree& tree, std::size_t leaf);
};

void Leaf::gather(const IndexedMesh& mesh, const FacetTree& tree, std::size_t leaf) {
  box = empty_box();
  const std::size_t first = std::min(kLeaf * leaf, tree.size());
  count = std::min(kLeaf, tree.size() - first);
  for (std::size_t i = 0; i < kLeaf; ++i) {
    Box own = empty_box();
    if (i < count) {
      triangle[i] = tree.triangle_at(first + i);
      facet[i] = facet_of(mesh, triangle[i]);
      for (const Vec3d& p : facet[i].corner) include(own, p);
    }
    include(box, own);
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis][i] = own.lower[axis];
      upper[axis][i] = own.upper[axis];
    }
  }
}

// Appends the intersecting pairs of a triangle of `a` and one of `b`; if both are the same leaf,
// each pair once.
void join_leaves(const Leaf& a, const Leaf& b, TrianglePairs& found) {
  for (std::size_t i = 0; i < a.count; ++i) {
    std::uint32_t near = overlapping_lanes(b.lower, b.upper, 0, a.box_at(i));
    if (&a == &b) near &= ~std::uint32_t{0} << (i + 1);
    for (; near != 0; near &= near - 1) {
      const auto j = static_cast<std::size_t>(std::countr_zero(near));
      if (!do_intersect(a.facet[i], b.facet[j])) continue;
      found.push_back(std::minmax(a.triangle[i], b.triangle[j]));
    }
  }
}

// The search from the bottom node `home`.
class HomeSearch {
 public:
  HomeSearch(const IndexedMesh& mesh, const FacetTree& tree, std::size_t home)
      : mesh_(mesh), tree_(tree), home_(home), box_(empty_box()) {
    for (std::size_t l = 0; l < kWidth; ++l) {
      leaves_[l].gather(mesh, tree, kWidth * home + l);
      include(box_, leaves_[l].box);
    }
  }

  // Appends the pairs of each node in turn to `found`, and calls after_node() after each.
  template <class AfterNode>
  void run(TrianglePairs& found, const AfterNode& after_node) const {
    tree_.visit_nodes_from(home_, box_, [&](std::size_t node) {
      node == home_ ? join_home(found) : join_node(node, found);
      after_node();
    });
  }

 private:
  void join_home(TrianglePairs& found) const {
    for (std::size_t l = 0; l < kWidth; ++l) {
      std::uint32_t near = tree_.overlapping_leaves(home_, leaves_[l].box);
      for (near &= ~std::uint32_t{0} << l; near != 0; near &= near - 1) {
        join_leaves(leaves_[l], leaves_[static_cast<std::size_t>(std::countr_zero(near))], found);
      }
    }
  }

  // A leaf of the other node is gathered once, for all leaves of this one.
  void join_node(std::size_t node, TrianglePairs& found) const {
    std::array<std::uint32_t, kWidth> near;
    std::uint32_t any = 0;
    for (std::size_t l = 0; l < kWidth; ++l) {
      near[l] = tree_.overlapping_leaves(node, leaves_[l].box);
      any |= near[l];
    }
    for (; any != 0; any &= any - 1) {
      const auto other = static_cast<std::size_t>(std::countr_zero(any));
      Leaf leaf;
      leaf.gather(mesh_, tree_, kWidth * node + other);
      for (std::size_t l = 0; l < kWidth; ++l) {
        if ((near[l] >> other & 1) != 0) join_leaves(leaves_[l], leaf, found);
      }
    }
  }

  const IndexedMesh& mesh_;
  const FacetTree& tree_;
  std::size_t home_;
  Box box_;
  std::array<Leaf, kWidth> leaves_;
};

// The triangles that have an area.
Buffer<std::uint32_t> without_flat(const IndexedMesh& mesh) {
  Buffer<std::uint8_t> has_area(mesh.triangle_count());
  for_each_index(has_area.size(), [&](std::size_t t) {
    has_area[t] = !is_flat(facet_of(mesh, static_cast<std::uint32_t>(t)));
  });
  Buffer<std::uint32_t> chosen(mesh.triangle_count());
  const std::uint32_t count = number_all(
      mesh.triangle_count(), [&](std::size_t t) { return has_area[t] != 0; },
      [&](std::size_t t, std::uint32_t n) { chosen[n] = static_cast<std::uint32_t>(t); });
  chosen.resize(count);
  return chosen;
}

using TakePairs = std::function<void(const TrianglePairs&)>;

// Calls take(found) for lists of pairs that intersect, one of them a triangle of the bottom nodes
// from `first` to `end`. The monitor is asked between nodes, so that a search in which very many
// boxes overlap can be stopped.
VDWMESH_MULTIVERSION void search_from(const IndexedMesh& mesh, const FacetTree& tree,
                                      std::size_t first, std::size_t end, Monitor* monitor,
                                      const TakePairs& take) {
  TrianglePairs found;
  for (std::size_t home = first; home < end; ++home) {
    HomeSearch(mesh, tree, home).run(found, [&] {
      advance(monitor, 0);
      if (!found.empty()) take(found);
      found.clear();
    });
  }
}

// The same for all bottom nodes, from several threads.
void search(const IndexedMesh& mesh, Monitor* monitor, const TakePairs& take) {
  advance(monitor, 0);
  const FacetTree tree(mesh, without_flat(mesh));
  begin_stage(monitor, "self-intersections", block_count(tree.bottom_nodes(), kNodesPerBlock));
  for_each_block(
      tree.bottom_nodes(), kNodesPerBlock,
      [&](std::size_t, std::size_t first, std::size_t end) {
        search_from(mesh, tree, first, end, monitor, take);
      },
      monitor);
}

}  // namespace

std::uint64_t self_intersections(const IndexedMesh& mesh, Monitor* monitor) {
  std::atomic<std::uint64_t> count{0};
  search(mesh, monitor, [&](const TrianglePairs& pairs) {
    count.fetch_add(pairs.size(), std::memory_order_relaxed);
  });
  return count;
}

TrianglePairs intersecting_pairs(const IndexedMesh& mesh, Monitor* monitor) {
  TrianglePairs all;
  std::mutex guard;
  search(mesh, monitor, [&](const TrianglePairs& pairs) {
    const std::lock_guard lock(guard);
    all.insert(all.end(), pairs.begin(), pairs.end());
  });
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace vdwmesh

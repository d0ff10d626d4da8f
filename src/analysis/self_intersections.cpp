// self_intersections(): finds the pairs of triangles that intersect.
//
// The candidates are the pairs whose bounding boxes overlap, found in a FacetTree. Most are
// neighbours on a smooth surface, which four at a time are found apart (facet_leaf_apart.hpp);
// others are decided by the filter of facet_pair.hpp, and the last ones by exact predicates. The
// unit of work is one bottom node of the tree, called home: its 32 triangles are gathered, and
// paired with each other and with those of every bottom node behind it whose box overlaps. So each
// pair is found once, by one thread, and the result does not depend on the number of threads.
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <functional>
#include <mutex>
#include <vector>

#include "analysis/facet_leaf_apart.hpp"
#include "analysis/facet_pair_exact.hpp"
#include "analysis/facet_tree.hpp"
#include "analysis/mesh_measures.hpp"
#include "core/blocks.hpp"
#include "core/fixed_blocks.hpp"
#include "core/multiversion.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kWidth = FacetTree::kWidth;
constexpr std::size_t kNodesPerBlock = 64;

bool do_intersect(const Facet& a, const Facet& b) {
  const Matching& m = match(a.vertex, b.vertex);
  const Meeting found = meeting(a, b, m);
  return found == Meeting::unsure ? intersect_exactly(a, b, m) : found == Meeting::intersect;
}

// The leaves that were gathered last. Most leaves are near several bottom nodes, which are searched
// one soon after the other.
class LeafCache {
 public:
  LeafCache() : number_(kSlots, kNone), leaves_(kSlots) {}

  // The leaf is good until another one is asked for.
  const FacetLeaf& at(const IndexedMesh& mesh, const FacetTree& tree, std::size_t leaf) {
    const std::size_t slot = leaf % kSlots;
    if (number_[slot] != leaf) {
      leaves_[slot].gather(mesh, tree, leaf);
      number_[slot] = leaf;
    }
    return leaves_[slot];
  }

 private:
  static constexpr std::size_t kSlots = 512;  // so that they stay in the second-level cache
  static constexpr std::size_t kNone = ~std::size_t{0};
  std::vector<std::size_t> number_;  // of the leaf in each slot
  Buffer<FacetLeaf> leaves_;
};

double longest_side(const Box& box) {
  const Vec3d side = box.upper - box.lower;
  return std::max({side.x, side.y, side.z});
}

// Appends the intersecting pairs of a triangle of `a` and one of `b`; if both are the same leaf,
// each pair once. `reach` is at least the longest side of a box around both.
VDWMESH_INLINE void join_leaves(const FacetLeaf& a, const FacetLeaf& b, double reach,
                                TrianglePairs& found) {
  for (std::uint32_t left = a.overlapping(b.box); left != 0; left &= left - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(left));
    std::uint32_t near = b.overlapping(a.box_at(i));
    if (&a == &b) near &= ~std::uint32_t{0} << (i + 1);
    if (near != 0) near = not_apart(b, near, a, i, reach);
    for (; near != 0; near &= near - 1) {
      const auto j = static_cast<std::size_t>(std::countr_zero(near));
      if (!do_intersect(a.facet_at(i), b.facet_at(j))) continue;
      found.push_back(std::minmax(a.triangle[i], b.triangle[j]));
    }
  }
}

// The search from the bottom node `home`.
class HomeSearch {
 public:
  HomeSearch(const IndexedMesh& mesh, const FacetTree& tree, std::size_t home, LeafCache& cache)
      : mesh_(mesh), tree_(tree), home_(home), cache_(cache), box_(empty_box()) {
    for (std::size_t l = 0; l < kWidth; ++l) {
      leaves_[l] = cache.at(mesh, tree, kWidth * home + l);
      include(box_, leaves_[l].box);
    }
  }

  // Appends the pairs of each node in turn to `found`, and calls after_node() after each.
  template <class AfterNode>
  void run(TrianglePairs& found, const AfterNode& after_node) {
    tree_.visit_nodes_from(home_, box_, [&](std::size_t node) {
      node == home_ ? join_home(found) : join_node(node, found);
      after_node();
    });
  }

 private:
  void join_home(TrianglePairs& found) const {
    const double reach = longest_side(box_);
    for (std::size_t l = 0; l < kWidth; ++l) {
      std::uint32_t near = tree_.overlapping_leaves(home_, leaves_[l].box);
      for (near &= ~std::uint32_t{0} << l; near != 0; near &= near - 1) {
        const auto other = static_cast<std::size_t>(std::countr_zero(near));
        join_leaves(leaves_[l], leaves_[other], reach, found);
      }
    }
  }

  // Few leaves of the other node are near, and each is taken once, for all leaves of this one.
  void join_node(std::size_t node, TrianglePairs& found) {
    std::uint32_t others = tree_.overlapping_leaves(node, box_);
    for (; others != 0; others &= others - 1) {
      const auto other = static_cast<std::size_t>(std::countr_zero(others));
      const Box box = tree_.box_of_leaf(node, other);
      std::uint32_t near = tree_.overlapping_leaves(home_, box);
      if (near == 0) continue;
      const FacetLeaf& leaf = cache_.at(mesh_, tree_, kWidth * node + other);
      Box both = box_;
      include(both, box);
      const double reach = longest_side(both);
      for (; near != 0; near &= near - 1) {
        join_leaves(leaves_[static_cast<std::size_t>(std::countr_zero(near))], leaf, reach, found);
      }
    }
  }

  const IndexedMesh& mesh_;
  const FacetTree& tree_;
  std::size_t home_;
  LeafCache& cache_;
  Box box_;
  std::array<FacetLeaf, kWidth> leaves_;
};

using TakePairs = std::function<void(const TrianglePairs&)>;

// Calls take(found) for lists of pairs that intersect, one of them a triangle of the bottom nodes
// from `first` to `end`. The monitor is asked between nodes, so that a search in which very many
// boxes overlap can be stopped.
VDWMESH_MULTIVERSION void search_from(const IndexedMesh& mesh, const FacetTree& tree,
                                      std::size_t first, std::size_t end, LeafCache& cache,
                                      Monitor* monitor, const TakePairs& take) {
  TrianglePairs found;
  for (std::size_t home = first; home < end; ++home) {
    HomeSearch(mesh, tree, home, cache).run(found, [&] {
      advance(monitor, 0);
      if (!found.empty()) take(found);
      found.clear();
    });
  }
}

// The same for all bottom nodes, from several threads.
void search(const IndexedMesh& mesh, Monitor* monitor, const TakePairs& take) {
  advance(monitor, 0);
  const FacetTree tree(mesh);
  begin_stage(monitor, "self-intersections", block_count(tree.bottom_nodes(), kNodesPerBlock));
  tbb::enumerable_thread_specific<LeafCache> caches;
  for_each_block(
      tree.bottom_nodes(), kNodesPerBlock,
      [&](std::size_t, std::size_t first, std::size_t end) {
        search_from(mesh, tree, first, end, caches.local(), monitor, take);
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

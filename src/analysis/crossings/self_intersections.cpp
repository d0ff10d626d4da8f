// self_intersections(): finds the pairs of triangles that intersect.
//
// If the mesh lies in the cells of a grid, as marching cubes leaves it, only triangles of one cell
// can intersect (analysis/crossings/cell_pairs.hpp). Otherwise the candidates are the pairs whose
// bounding boxes overlap, found in a FacetTree. If the mesh is known to be closed and oriented, and
// was divided, a leaf of the tree is a patch, a divided triangle. Nearly all patches that meet are
// in one star, where no triangles intersect (surface/star_fans.hpp). Others are found apart four at
// a time (facet_leaf_apart.hpp) or decided by the filter of facet_pair.hpp, and the last ones by
// exact predicates. Triangles at a vertex of very many are no part of the tree, but searched by
// their directions from there (hub_pairs.hpp). The unit of work is one bottom node of the tree,
// called home: its 32 triangles are paired with each other and with those of every bottom node
// behind it whose box overlaps. So each pair is found once, by one thread, and the result does not
// depend on the number of threads.
#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <functional>
#include <mutex>
#include <vector>

#include "analysis/crossings/cell_pairs.hpp"
#include "analysis/crossings/facet_leaf_apart.hpp"
#include "analysis/crossings/facet_pair_exact.hpp"
#include "analysis/crossings/facet_tree.hpp"
#include "analysis/crossings/hub_pairs.hpp"
#include "analysis/mesh_measures.hpp"
#include "core/blocks.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/lanes/lane_masks.hpp"
#include "core/lanes/multiversion.hpp"
#include "surface/star_fans.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kWidth = FacetTree::kWidth;
constexpr std::size_t kNodesPerBlock = 64;
constexpr std::uint64_t kMostSelfIntersections = 10'000'000;  // counted in some 15 s

// The corners with a star of a leaf that is a patch, or kNone.
using LeafStars = std::array<std::uint32_t, 3>;

// Whether the triangles of a leaf are those of a patch, all there in their order.
bool leaf_is_patch(const FacetTree& tree, std::size_t leaf) {
  constexpr std::size_t kPatch = FacetTree::kLeaf;
  if (kPatch * (leaf + 1) > tree.size()) return false;
  const std::uint32_t first = tree.triangle_at(kPatch * leaf);
  bool all = first % kPatch == 0;
  for (std::uint32_t i = 1; i < kPatch; ++i)
    all &= tree.triangle_at(kPatch * leaf + i) == first + i;
  return all;
}

// The stars of all leaves; empty if there are no fans.
Buffer<LeafStars> stars_of_leaves(const IndexedMesh& mesh, const FacetTree& tree,
                                  const StarFans& fans) {
  Buffer<LeafStars> stars;
  if (fans.empty()) return stars;
  stars.resize(kWidth * tree.bottom_nodes());
  for_each_index(stars.size(), [&](std::size_t leaf) {
    stars[leaf] = {StarFans::kNone, StarFans::kNone, StarFans::kNone};
    if (!leaf_is_patch(tree, leaf)) return;
    const std::uint32_t first = tree.triangle_at(FacetTree::kLeaf * leaf);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = mesh.triangles[first + k][0];
      if (fans.is_star(corner)) stars[leaf][k] = corner;
    }
  });
  return stars;
}

// The same of the eight leaves of a node, side by side.
class NodeStars {
 public:
  NodeStars(const Buffer<LeafStars>& stars, std::size_t node) {
    if (stars.empty()) return;
    for (std::size_t l = 0; l < kWidth; ++l) {
      for (std::size_t k = 0; k < 3; ++k) star_[k][l] = stars[kWidth * node + l][k];
    }
  }
  // A mask of the leaves that share a star with the given one.
  VDWMESH_INLINE std::uint32_t shared(const LeafStars& leaf) const {
    EightMasks found{};
    for (const auto& lanes : star_) {
      Ids own;
      std::memcpy(&own, &lanes, sizeof own);
      EightMasks equal{};
      for (const std::uint32_t star : leaf) equal |= own == Ids{} + star;
      found |= equal & (own != Ids{} + StarFans::kNone);
    }
    return bits_of_eight(found);
  }

 private:
  using Ids = std::uint32_t __attribute__((vector_size(kWidth * sizeof(std::uint32_t))));
  std::uint32_t star_[3][kWidth];
};

// What is searched; owns nothing.
struct SearchInput {
  const IndexedMesh& mesh;
  const FacetTree& tree;
  const Buffer<LeafStars>& stars;  // by leaf; empty if nothing is known of the mesh
};

// The leaves that were gathered last. Most leaves are near several bottom nodes, which are searched
// one soon after the other.
class LeafCache {
 public:
  LeafCache() : number_(kSlots, kNone), leaves_(kSlots) {}

  // The leaf is good until another one is asked for.
  const FacetLeaf& at(const SearchInput& mesh, std::size_t leaf) {
    const std::size_t slot = leaf % kSlots;
    if (number_[slot] != leaf) {
      leaves_[slot].gather(mesh.mesh, mesh.tree, leaf);
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
  HomeSearch(const SearchInput& mesh, std::size_t home, LeafCache& cache)
      : mesh_(mesh),
        tree_(mesh.tree),
        home_(home),
        cache_(cache),
        stars_(mesh.stars, home),
        box_(empty_box()) {
    for (std::size_t l = 0; l < kWidth; ++l) include(box_, tree_.box_of_leaf(home, l));
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
  // A leaf of this node, gathered when it is first asked for.
  const FacetLeaf& leaf(std::size_t l) {
    if ((gathered_ >> l & 1) == 0) leaves_[l] = cache_.at(mesh_, kWidth * home_ + l);
    gathered_ |= 1u << l;
    return leaves_[l];
  }

  // A mask of the leaves of this node whose triangles may intersect those of the given leaf of
  // another node, or of this one.
  std::uint32_t near_leaves(std::size_t node, std::size_t other, const Box& box) const {
    const std::uint32_t near = tree_.overlapping_leaves(home_, box);
    if (mesh_.stars.empty() || near == 0) return near;
    return near & ~stars_.shared(mesh_.stars[kWidth * node + other]);
  }

  void join_home(TrianglePairs& found) {
    const double reach = longest_side(box_);
    for (std::size_t l = 0; l < kWidth; ++l) {
      std::uint32_t near = near_leaves(home_, l, tree_.box_of_leaf(home_, l));
      for (near &= ~std::uint32_t{0} << l; near != 0; near &= near - 1) {
        const auto other = static_cast<std::size_t>(std::countr_zero(near));
        join_leaves(leaf(l), leaf(other), reach, found);
      }
    }
  }

  // Few leaves of the other node are near, and each is taken once, for all leaves of this one.
  void join_node(std::size_t node, TrianglePairs& found) {
    std::uint32_t others = tree_.overlapping_leaves(node, box_);
    for (; others != 0; others &= others - 1) {
      const auto other = static_cast<std::size_t>(std::countr_zero(others));
      const Box box = tree_.box_of_leaf(node, other);
      std::uint32_t near = near_leaves(node, other, box);
      if (near == 0) continue;
      // Gathers those of this node first, because the other one is good until another is asked for.
      for (std::uint32_t own = near; own != 0; own &= own - 1) {
        leaf(static_cast<std::size_t>(std::countr_zero(own)));
      }
      const FacetLeaf& its = cache_.at(mesh_, kWidth * node + other);
      Box both = box_;
      include(both, box);
      const double reach = longest_side(both);
      for (; near != 0; near &= near - 1) {
        join_leaves(leaf(static_cast<std::size_t>(std::countr_zero(near))), its, reach, found);
      }
    }
  }

  const SearchInput& mesh_;
  const FacetTree& tree_;
  std::size_t home_;
  LeafCache& cache_;
  NodeStars stars_;
  Box box_;
  std::uint32_t gathered_ = 0;  // a mask of leaves_
  std::array<FacetLeaf, kWidth> leaves_;
};

using TakePairs = std::function<void(const TrianglePairs&)>;

// Calls take(found) for lists of pairs that intersect, one of them a triangle of the bottom nodes
// from `first` to `end`. The monitor is asked between nodes, so that a search in which very many
// boxes overlap can be stopped.
VDWMESH_MULTIVERSION void search_from(const SearchInput& mesh, std::size_t first, std::size_t end,
                                      LeafCache& cache, Monitor* monitor, const TakePairs& take) {
  TrianglePairs found;
  for (std::size_t home = first; home < end; ++home) {
    HomeSearch(mesh, home, cache).run(found, [&] {
      advance(monitor, 0);
      if (!found.empty()) take(found);
      found.clear();
    });
  }
}

// The triangles of one hub: of a list in the order of hubs.
struct HubTriangles {
  std::size_t first, end;
  Box box;  // around all of them, Å
};

std::vector<HubTriangles> group_by_hub(const IndexedMesh& mesh,
                                       const std::vector<std::uint32_t>& triangles,
                                       const Buffer<std::uint32_t>& hubs) {
  std::vector<HubTriangles> groups;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (i == 0 || hubs[triangles[i]] != hubs[triangles[i - 1]])
      groups.push_back({i, i, empty_box()});
    include(groups.back().box, box_of(mesh, triangles[i]));
    groups.back().end = i + 1;
  }
  return groups;
}

// Appends the triangles of the tree in whose boxes the star may be.
void add_near(const IndexedMesh& mesh, const FacetTree& tree, const HubStar& star,
              std::vector<std::uint32_t>& found) {
  tree.visit_nodes_from(0, star.box(), [&](std::size_t node) {
    for (std::uint32_t near = tree.overlapping_leaves(node, star.box()); near != 0;
         near &= near - 1) {
      const std::size_t first =
          FacetTree::kLeaf * (kWidth * node + static_cast<std::size_t>(std::countr_zero(near)));
      for (std::size_t i = first; i < std::min(first + FacetTree::kLeaf, tree.size()); ++i) {
        const std::uint32_t t = tree.triangle_at(i);
        if (!tree.is_left_out(t) && meet(star.box(), box_of(mesh, t))) found.push_back(t);
      }
    }
  });
}

// The pairs of which a triangle at least has a hub, each with the star of the lower one of the
// hubs.
void search_hubs(const IndexedMesh& mesh, const FacetTree& tree, const Buffer<std::uint32_t>& hubs,
                 Monitor* monitor, const TakePairs& take) {
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t t = 0; t < hubs.size(); ++t)
    if (hubs[t] != kNoIndex) triangles.push_back(t);
  std::sort(triangles.begin(), triangles.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(hubs[a], a) < std::pair(hubs[b], b);
  });
  // A hub has hundreds of triangles, so all pairs of hubs are few.
  const std::vector<HubTriangles> groups = group_by_hub(mesh, triangles, hubs);
  for (std::size_t group = 0; group < groups.size(); ++group) {
    advance(monitor, 0);
    const auto& [first, end, box] = groups[group];
    const HubStar star(mesh, hubs[triangles[first]],
                       std::span(triangles).subspan(first, end - first));
    std::vector<std::uint32_t> others;
    add_near(mesh, tree, star, others);
    for (std::size_t other = group + 1; other < groups.size(); ++other) {
      if (!meet(box, groups[other].box)) continue;
      for (std::size_t i = groups[other].first; i < groups[other].end; ++i)
        if (meet(star.box(), box_of(mesh, triangles[i]))) others.push_back(triangles[i]);
    }
    for_each_block(star.size() + others.size(), kNodesPerBlock,
                   [&](std::size_t, std::size_t begin, std::size_t past) {
                     TrianglePairs found;
                     for (std::size_t i = begin; i < past; ++i) {
                       i < star.size() ? star.join_own(i, monitor, found)
                                       : star.join_other(others[i - star.size()], monitor, found);
                       if (!found.empty()) take(found);
                       found.clear();
                     }
                     advance(monitor, 0);
                   });
  }
}

// search_from() all bottom nodes, from several threads, and what the tree leaves out.
void search_tree(const IndexedMesh& mesh, MeshEdges edges, Monitor* monitor,
                 const TakePairs& take) {
  const StarFans fans = edges == MeshEdges::paired ? fans_of_divided(mesh) : StarFans();
  const Buffer<std::uint32_t> hubs = hubs_of_triangles(mesh);
  const FacetTree tree(mesh, hubs);
  const Buffer<LeafStars> stars = stars_of_leaves(mesh, tree, fans);
  const SearchInput searched{mesh, tree, stars};
  begin_stage(monitor, "self-intersections", block_count(tree.bottom_nodes(), kNodesPerBlock));
  tbb::enumerable_thread_specific<LeafCache> caches;
  for_each_block(
      tree.bottom_nodes(), kNodesPerBlock,
      [&](std::size_t, std::size_t first, std::size_t end) {
        search_from(searched, first, end, caches.local(), monitor, take);
      },
      monitor);
  if (!hubs.empty()) search_hubs(mesh, tree, hubs, monitor, take);
}

void search(const IndexedMesh& mesh, MeshEdges edges, const std::optional<GridSpec>& grid,
            Monitor* monitor, const TakePairs& take) {
  advance(monitor, 0);
  const auto pairs = grid ? pairs_within_cells(mesh, *grid, monitor) : std::nullopt;
  pairs ? take(*pairs) : search_tree(mesh, edges, monitor, take);
}

}  // namespace

std::uint64_t self_intersections(const IndexedMesh& mesh, Monitor* monitor, MeshEdges edges,
                                 const std::optional<GridSpec>& grid) {
  std::atomic<std::uint64_t> count{0};
  search(mesh, edges, grid, monitor, [&](const TrianglePairs& pairs) {
    count.fetch_add(pairs.size(), std::memory_order_relaxed);
    if (count.load(std::memory_order_relaxed) <= kMostSelfIntersections) return;
    throw LimitExceeded(fmt::format(
        "more than {} pairs of triangles intersect each other: do not count self-intersections, or "
        "leave out triangles that lie where others do",
        kMostSelfIntersections));
  });
  return count;
}

TrianglePairs intersecting_pairs(const IndexedMesh& mesh, Monitor* monitor, MeshEdges edges,
                                 const std::optional<GridSpec>& grid) {
  TrianglePairs all;
  std::mutex guard;
  search(mesh, edges, grid, monitor, [&](const TrianglePairs& pairs) {
    const std::lock_guard lock(guard);
    all.insert(all.end(), pairs.begin(), pairs.end());
  });
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace vdwmesh

// self_intersections(): finds the pairs of triangles that intersect.
//
// The candidates are the pairs whose bounding boxes overlap, found in a FacetTree. Most are decided
// by the filter of facet_pair.hpp, the others by exact predicates. The unit of work is one bottom
// node of the tree, called home: its 32 triangles are gathered, and paired with each other and with
// those of every bottom node behind it whose box overlaps. So each pair is found once, by one
// thread, and the result does not depend on the number of threads.
//
// Most candidates are neighbours on a smooth surface: the corners that one of them does not share
// with the other lie on one side of the other's plane. Four of them are tested for that at a time
// (Leaf::beside_plane_of, Leaf::with_planes_beside), with the arithmetic of the filter; a pair that
// passes is one that the filter would find apart by the same sides (meeting() in facet_pair.hpp).
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
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

// Three coordinates of four triangles, by axis.
struct LaneVector {
  double at[3][kLeaf];
  Lanes axis(int i) const { return lanes_at(at[i]); }
  Vec3d lane(std::size_t i) const { return {at[0][i], at[1][i], at[2][i]}; }
  void set(std::size_t i, const Vec3d& v) { at[0][i] = v.x, at[1][i] = v.y, at[2][i] = v.z; }
};

// Of four points p: whether they lie on the positive, and on the negative side of a plane for
// certain, as side_of() in facet_pair.hpp says it. The plane goes through `corner` and has `normal`
// and `magnitude` as in Facet. Each argument has four lanes; a plane for all has them alike.
struct LaneSides {
  LaneBits above, below;
};
VDWMESH_INLINE LaneSides sides_of(const Lanes (&corner)[3], const Lanes (&normal)[3],
                                  const Lanes (&magnitude)[3], const Lanes (&p)[3]) {
  const Lanes x = p[0] - corner[0], y = p[1] - corner[1], z = p[2] - corner[2];
  const Lanes volume = x * normal[0] + y * normal[1] + z * normal[2];
  const Lanes bound =
      kSideBound * (magnitude_of(x) * magnitude[0] + magnitude_of(y) * magnitude[1] +
                    magnitude_of(z) * magnitude[2]) +
      kTiny;
  return {volume > bound, volume < -bound};
}

// The triangles of a leaf, gathered from the mesh. Boxes of triangles that are not there are empty.
struct Leaf {
  double lower[3][kLeaf], upper[3][kLeaf];  // the boxes of the triangles, by axis
  LaneVector corner[3], normal, magnitude;  // as in Facet
  std::int64_t vertex[3][kLeaf];            // indices
  Box box;                                  // around all of them
  std::array<std::uint32_t, kLeaf> triangle;
  std::size_t count = 0;

  Box box_at(std::size_t i) const {
    return {{lower[0][i], lower[1][i], lower[2][i]}, {upper[0][i], upper[1][i], upper[2][i]}};
  }
  Facet facet_at(std::size_t i) const {
    Facet f;
    for (std::size_t k = 0; k < 3; ++k) {
      f.vertex[k] = static_cast<std::uint32_t>(vertex[k][i]);
      f.corner[k] = corner[k].lane(i);
    }
    f.normal = normal.lane(i);
    f.magnitude = magnitude.lane(i);
    return f;
  }
  void gather(const IndexedMesh& mesh, const FacetTree& tree, std::size_t leaf);
  void set_planes();

  std::uint32_t beside_plane_of(const Leaf& other, std::size_t i) const;
  std::uint32_t with_planes_beside(const Leaf& other, std::size_t i) const;
};

void Leaf::gather(const IndexedMesh& mesh, const FacetTree& tree, std::size_t leaf) {
  box = empty_box();
  const std::size_t first = std::min(kLeaf * leaf, tree.size());
  count = std::min(kLeaf, tree.size() - first);
  for (std::size_t i = 0; i < kLeaf; ++i) {
    Box own = empty_box();
    triangle[i] = i < count ? tree.triangle_at(first + i) : 0;
    const Triangle& v = mesh.triangles[triangle[i]];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& p = mesh.positions[v[k]];
      vertex[k][i] = v[k];
      corner[k].set(i, p);
      if (i < count) include(own, p);
    }
    include(box, own);
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis][i] = own.lower[axis];
      upper[axis][i] = own.upper[axis];
    }
  }
  set_planes();
}

// The operations of set_plane() in facet_pair.hpp, for four triangles.
void Leaf::set_planes() {
  Lanes u[3], v[3];
  for (int axis = 0; axis < 3; ++axis) {
    u[axis] = corner[1].axis(axis) - corner[0].axis(axis);
    v[axis] = corner[2].axis(axis) - corner[0].axis(axis);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int j = (axis + 1) % 3, k = (axis + 2) % 3;
    const Lanes first = u[j] * v[k], second = u[k] * v[j];
    store_lanes(normal.at[axis], first - second);
    store_lanes(magnitude.at[axis], magnitude_of(first) + magnitude_of(second) + kFloor);
  }
}

// A mask of the triangles of this leaf whose corners, but for those they share with triangle i of
// `other`, lie on one side of that triangle's plane for certain. If all corners are shared, none
// do.
VDWMESH_INLINE std::uint32_t Leaf::beside_plane_of(const Leaf& other, std::size_t i) const {
  Lanes base[3], n[3], m[3];
  for (int axis = 0; axis < 3; ++axis) {
    base[axis] = all_lanes(other.corner[0].at[axis][i]);
    n[axis] = all_lanes(other.normal.at[axis][i]);
    m[axis] = all_lanes(other.magnitude.at[axis][i]);
  }
  LaneBits above = all_bits(-1), below = above, all_shared = above;
  for (std::size_t k = 0; k < 3; ++k) {
    const LaneBits own = bits_at(vertex[k]);
    const LaneBits shared = (own == all_bits(other.vertex[0][i])) |
                            (own == all_bits(other.vertex[1][i])) |
                            (own == all_bits(other.vertex[2][i]));
    const Lanes p[3] = {corner[k].axis(0), corner[k].axis(1), corner[k].axis(2)};
    const LaneSides sides = sides_of(base, n, m, p);
    above &= sides.above | shared;
    below &= sides.below | shared;
    all_shared &= shared;
  }
  return bits_of((above | below) & ~all_shared);
}

// A mask of the triangles of this leaf beside whose plane triangle i of `other` lies in that sense.
VDWMESH_INLINE std::uint32_t Leaf::with_planes_beside(const Leaf& other, std::size_t i) const {
  Lanes base[3], n[3], m[3];
  for (int axis = 0; axis < 3; ++axis) {
    base[axis] = corner[0].axis(axis);
    n[axis] = normal.axis(axis);
    m[axis] = magnitude.axis(axis);
  }
  LaneBits above = all_bits(-1), below = above, all_shared = above;
  for (std::size_t k = 0; k < 3; ++k) {
    const LaneBits its = all_bits(other.vertex[k][i]);
    const LaneBits shared =
        (bits_at(vertex[0]) == its) | (bits_at(vertex[1]) == its) | (bits_at(vertex[2]) == its);
    Lanes p[3];
    for (int axis = 0; axis < 3; ++axis) {
      p[axis] = all_lanes(other.corner[k].at[axis][i]);
    }
    const LaneSides sides = sides_of(base, n, m, p);
    above &= sides.above | shared;
    below &= sides.below | shared;
    all_shared &= shared;
  }
  return bits_of((above | below) & ~all_shared);
}

// Appends the intersecting pairs of a triangle of `a` and one of `b`; if both are the same leaf,
// each pair once.
void join_leaves(const Leaf& a, const Leaf& b, TrianglePairs& found) {
  for (std::size_t i = 0; i < a.count; ++i) {
    std::uint32_t near = overlapping_lanes(b.lower, b.upper, 0, a.box_at(i));
    if (&a == &b) near &= ~std::uint32_t{0} << (i + 1);
    if (near != 0) near &= ~b.beside_plane_of(a, i);
    if (near != 0) near &= ~b.with_planes_beside(a, i);
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

// Construction of FacetTree, a linear bounding volume hierarchy (C. Lauterbach et al., Computer
// Graphics Forum 28 (2009) 375). The triangles are sorted along the Z-order curve, every four
// consecutive ones form a leaf, every eight leaves a node, and so on up to the root.
//
// If every four consecutive triangles of the mesh are near each other, as the children of a divided
// triangle are, they are sorted together, as one item: then there are fewer keys to sort, and a
// leaf reads its triangles from one place of memory. Otherwise an item is a single triangle.
//
// Two things keep the tree good for meshes of very uneven scale. Items far wider than the others
// come last, by classes of width: among small ones, each of them would widen the boxes of all nodes
// above it. And items that the cells of the curve do not tell apart, as near each other beside a
// vertex far away, are sorted again by cells of their own box.
//
// BoxTree (analysis/distances/box_tree_view.hpp) is another tree. It finds what is nearest to a
// point, on host and device alike, and its boxes are bytes, rounded outward. Here boxes are
// compared exactly.
#include "analysis/crossings/facet_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "analysis/crossings/triangle_runs.hpp"
#include "core/blocks.hpp"
#include "core/fixed_blocks.hpp"
#include "core/order/morton.hpp"
#include "core/order/sort_keys.hpp"

namespace vdwmesh {
namespace {

constexpr int kClassBits = 3;
// More triangles than this with one key are sorted again: a node of them.
constexpr std::size_t kUnsorted = FacetTree::kLeaf * FacetTree::kWidth;

// 0 for triangles up to about 16 times as wide as the mean, and another class for each factor of 16
// beyond. `mean` is the mean exponent of all.
std::uint64_t width_class(int exponent, int mean) {
  return static_cast<std::uint64_t>(std::clamp((exponent - mean) / 4, 0, (1 << kClassBits) - 1));
}

// The number of the cell of a coordinate along an axis that is divided into `cells` from `lower` to
// `upper`. Halves, because a difference of large doubles may overflow.
std::uint64_t cell_of(double x, double lower, double upper, double cells) {
  const double extent = 0.5 * upper - 0.5 * lower;
  if (!(extent > 0)) return 0;
  return static_cast<std::uint64_t>(
      std::clamp((0.5 * x - 0.5 * lower) / extent * cells, 0.0, cells - 1));
}

Vec3d middle_of(const Box& b) { return 0.5 * b.lower + 0.5 * b.upper; }

// What the boxes of items are like: the sum of the exponents of their widths, and the box around
// their middles.
struct BoxSurvey {
  std::int64_t exponents = 0;
  Box middles = empty_box();

  void add(const Box& box) {
    exponents += width_exponent(box);
    include(middles, middle_of(box));
  }
  void add(const BoxSurvey& other) {
    exponents += other.exponents;
    include(middles, other.middles);
  }
};

// Sorts items along the curve: single triangles, or runs of consecutive ones. A key has a
// class of width, a Morton code, and the number of the item in its lower bits, so keys are unique
// and their order does not depend on the algorithm.
class FacetOrder {
 public:
  // Precondition: the mesh has triangles.
  explicit FacetOrder(const IndexedMesh& mesh)
      : mesh_(mesh),
        in_item_(triangles_together(mesh)),
        keys_(mesh.triangle_count() / in_item_),
        index_bits_(static_cast<int>(std::bit_width(mesh.triangle_count()))),
        axis_bits_(std::min(21, (64 - kClassBits - index_bits_) / 3)) {
    for_each_index(keys_.size(), [&](std::size_t i) { keys_[i] = i; });
    const BoxSurvey survey = survey_boxes();
    mean_exponent_ = static_cast<int>(survey.exponents / static_cast<std::int64_t>(keys_.size()));
    sort(0, keys_.size(), survey.middles);
  }

  // The triangles in order. If the last few of the mesh are less than an item, they come last.
  Buffer<std::uint32_t> triangles() const {
    Buffer<std::uint32_t> order(mesh_.triangle_count());
    for_each_index(keys_.size(), [&](std::size_t place) {
      for (std::size_t k = 0; k < in_item_; ++k) {
        order[in_item_ * place + k] = static_cast<std::uint32_t>(in_item_ * item(place) + k);
      }
    });
    for (std::size_t t = in_item_ * keys_.size(); t < order.size(); ++t) {
      order[t] = static_cast<std::uint32_t>(t);
    }
    return order;
  }

 private:
  BoxSurvey survey_boxes() const {
    const auto add = [&](std::size_t place, BoxSurvey& survey) { survey.add(box_at(place)); };
    const auto join = [](BoxSurvey a, const BoxSurvey& b) {
      a.add(b);
      return a;
    };
    return reduce_all(keys_.size(), BoxSurvey{}, add, join);
  }

  std::size_t item(std::size_t place) const {
    return keys_[place] & ((std::uint64_t{1} << index_bits_) - 1);
  }
  Box box_at(std::size_t place) const {
    const std::size_t first = in_item_ * item(place);
    return box_of_triangles(mesh_, first, first + in_item_);
  }
  std::uint64_t code(std::size_t place) const { return keys_[place] >> index_bits_; }

  // Sorts the keys from `first` to `end` by the cells in which the middles of the boxes lie. The
  // cells are those of `all`, the box of all these middles, 2^axis_bits_ along each axis.
  void sort(std::size_t first, std::size_t end, const Box& all) {
    const double cells = std::ldexp(1.0, axis_bits_);
    for_all(end - first, [&](std::size_t i) {
      const Box box = box_at(first + i);
      const Vec3d p = middle_of(box);
      const auto cell = [&](int axis) {
        return cell_of(p[axis], all.lower[axis], all.upper[axis], cells);
      };
      const std::uint64_t wide = width_class(width_exponent(box), mean_exponent_);
      const std::uint64_t key = wide << 3 * axis_bits_ | morton_code(cell(0), cell(1), cell(2));
      keys_[first + i] = key << index_bits_ | item(first + i);
    });
    sort_keys({keys_.data() + first, end - first}, index_bits_);
    sort_runs(first, end);
  }

  Box box_of_middles(std::size_t first, std::size_t end) const {
    const auto add = [&](std::size_t i, Box& box) { include(box, middle_of(box_at(first + i))); };
    const auto join = [](Box a, const Box& b) {
      include(a, b);
      return a;
    };
    return reduce_all(end - first, empty_box(), add, join);
  }

  // Sorts again each run of keys with one code. A run is shorter than what it is part of, or
  // nothing tells its items apart, so this ends.
  void sort_runs(std::size_t first, std::size_t end) {
    std::vector<std::pair<std::size_t, std::size_t>> runs;
    for (std::size_t i = first, next = first; i < end; i = next) {
      while (next < end && code(next) == code(i)) ++next;
      if (in_item_ * (next - i) > kUnsorted && next - i < end - first) runs.push_back({i, next});
    }
    const auto sort_run = [&](std::size_t r) {
      const auto [begin, past] = runs[r];
      sort(begin, past, box_of_middles(begin, past));
    };
    for_all(runs.size(), sort_run, 1);
  }

  const IndexedMesh& mesh_;
  std::size_t in_item_;         // triangles of an item
  Buffer<std::uint64_t> keys_;  // one for each item
  int index_bits_, axis_bits_;
  int mean_exponent_ = 0;
};

}  // namespace

FacetTree::FacetTree(const IndexedMesh& mesh, const Buffer<std::uint32_t>& hubs) : hubs_(hubs) {
  if (mesh.triangles.empty()) return;
  order_ = FacetOrder(mesh).triangles();  // the keys are freed before the nodes are made
  make_bottom(mesh);
  make_levels();
}

void FacetTree::Node::set(std::size_t child, const Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    lower[axis][child] = box.lower[axis];
    upper[axis][child] = box.upper[axis];
  }
}

// The box around the boxes of all children.
Box FacetTree::Node::all() const {
  Box box = empty_box();
  for (std::size_t child = 0; child < kWidth; ++child) {
    include(box, Box{{lower[0][child], lower[1][child], lower[2][child]},
                     {upper[0][child], upper[1][child], upper[2][child]}});
  }
  return box;
}

// Makes the nodes above the leaves. The boxes of leaves that are not there stay empty.
void FacetTree::make_bottom(const IndexedMesh& mesh) {
  Buffer<Node> nodes(block_count(order_.size(), kLeaf * kWidth));
  for_all(nodes.size(), [&](std::size_t n) {
    for (std::size_t child = 0; child < kWidth; ++child) {
      const std::size_t first = kLeaf * (kWidth * n + child);
      LaneBox around;
      for (std::size_t i = first; i < std::min(first + kLeaf, order_.size()); ++i) {
        if (!is_left_out(order_[i])) around.include(mesh, order_[i]);
      }
      nodes[n].set(child, around.box());
    }
  });
  levels_.push_back(std::move(nodes));
}

// Makes all other levels. The boxes of nodes that are not there stay empty.
void FacetTree::make_levels() {
  while (levels_.back().size() > 1) {
    const Buffer<Node>& below = levels_.back();
    Buffer<Node> nodes(block_count(below.size(), kWidth));
    for_each_index(nodes.size(), [&](std::size_t n) {
      for (std::size_t child = 0; child < kWidth; ++child) {
        const std::size_t node = kWidth * n + child;
        nodes[n].set(child, node < below.size() ? below[node].all() : empty_box());
      }
    });
    levels_.push_back(std::move(nodes));
  }
}

}  // namespace vdwmesh

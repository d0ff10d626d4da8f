// Construction of BoxTree, a bounding volume hierarchy in Morton order, on all cores. The steps and
// the formulas are in box_tree_build.hpp, the search in box_tree_view.hpp.
//
// Every step is parallel over its output, and the sort keys are unique, so the tree is the same for
// any number of threads.
#include "analysis/distances/distances_tree.hpp"

#include "analysis/distances/box_tree_build.hpp"
#include "core/blocks.hpp"
#include "core/fixed_blocks.hpp"
#include "core/order/sort_keys.hpp"

namespace vdwmesh {
namespace {

// Makes the nodes over `count` children.
template <class BoxOf>
Buffer<BoxNode> make_level(std::size_t count, const BoxOf& scaled_box_of) {
  Buffer<BoxNode> nodes(nodes_over(count));
  for_all(nodes.size(), [&](std::size_t n) { nodes[n] = node_over(n, count, scaled_box_of); });
  return nodes;
}

}  // namespace

BoxTree::BoxTree(std::uint32_t count, const Box& world,
                 const std::function<Box(std::uint32_t)>& box_of)
    : view_(view_in(world)) {
  sort(count, box_of);
  make_levels(box_of);
  view_.order = order_.data();
  view_.level_count = static_cast<int>(levels_.size());
  for (std::size_t l = 0; l < levels_.size(); ++l) view_.levels[l] = levels_[l].data();
}

void BoxTree::sort(std::uint32_t count, const std::function<Box(std::uint32_t)>& box_of) {
  const MortonKeys morton(count);
  Buffer<std::uint64_t> keys(count);
  for_all(count, [&](std::size_t i) {
    keys[i] = morton.key(i, scaled(view_, middle(box_of(static_cast<std::uint32_t>(i)))));
  });
  sort_keys({keys.data(), keys.size()}, morton.index_bits());
  order_.resize(count);
  for_each_index(count, [&](std::size_t i) { order_[i] = morton.index(keys[i]); });
}

void BoxTree::make_levels(const std::function<Box(std::uint32_t)>& box_of) {
  levels_.push_back(
      make_level(order_.size(), [&](std::size_t i) { return scaled(view_, box_of(order_[i])); }));
  while (levels_.back().size() > 1) {
    const Buffer<BoxNode>& below = levels_.back();
    levels_.push_back(
        make_level(below.size(), [&](std::size_t i) { return vdwmesh::box_of(below[i]); }));
  }
}

}  // namespace vdwmesh

// Builds box trees on the device: a thread for each key, CUB's radix sort, and then a thread for
// each node, level by level.
#include <cub/device/device_radix_sort.cuh>

#include "analysis/distances/box_tree_build.hpp"
#include "cuda/distances/device_tree.cuh"
#include "cuda/memory/cub_calls.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/transfer.cuh"

namespace vdwmesh::distance {
namespace {

constexpr unsigned kThreads = 256;

// The boxes of the primitives, Å.
struct TriangleBoxes {
  SoupView mesh;
  __device__ Box operator()(std::uint32_t t) const { return box_of(mesh(t)); }
};
struct BallBoxes {
  const Sphere* balls;
  __device__ Box operator()(std::uint32_t i) const { return box_of(balls[i]); }
};

// The scaled boxes of the children of a level: of primitives in Morton order, or of nodes.
template <class BoxOf>
struct PrimitiveChildren {
  BoxTreeView tree;
  BoxOf primitive_box;
  __device__ Box operator()(std::uint64_t i) const {
    return scaled(tree, primitive_box(tree.order[i]));
  }
};
struct NodeChildren {
  const BoxNode* nodes;
  __device__ Box operator()(std::uint64_t i) const { return box_of(nodes[i]); }
};

// A thread for each primitive.
template <class BoxOf>
__global__ void make_keys(BoxTreeView tree, MortonKeys morton, BoxOf primitive_box,
                          std::uint32_t count, std::uint64_t* keys) {
  const std::uint64_t i = thread_index();
  if (i >= count) return;
  const Box box = primitive_box(static_cast<std::uint32_t>(i));
  keys[i] = morton.key(i, scaled(tree, middle(box)));
}

// Writes the primitives in the order of their sorted keys. A thread for each.
__global__ void take_indices(MortonKeys morton, const std::uint64_t* keys, std::uint32_t count,
                             std::uint32_t* order) {
  const std::uint64_t i = thread_index();
  if (i < count) order[i] = morton.index(keys[i]);
}

// A thread for each node over `count` children.
template <class Children>
__global__ void make_nodes(Children scaled_box_of, std::uint64_t count, BoxNode* nodes) {
  const std::uint64_t n = thread_index();
  if (n < nodes_over(count)) nodes[n] = node_over(n, count, scaled_box_of);
}

template <class Children>
DeviceArray<BoxNode> make_level(const Children& scaled_box_of, std::uint64_t count,
                                const Stream& stream) {
  DeviceArray<BoxNode> nodes(nodes_over(count), stream);
  launch("make_nodes", make_nodes<Children>, over(nodes.size(), kThreads), stream, scaled_box_of,
         count, nodes.data());
  return nodes;
}

}  // namespace

DeviceSoup::DeviceSoup(const IndexedMesh& mesh, const Stream& stream)
    : positions_(mesh.vertex_count(), stream), vertices_(3 * mesh.triangle_count(), stream) {
  static_assert(sizeof(Triangle) == 3 * sizeof(std::uint32_t));
  upload_parts({{positions_.data(), mesh.positions.data(), positions_.bytes()},
                {vertices_.data(), mesh.triangles.data(), vertices_.bytes()}},
               stream);
}

SoupView DeviceSoup::view() const {
  return {positions_.data(), vertices_.data(), static_cast<std::uint32_t>(vertices_.size() / 3),
          positions_.size()};
}

DeviceBoxTree::DeviceBoxTree(const SoupView& mesh, const Box& world, const Stream& stream)
    : view_(view_in(world)) {
  build(mesh.triangle_count, TriangleBoxes{mesh}, stream);
}

DeviceBoxTree::DeviceBoxTree(const Sphere* balls, std::uint32_t count, const Box& world,
                             const Stream& stream)
    : view_(view_in(world)) {
  build(count, BallBoxes{balls}, stream);
}

template <class BoxOf>
void DeviceBoxTree::build(std::uint32_t count, const BoxOf& box_of, const Stream& stream) {
  sort(count, box_of, stream);
  view_.order = order_.data();
  levels_.push_back(make_level(PrimitiveChildren<BoxOf>{view_, box_of}, count, stream));
  while (levels_.back().size() > 1) {
    const DeviceArray<BoxNode>& below = levels_.back();
    levels_.push_back(make_level(NodeChildren{below.data()}, below.size(), stream));
  }
  view_.level_count = static_cast<int>(levels_.size());
  for (std::size_t l = 0; l < levels_.size(); ++l) view_.levels[l] = levels_[l].data();
}

template <class BoxOf>
void DeviceBoxTree::sort(std::uint32_t count, const BoxOf& box_of, const Stream& stream) {
  const MortonKeys morton(count);
  const DeviceArray<std::uint64_t> keys(count, stream), sorted(count, stream);
  launch("make_keys", make_keys<BoxOf>, over(count, kThreads), stream, view_, morton, box_of, count,
         keys.data());
  run_cub("sort primitives", stream, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceRadixSort::SortKeys(scratch, bytes, keys.data(), sorted.data(),
                                          std::uint64_t{count}, 0, 64, stream.get());
  });
  order_ = DeviceArray<std::uint32_t>(count, stream);
  launch("take_indices", take_indices, over(count, kThreads), stream, morton, sorted.data(), count,
         order_.data());
}

}  // namespace vdwmesh::distance

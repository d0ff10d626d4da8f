// Vertices, a block of threads per brick.
#include <algorithm>

#include "cuda/blended_atoms.cuh"
#include "cuda/brick_block.cuh"
#include "cuda/extract_stages.cuh"
#include "cuda/union_surface.cuh"
#include "extract/sampled_formulas.hpp"

namespace vdwmesh {
namespace {

// Writes vertex(n) for the vertices n of a brick, a warp at a time; all threads of the block call
// it.
template <class Vertex>
__device__ void store_all(const ActiveBrick& brick, std::uint64_t base, VertexStage* stages,
                          const DeviceMeshView& mesh, unsigned long long* clamped, Vertex vertex) {
  const unsigned warp = threadIdx.x / kWarp, lane = threadIdx.x % kWarp;
  for (std::uint32_t first = warp * kWarp; first < brick.vertices; first += blockDim.x) {
    const std::uint32_t left = brick.vertices - first;
    const unsigned count = left < kWarp ? left : kWarp;
    SurfaceVertex v{};
    if (lane < count) v = vertex(first + lane);
    if (v.clamped) atomicAdd(clamped, 1ull);
    store_vertices(stages[warp], mesh, base + first, count, v);
  }
}

// ---- the union of balls ----

struct UnionShared {
  GatherState gather;
  BrickGeometry geometry;
  ActiveBrick brick;
  std::uint32_t places[kChunk];
  EdgeList edges;
  VertexStage stages[kBrickThreads / kWarp];
};

__global__ void __launch_bounds__(kBrickThreads)
    emit_union_vertices(FieldContext f, BrickList list, DeviceMeshView mesh,
                        unsigned long long* clamped) {
  __shared__ UnionShared s;
  __shared__ UnionSurface::Item items[kChunk];
  copy_brick(&list.bricks[blockIdx.x], &s.brick, threadIdx.x, blockDim.x);
  __syncthreads();
  if (s.brick.vertices == 0) return;
  share_geometry(f.model.grid, s.brick.key, s.geometry);
  list_edges(s.brick, s.edges);
  begin_gather(f.list, s.geometry.node(0, 0, 0),
               s.geometry.node(kBrickSide, kBrickSide, kBrickSide), s.gather);
  next_chunk(f.list, s.gather, s.places, kChunk,
             [&](std::uint32_t place) { return UnionSurface::keep(f, s.geometry, place); });
  if (threadIdx.x < s.gather.gathered) {
    items[threadIdx.x] = UnionSurface::item(f, s.places[threadIdx.x]);
  }
  __syncthreads();
  const UnionSurface::Item* all = s.gather.finished ? items : nullptr;
  store_all(s.brick, list.vertices[blockIdx.x], s.stages, mesh, clamped, [&](std::uint32_t n) {
    return UnionSurface::vertex(f, s.geometry, all, s.gather.gathered,
                                s.edges.edge(s.brick.signs, n));
  });
}

// ---- blended fields ----

// The vertex where `values` stand at the ends of the edge; for_each(visit) calls
// visit(atom, rank, place) for the atoms that reach the brick, in list order.
template <FieldKind kind, class ForEach>
__device__ SurfaceVertex blended_vertex(const FieldContext& f, const NodeShape& nodes,
                                        const BrickGeometry& g, const CrossedEdge& edge,
                                        ForEach&& for_each) {
  EdgeValues values;
  for_each([&](const LocalAtom& atom, std::uint32_t rank, std::uint32_t place) {
    add_to_edge<kind>(nodes, atom, edge, rank, place, values);
  });
  const EdgePoint point = interpolate_edge(
      values.inside, values.outside, static_cast<float>(f.model.isovalue), f.model.grid.spacing);
  const Vec3d node = g.node(edge.inside[0], edge.inside[1], edge.inside[2]);
  Vec3d p = node, outward{0, 0, 0};
  p[edge.axis] = std::fma(edge.direction, point.distance, node[edge.axis]);
  outward[edge.axis] = edge.direction;
  const Vec3f local = cast<float>(p - g.node(0, 0, 0));
  const ShapeParameters<float> shape = shape_parameters<float>(f.model);
  LocalGradient gradient;
  gradient.strongest.atom = values.strongest.atom;
  for_each([&](const LocalAtom& atom, std::uint32_t rank, std::uint32_t place) {
    add_gradient<kind>(shape, atom, edge.inside, local, rank, place, gradient);
  });
  const Vec3d fall{-gradient.sum.x, -gradient.sum.y, -gradient.sum.z};
  return {p, unit_or(fall, outward), f.list.id[gradient.strongest.atom], point.clamped};
}

// An atom with only the terms that the nodes of one edge need.
template <FieldKind kind>
__device__ LocalAtom atom_at_edge(const FieldContext& f, const NodeShape& nodes,
                                  const BrickGeometry& g, const CrossedEdge& edge,
                                  const Sphere& atom) {
  LocalAtom local;
  local.scale = static_cast<float>(inverse_square_scale(f.model, atom.radius));
  for (int axis = 0; axis < 3; ++axis) {
    local.center[axis] = static_cast<float>(atom.center[axis] - g.coordinate[axis][0]);
    for (const int node : {edge.inside[axis], edge.outside[axis]}) {
      local.term[axis][node] = brick_term<kind>(f.model, nodes, g, atom, local.scale, axis, node);
    }
  }
  return local;
}

struct BlendedShared {
  GatherState gather;
  BrickGeometry geometry;
  ActiveBrick brick;
  EdgeList edges;
  VertexStage stages[kBrickThreads / kWarp];
};

// next_chunk() stops a warp's worth before its array is full.
__host__ __device__ constexpr std::uint32_t places_for(std::uint32_t atoms) {
  return atoms + kWarp < 2 * kWarp ? 2 * kWarp : atoms + kWarp;
}

// Dynamic shared memory: `room` atoms, places_for(room) places and ranks.
template <FieldKind kind>
__global__ void __launch_bounds__(kBrickThreads)
    emit_blended_vertices(FieldContext f, BrickList list, DeviceMeshView mesh,
                          unsigned long long* clamped, std::uint32_t room) {
  __shared__ BlendedShared s;
  extern __shared__ __align__(16) unsigned char dynamic[];
  auto* atoms = reinterpret_cast<LocalAtom*>(dynamic);
  auto* places = reinterpret_cast<std::uint32_t*>(atoms + room);
  std::uint32_t* ranks = places + places_for(room);
  const NodeShape nodes = node_shape(f.model);
  copy_brick(&list.bricks[blockIdx.x], &s.brick, threadIdx.x, blockDim.x);
  __syncthreads();
  if (s.brick.vertices == 0) return;
  share_geometry(f.model.grid, s.brick.key, s.geometry);
  list_edges(s.brick, s.edges);
  const Vec3d lower = s.geometry.node(0, 0, 0);
  const Vec3d upper = s.geometry.node(kBrickSide, kBrickSide, kBrickSide);
  begin_gather(f.list, lower, upper, s.gather);
  const auto reaches = [&](std::uint32_t place) {
    return reaches_brick(f.model, s.geometry, f.list.spheres[place]);
  };
  next_chunk(f.list, s.gather, places, places_for(room), reaches);
  const std::uint64_t base = list.vertices[blockIdx.x];
  if (!s.gather.finished || s.gather.gathered > room) {
    store_all(s.brick, base, s.stages, mesh, clamped, [&](std::uint32_t n) {
      const CrossedEdge edge = s.edges.edge(s.brick.signs, n);
      return blended_vertex<kind>(f, nodes, s.geometry, edge, [&](auto&& visit) {
        visit_near_box(f.list, lower, upper, [&](std::uint32_t place) {
          if (!reaches(place)) return false;
          visit(atom_at_edge<kind>(f, nodes, s.geometry, edge, f.list.spheres[place]),
                f.list.rank[place], place);
          return false;
        });
      });
    });
    return;
  }
  for (std::uint32_t k = threadIdx.x; k < s.gather.gathered; k += blockDim.x) {
    ranks[k] = f.list.rank[places[k]];
  }
  share_atoms<kind>(f, nodes, s.geometry, places, s.gather.gathered, atoms);
  store_all(s.brick, base, s.stages, mesh, clamped, [&](std::uint32_t n) {
    return blended_vertex<kind>(f, nodes, s.geometry, s.edges.edge(s.brick.signs, n),
                                [&](auto&& visit) {
                                  for (std::uint32_t k = 0; k < s.gather.gathered; ++k)
                                    visit(atoms[k], ranks[k], places[k]);
                                });
  });
}

using BlendedKernel = void (*)(FieldContext, BrickList, DeviceMeshView, unsigned long long*,
                               std::uint32_t);

BlendedKernel blended_kernel_of(FieldKind kind) {
  if (kind == FieldKind::blinn) return emit_blended_vertices<FieldKind::blinn>;
  if (kind == FieldKind::soft_object) return emit_blended_vertices<FieldKind::soft_object>;
  return emit_blended_vertices<FieldKind::inverse_squared>;
}

// Atoms of a brick in shared memory; a brick that has more visits the list for every vertex.
constexpr std::uint32_t kMostAtoms = 512;

// ---- sampled fields ----

struct SampledShared {
  ActiveBrick brick;
  EdgeList edges;
  VertexStage stages[kBrickThreads / kWarp];
};

__global__ void __launch_bounds__(kBrickThreads)
    emit_sampled_vertices(SampledFieldView field, BrickList list, DeviceMeshView mesh,
                          unsigned long long* clamped) {
  __shared__ SampledShared s;
  copy_brick(&list.bricks[blockIdx.x], &s.brick, threadIdx.x, blockDim.x);
  __syncthreads();
  if (s.brick.vertices == 0) return;
  list_edges(s.brick, s.edges);
  __syncthreads();
  const BrickIndex brick = brick_of_key(s.brick.key);
  store_all(s.brick, list.vertices[blockIdx.x], s.stages, mesh, clamped, [&](std::uint32_t n) {
    const CrossedEdge edge = s.edges.edge(s.brick.signs, n);
    const LatticeNode inside = lattice_node(brick, edge.inside);
    Vec3d node{};
    for (int axis = 0; axis < 3; ++axis) {
      node[axis] = lattice_coordinate(field.grid, axis, inside.index[axis]);
    }
    return sampled_vertex(field, brick, edge, node);
  });
}

}  // namespace

void emit_vertices_on_device(const FieldContext& f, const CountedBricks& counted,
                             const DeviceMeshView& mesh, unsigned long long* clamped,
                             const Stream& stream) {
  const BrickList bricks = counted.list();
  if (bricks.size == 0) return;
  const auto blocks = static_cast<unsigned>(bricks.size);
  if (f.model.kind == FieldKind::vdw) {
    emit_union_vertices<<<blocks, kBrickThreads, 0, stream.get()>>>(f, bricks, mesh, clamped);
    check_launch("emit_union_vertices");
    return;
  }
  const BlendedKernel kernel = blended_kernel_of(f.model.kind);
  const std::uint32_t room = std::min(counted.totals.most_atoms, kMostAtoms);
  const std::size_t bytes = room * sizeof(LocalAtom) + places_for(room) * 2 * sizeof(std::uint32_t);
  check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                  static_cast<int>(bytes)),
             "shared memory");
  kernel<<<blocks, kBrickThreads, bytes, stream.get()>>>(f, bricks, mesh, clamped, room);
  check_launch("emit_blended_vertices");
}

void emit_sampled_vertices_on_device(const SampledFieldView& field, const CountedBricks& counted,
                                     const DeviceMeshView& mesh, unsigned long long* clamped,
                                     const Stream& stream) {
  const BrickList bricks = counted.list();
  if (bricks.size == 0) return;
  emit_sampled_vertices<<<static_cast<unsigned>(bricks.size), kBrickThreads, 0, stream.get()>>>(
      field, bricks, mesh, clamped);
  check_launch("emit_sampled_vertices");
}

}  // namespace vdwmesh

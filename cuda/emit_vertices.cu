// Vertices, a block of threads per brick.
#include <algorithm>

#include "cuda/brick_block.cuh"
#include "cuda/extract_stages.cuh"
#include "cuda/union_surface.cuh"
#include "extract/local_atom.hpp"
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

constexpr std::uint32_t kPlaces = 512;  // gathered at a time

struct UnionShared {
  GatherState gather;
  BrickGeometry geometry;
  ActiveBrick brick;
  std::uint32_t places[kPlaces];
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
  next_chunk(f.list, s.gather, s.places, kPlaces,
             [&](std::uint32_t place) { return UnionSurface::keep(f, s.geometry, place); });
  if (threadIdx.x < min(s.gather.gathered, kChunk)) {
    items[threadIdx.x] = UnionSurface::item(f, s.places[threadIdx.x]);
  }
  __syncthreads();
  const bool fit = s.gather.finished && s.gather.gathered <= kChunk;
  const UnionSurface::Item* all = fit ? items : nullptr;
  store_all(s.brick, list.before[blockIdx.x].vertices, s.stages, mesh, clamped,
            [&](std::uint32_t n) {
              return UnionSurface::vertex(f, s.geometry, all, s.gather.gathered,
                                          s.edges.edge(s.brick.signs, n));
            });
}

// ---- blended fields ----

// What a vertex needs of an atom.
struct alignas(16) VertexAtom {
  float center[3];  // Å, from the brick's node 0
  float scale;
  std::int32_t cell[3];  // of its sub-grid
  std::uint32_t rank;
};

__device__ VertexAtom vertex_atom(const FieldContext& f, const BrickGeometry& g,
                                  std::uint32_t place) {
  const Sphere& atom = f.list.spheres[place];
  VertexAtom a{};
  a.scale = static_cast<float>(inverse_square_scale(f.model, atom.radius));
  a.rank = f.list.rank[place];
  for (int axis = 0; axis < 3; ++axis) {
    a.center[axis] = static_cast<float>(atom.center[axis] - g.coordinate[axis][0]);
    if (f.model.truncation != Truncation::subgrid) continue;
    a.cell[axis] = static_cast<std::int32_t>(subgrid_cell(f.model.grid, axis, atom.center[axis]));
  }
  return a;
}

// False where the sub-grid of the atom ends before the node.
__device__ bool reaches_node(const FieldModel& m, const VertexAtom& a, const LatticeNode& node) {
  if (m.truncation != Truncation::subgrid) return true;
  bool reaches = true;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t away = node.index[axis] - 1 - a.cell[axis];
    reaches &= away >= -m.subgrid_cells && away <= m.subgrid_cells;
  }
  return reaches;
}

// What the atom alone adds to a node. Hardly ever called, so not inlined.
template <FieldKind kind>
__device__ __noinline__ float value_at_node(const FieldContext& f, const BrickGeometry& g,
                                            std::uint32_t place, float scale, const int node[3]) {
  const NodeShape nodes = node_shape(f.model);
  const Sphere& atom = f.list.spheres[place];
  AxisTerm term[3];
  for (int axis = 0; axis < 3; ++axis) {
    term[axis] = brick_term<kind>(f.model, nodes, g, atom, scale, axis, node[axis]);
  }
  return add_atom<kind>(nodes, row_term<kind>(nodes, term[1], term[2]), term[0], scale, 0.0f);
}

// `values` are those of the brick's nodes; for_each(visit) calls visit(atom, place) for the atoms
// that reach the brick, in list order.
template <FieldKind kind, class ForEach>
__device__ SurfaceVertex blended_vertex(const FieldContext& f, const BrickGeometry& g,
                                        const float* values, const CrossedEdge& edge,
                                        ForEach&& for_each) {
  const auto value = [&](const int node[3]) {
    return values[(node[2] * kBrickReach + node[1]) * kBrickReach + node[0]];
  };
  SurfaceVertex v =
      vertex_between(value(edge.inside), value(edge.outside), static_cast<float>(f.model.isovalue),
                     f.model.grid, edge, g.node(edge.inside[0], edge.inside[1], edge.inside[2]));
  const Vec3f local = cast<float>(v.position - g.node(0, 0, 0));
  const LatticeNode inside = lattice_node(g.brick, edge.inside);
  const ShapeParameters<float> shape = shape_parameters<float>(f.model);
  LocalGradient gradient;
  for_each([&](const VertexAtom& a, std::uint32_t place) {
    if (!reaches_node(f.model, a, inside)) return;
    add_gradient<kind>(shape, local - Vec3f{a.center[0], a.center[1], a.center[2]}, a.scale, a.rank,
                       place, gradient);
  });
  // Where no atom reaches the vertex, the strongest at its inside end.
  if (!(gradient.strongest.value > 0)) {
    for_each([&](const VertexAtom& a, std::uint32_t place) {
      const float alone = value_at_node<kind>(f, g, place, a.scale, edge.inside);
      gradient.strongest.meet(alone, a.rank, place);
    });
  }
  v.normal = outward_normal(gradient, v);
  v.sphere = f.list.id[gradient.strongest.atom];
  return v;
}

struct BlendedShared {
  GatherState gather;
  BrickGeometry geometry;
  ActiveBrick brick;
  EdgeList edges;
  VertexStage stages[kBrickThreads / kWarp];
};

// next_chunk() stops when less than a block's worth is free in its array.
__host__ __device__ constexpr std::uint32_t places_for(std::uint32_t atoms) {
  return atoms + kBrickThreads;
}

// Dynamic shared memory: `room` atoms, enough for every brick, and places_for(room) places.
template <FieldKind kind>
__global__ void __launch_bounds__(kBrickThreads, 6)
    emit_blended_vertices(const __grid_constant__ FieldContext f, BrickList list,
                          const float* values, DeviceMeshView mesh, unsigned long long* clamped,
                          std::uint32_t room) {
  __shared__ BlendedShared s;
  extern __shared__ __align__(16) unsigned char dynamic[];
  auto* atoms = reinterpret_cast<VertexAtom*>(dynamic);
  auto* places = reinterpret_cast<std::uint32_t*>(atoms + room);
  copy_brick(&list.bricks[blockIdx.x], &s.brick, threadIdx.x, blockDim.x);
  __syncthreads();
  if (s.brick.vertices == 0) return;
  share_geometry(f.model.grid, s.brick.key, s.geometry);
  list_edges(s.brick, s.edges);
  const Vec3d lower = s.geometry.node(0, 0, 0);
  const Vec3d upper = s.geometry.node(kBrickSide, kBrickSide, kBrickSide);
  begin_gather(f.list, lower, upper, s.gather);
  next_chunk(f.list, s.gather, places, places_for(room), [&](std::uint32_t place) {
    return reaches_brick(f.model, s.geometry, f.list.spheres[place]);
  });
  const std::uint64_t base = list.before[blockIdx.x].vertices;
  const float* const own = values + static_cast<std::uint64_t>(blockIdx.x) * kBrickValues;
  for (std::uint32_t k = threadIdx.x; k < s.gather.gathered; k += blockDim.x) {
    atoms[k] = vertex_atom(f, s.geometry, places[k]);
  }
  __syncthreads();
  store_all(s.brick, base, s.stages, mesh, clamped, [&](std::uint32_t n) {
    const CrossedEdge edge = s.edges.edge(s.brick.signs, n);
    return blended_vertex<kind>(f, s.geometry, own, edge, [&](auto&& visit) {
      for (std::uint32_t k = 0; k < s.gather.gathered; ++k) visit(atoms[k], places[k]);
    });
  });
}

// The same with any number of atoms near a brick: every vertex visits the list.
template <FieldKind kind>
__global__ void __launch_bounds__(kBrickThreads)
    emit_crowded_vertices(const __grid_constant__ FieldContext f, BrickList list,
                          const float* values, DeviceMeshView mesh, unsigned long long* clamped,
                          std::uint32_t) {
  __shared__ BlendedShared s;
  copy_brick(&list.bricks[blockIdx.x], &s.brick, threadIdx.x, blockDim.x);
  __syncthreads();
  if (s.brick.vertices == 0) return;
  share_geometry(f.model.grid, s.brick.key, s.geometry);
  list_edges(s.brick, s.edges);
  __syncthreads();
  const Vec3d lower = s.geometry.node(0, 0, 0);
  const Vec3d upper = s.geometry.node(kBrickSide, kBrickSide, kBrickSide);
  const float* const own = values + static_cast<std::uint64_t>(blockIdx.x) * kBrickValues;
  const std::uint64_t base = list.before[blockIdx.x].vertices;
  store_all(s.brick, base, s.stages, mesh, clamped, [&](std::uint32_t n) {
    const CrossedEdge edge = s.edges.edge(s.brick.signs, n);
    return blended_vertex<kind>(f, s.geometry, own, edge, [&](auto&& visit) {
      visit_near_box(f.list, lower, upper, [&](std::uint32_t place) {
        if (!reaches_brick(f.model, s.geometry, f.list.spheres[place])) return false;
        visit(vertex_atom(f, s.geometry, place), place);
        return false;
      });
    });
  });
}

using BlendedKernel = void (*)(FieldContext, BrickList, const float*, DeviceMeshView,
                               unsigned long long*, std::uint32_t);

// Atoms of a brick that fit in shared memory.
constexpr std::uint32_t kMostAtoms = 1024;

template <FieldKind kind>
BlendedKernel blended_kernel(std::uint32_t most_atoms) {
  return most_atoms <= kMostAtoms ? emit_blended_vertices<kind> : emit_crowded_vertices<kind>;
}

BlendedKernel blended_kernel_of(FieldKind kind, std::uint32_t most_atoms) {
  if (kind == FieldKind::blinn) return blended_kernel<FieldKind::blinn>(most_atoms);
  if (kind == FieldKind::soft_object) return blended_kernel<FieldKind::soft_object>(most_atoms);
  return blended_kernel<FieldKind::inverse_squared>(most_atoms);
}

// ---- sampled fields ----

struct SampledShared {
  ActiveBrick brick;
  EdgeList edges;
  VertexStage stages[kBrickThreads / kWarp];
};

template <DeviceNormals normals>
__global__ void __launch_bounds__(kBrickThreads, 12)
    emit_sampled_vertices(SampledFieldView field, BrickList list, DeviceMeshView mesh,
                          unsigned long long* clamped) {
  __shared__ SampledShared s;
  copy_brick(&list.bricks[blockIdx.x], &s.brick, threadIdx.x, blockDim.x);
  __syncthreads();
  if (s.brick.vertices == 0) return;
  list_edges(s.brick, s.edges);
  __syncthreads();
  const BrickIndex brick = brick_of_key(s.brick.key);
  store_all(s.brick, list.before[blockIdx.x].vertices, s.stages, mesh, clamped,
            [&](std::uint32_t n) {
              const CrossedEdge edge = s.edges.edge(s.brick.signs, n);
              const LatticeNode inside = lattice_node(brick, edge.inside);
              Vec3d node{};
              for (int axis = 0; axis < 3; ++axis) {
                node[axis] = lattice_coordinate(field.grid, axis, inside.index[axis]);
              }
              SurfaceVertex v = sampled_vertex(field, brick, edge, node);
              if constexpr (normals == DeviceNormals::gradients) {
                v.normal = sampled_normal(field, brick, edge, v);
              }
              return v;
            });
}

}  // namespace

void emit_vertices_on_device(const FieldContext& f, const BrickList& bricks,
                             std::uint32_t most_atoms, const float* values,
                             const DeviceMeshView& mesh, unsigned long long* clamped,
                             const Stream& stream) {
  if (bricks.size == 0) return;
  const auto blocks = static_cast<unsigned>(bricks.size);
  if (f.model.kind == FieldKind::vdw) {
    emit_union_vertices<<<blocks, kBrickThreads, 0, stream.get()>>>(f, bricks, mesh, clamped);
    check_launch("emit_union_vertices");
    return;
  }
  const BlendedKernel kernel = blended_kernel_of(f.model.kind, most_atoms);
  const std::uint32_t room = std::min(most_atoms, kMostAtoms);
  const std::size_t bytes = room * sizeof(VertexAtom) + places_for(room) * sizeof(std::uint32_t);
  check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                  static_cast<int>(bytes)),
             "shared memory");
  kernel<<<blocks, kBrickThreads, bytes, stream.get()>>>(f, bricks, values, mesh, clamped, room);
  check_launch("emit_blended_vertices");
}

void emit_sampled_vertices_on_device(const SampledFieldView& field, const CountedBricks& counted,
                                     const DeviceMeshView& mesh, unsigned long long* clamped,
                                     const Stream& stream) {
  const BrickList bricks = counted.list();
  if (bricks.size == 0) return;
  const auto kernel = mesh.normals ? emit_sampled_vertices<DeviceNormals::gradients>
                                   : emit_sampled_vertices<DeviceNormals::none>;
  kernel<<<static_cast<unsigned>(bricks.size), kBrickThreads, 0, stream.get()>>>(field, bricks,
                                                                                 mesh, clamped);
  check_launch("emit_sampled_vertices");
}

}  // namespace vdwmesh

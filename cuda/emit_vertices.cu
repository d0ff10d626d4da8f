// Vertices, a block of threads per brick.
#include "cuda/brick_block.cuh"
#include "cuda/brick_surface.cuh"
#include "cuda/extract_stages.cuh"

namespace vdwmesh {
namespace {

constexpr int kMostVertices = 3 * kBrickNodes;

struct VertexShared {
  GatherState gather;
  BrickGeometry geometry;
  ActiveBrick brick;
  std::uint32_t places[kChunk];
  std::uint16_t edge[kMostVertices];  // of each vertex: row * 32 + x * 4 + axis
};

// Lists the crossed edges in the order of their vertices, a row per thread.
__device__ void list_edges(VertexShared& s) {
  if (threadIdx.x < kOwnRows) {
    const int y = static_cast<int>(threadIdx.x) % kBrickSide;
    const int z = static_cast<int>(threadIdx.x) / kBrickSide;
    const RowCrossings c = row_crossings(s.brick.signs, y, z);
    int next = s.brick.row_vertices[threadIdx.x];
    for (int x = 0; x < kBrickSide; ++x) {
      for (int axis = 0; axis < 3; ++axis) {
        if ((c.along[axis] >> x & 1) == 0) continue;
        const unsigned code = threadIdx.x * 32 + static_cast<unsigned>(x * 4 + axis);
        s.edge[next++] = static_cast<std::uint16_t>(code);
      }
    }
  }
  __syncthreads();
}

template <class Surface>
__global__ void __launch_bounds__(kBrickThreads)
    emit_vertices(FieldContext f, BrickList list, DeviceMeshView mesh,
                  unsigned long long* clamped) {
  __shared__ VertexShared s;
  __shared__ typename Surface::Item items[kChunk];
  copy_brick(&list.bricks[blockIdx.x], &s.brick);
  __syncthreads();
  if (s.brick.vertices == 0) return;
  share_geometry(f.model.grid, s.brick.key, s.geometry);
  list_edges(s);
  begin_gather(f.list, s.geometry.node(0, 0, 0),
               s.geometry.node(kBrickSide, kBrickSide, kBrickSide), s.gather);
  next_chunk(f.list, s.gather, s.places, kChunk,
             [&](std::uint32_t place) { return Surface::keep(f, s.geometry, place); });
  if (threadIdx.x < s.gather.gathered) {
    items[threadIdx.x] = Surface::item(f, s.geometry, s.places[threadIdx.x]);
  }
  __syncthreads();
  const typename Surface::Item* all = s.gather.finished ? items : nullptr;
  const std::uint64_t base = list.vertices[blockIdx.x];
  for (std::uint32_t n = threadIdx.x; n < s.brick.vertices; n += kBrickThreads) {
    const int code = s.edge[n];
    const int axis = code & 3, x = code >> 2 & 7, y = code >> 5 & 7, z = code >> 8;
    const bool inside = (s.brick.signs.row[z][y] >> x & 1) != 0;
    const SurfaceVertex v =
        Surface::vertex(f, s.geometry, all, s.gather.gathered, crossed_edge(inside, x, y, z, axis));
    mesh.positions[base + n] = v.position;
    mesh.normals[base + n] = v.normal;
    mesh.vertex_spheres[base + n] = on_sphere(v.sphere);
    if (v.clamped) atomicAdd(clamped, 1ull);
  }
}

using VertexKernel = void (*)(FieldContext, BrickList, DeviceMeshView, unsigned long long*);

VertexKernel kernel_of(FieldKind kind) {
  switch (kind) {
    case FieldKind::vdw:
      return emit_vertices<UnionSurface>;
    case FieldKind::blinn:
      return emit_vertices<BlendedSurface<FieldKind::blinn>>;
    case FieldKind::soft_object:
      return emit_vertices<BlendedSurface<FieldKind::soft_object>>;
    default:
      return emit_vertices<BlendedSurface<FieldKind::inverse_squared>>;
  }
}

}  // namespace

void emit_vertices_on_device(const FieldContext& f, const BrickList& bricks,
                             const DeviceMeshView& mesh, unsigned long long* clamped,
                             const Stream& stream) {
  if (bricks.size == 0) return;
  kernel_of(f.model.kind)<<<static_cast<unsigned>(bricks.size), kBrickThreads, 0, stream.get()>>>(
      f, bricks, mesh, clamped);
  check_launch("emit_vertices");
}

}  // namespace vdwmesh

// Positions, normals and labels of the vertices, with one warp per brick and one vertex per lane at
// a time. A lane finds the edge of its vertex from the brick's signs (edge_of_vertex()) and
// computes the vertex with the formulas that the CPU uses; then the warp writes 32 vertices
// together (store_vertices_of()).
//
// There are three kinds of surface: the union of balls, blended fields and sampled fields (given by
// their values at the nodes). For the first two, the warp first takes the spheres near the brick,
// which counting has kept, into shared memory. If they do not fit there, every vertex searches the
// cell list itself, which gives the same bits more slowly.
#include <algorithm>
#include <bit>

#include "cuda/extract/bricks/brick_warp.cuh"
#include "cuda/extract/bricks/extract_stages.cuh"
#include "cuda/extract/bricks/kept_bricks.cuh"
#include "cuda/extract/union_surface.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/ordered_bits.cuh"
#include "extract/blended/local_atom.hpp"
#include "extract/blended/sampled_formulas.hpp"

namespace vdwmesh {
namespace {

// How many warps share a brick, as a power of two. A brick of many vertices takes a warp several
// turns, one after another. Where there are too few bricks to fill the device, more warps take a
// turn each.
using Sharers = unsigned;  // its logarithm

Sharers sharers_of(std::uint64_t bricks) {
  constexpr std::uint64_t enough_warps = 8192;  // twice what an H200 runs at a time
  Sharers log2 = 0;
  while (log2 < 2 && bricks << (log2 + 1) <= enough_warps) ++log2;
  return log2;
}

LaunchShape shape_of(std::uint64_t bricks) {
  return over(bricks << sharers_of(bricks), kBrickWarps, kBrickThreads);
}

// Index in the list of the brick that this warp works on, and which share of it is the warp's.
__device__ std::uint64_t own_warp() {
  return static_cast<std::uint64_t>(blockIdx.x) * kBrickWarps + threadIdx.x / kWarp;
}
__device__ std::uint64_t own_brick(Sharers log2) { return own_warp() >> log2; }
__device__ WarpShare own_share(Sharers log2) {
  return {static_cast<unsigned>(own_warp()) & ((1u << log2) - 1), 1u << log2};
}

// Shared memory of a warp for its brick, about 1.8 KB.
struct WarpBrick {
  ActiveBrick brick;
  BrickGeometry geometry;
  VertexStage stage;
};

// Copies the warp's brick to shared memory, two words of 8 bytes a lane. Returns false if the warp
// has nothing to do: it is beyond the end of the list, or its brick has no vertex for it.
__device__ bool load_brick(const BrickList& list, Sharers sharers, ActiveBrick& brick) {
  constexpr unsigned words = sizeof(ActiveBrick) / sizeof(std::uint64_t);
  static_assert(words > kWarp && words <= 2 * kWarp &&
                sizeof(ActiveBrick) % sizeof(std::uint64_t) == 0);
  const std::uint64_t own = own_brick(sharers);
  if (own >= list.size) return false;
  const unsigned lane = threadIdx.x % kWarp, other = lane + kWarp < words ? lane + kWarp : lane;
  const auto* const from = reinterpret_cast<const std::uint64_t*>(&list.bricks[own]);
  const std::uint64_t word = from[lane], other_word = from[other];
  load_now(word);
  load_now(other_word);
  const BrickSums* const before = list.before + own;
  const std::uint64_t first = before[0].vertices + own_share(sharers).number * kWarp;
  if (first >= before[1].vertices) return false;
  auto* const to = reinterpret_cast<std::uint64_t*>(&brick);
  to[lane] = word;
  to[other] = other_word;
  __syncwarp();
  return true;
}

// ---- the union of balls ----

// Shared memory of a warp, about 6 KB.
struct UnionShared {
  WarpBrick own;
  SharedBalls items;
};

// Writes the vertices of each brick at the indices of their numbers, and adds clamped ones to
// `clamped`. A warp per brick, 2 warps per thread block; about 12 KB of shared memory.
template <class Fields>
__global__ void __launch_bounds__(kBrickThreads)
    emit_union_vertices(const __grid_constant__ Fields fields, BrickList list, Sharers sharers,
                        const KeptUnion* kept, DeviceMeshView mesh, unsigned long long* clamped) {
  __shared__ UnionShared shared[kBrickWarps];
  UnionShared& s = shared[threadIdx.x / kWarp];
  WarpBrick& own = s.own;
  if (!load_brick(list, sharers, own.brick)) return;
  const NearPlaces<kMostSharedBalls>& kept_near = kept[own_brick(sharers)].near;
  const std::uint32_t near = kept_near.count;
  load_now(near);
  const FieldOfBlock owner = fields.of(own.brick.key);
  const FieldContext& f = owner.field;
  share_geometry(f.model.grid, owner.own_key(own.brick.key), own.geometry);
  const BrickGeometry& g = own.geometry;
  if (near <= kMostSharedBalls) s.items.load(f, g, kept_near.place, near);
  __syncwarp();
  // If there are more balls, the null pointer makes every vertex search the cell list.
  const SharedBalls* const all = near <= kMostSharedBalls ? &s.items : nullptr;
  store_vertices_of(own.brick, own_share(sharers), list.before[own_brick(sharers)].vertices,
                    own.stage, mesh, clamped,
                    [&](const CrossedEdge& edge) { return union_vertex(f, g, all, near, edge); });
}

// ---- blended fields ----

// The box around the vertices of a warp, in Å from the brick's node 0.
struct WarpBox {
  float lower[3], upper[3];

  // The square of the distance from the box to a point, by the operations of local_square(). Each
  // operation is monotone under rounding, so the result is at most local_square() of any vertex of
  // the warp less the point.
  __device__ float square_to(const float (&point)[3]) const {
    float away[3];
    for (int axis = 0; axis < 3; ++axis) {
      away[axis] = fmaxf(fmaxf(lower[axis] - point[axis], point[axis] - upper[axis]), 0.0f);
    }
    return local_square({away[0], away[1], away[2]});
  }
};

// The box around the points `local` of the lanes, which all call it.
__device__ WarpBox box_of_warp(const Vec3f& local) {
  WarpBox box{};
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = least_of_warp(local[axis]);
    box.upper[axis] = largest_of_warp(local[axis]);
  }
  return box;
}

// What the gradient and the label of a vertex need of an atom near the brick.
struct alignas(16) VertexAtom {
  float center[3];       // from the brick's node 0, Å
  float scale;           // q = d^2 * scale
  std::int32_t cell[3];  // with sub-grids: the grid cell in which the atom lies
  Rank rank;
};

__device__ VertexAtom vertex_atom(const FieldContext& f, const BrickGeometry& g, ListPlace place) {
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

// Calls visit(atom, k) for the atoms k = 0 .. count - 1, rising, for which wanted(atom) is true, on
// all lanes together. Each lane tests every 32nd atom. The votes are reversed, so that the next one
// is the highest bit that is left: to find it takes one instruction less.
template <class Wanted, class Visit>
__device__ void visit_wanted(const VertexAtom* atoms, std::uint32_t count, Wanted&& wanted,
                             Visit&& visit) {
  const unsigned lane = threadIdx.x % kWarp;
  for (std::uint32_t first = 0; first < count; first += kWarp) {
    const VertexAtom* const group = atoms + first;
    const bool own = first + lane < count && wanted(group[lane]);
    for (unsigned left = __brev(__ballot_sync(kAllLanes, own)); left != 0;) {
      const auto k = static_cast<unsigned>(__clz(static_cast<int>(left)));
      left &= ~(1u << 31 >> k);
      visit(group[k], first + k);
    }
  }
}

// Whether the node lies in the atom's sub-grid. Precondition: the field has sub-grids.
__device__ bool in_subgrid_of(const FieldModel& m, const VertexAtom& a, const LatticeNode& node) {
  bool reaches = true;
  for (int axis = 0; axis < 3; ++axis) {
    // Lattice indices are one above grid indices.
    const std::int64_t away = node.index[axis] - 1 - a.cell[axis];
    reaches &= away >= -m.subgrid_cells && away <= m.subgrid_cells;
  }
  return reaches;
}

// The contribution of the atom at list place `place` to the field's value at a node of the brick.
// It is called only if no atom contributes at a vertex, which is rare. So it is not inlined, and
// takes no registers from the common path.
template <BlendedKind Kind>
__device__ __noinline__ float value_at_node(const FieldContext& f, const BrickGeometry& g,
                                            ListPlace place, float scale, const int node[3]) {
  const NodeShape& nodes = f.nodes;
  const Sphere& atom = f.list.spheres[place];
  AxisTerm term[3];
  for (int axis = 0; axis < 3; ++axis) {
    term[axis] = brick_term<Kind>(f.model, nodes, g, atom, scale, axis, node[axis]);
  }
  return Kind::add_atom(nodes, Kind::row_term(nodes, term[1], term[2]), term[0], scale, 0.0f);
}

// The vertex on a crossed edge: where linear interpolation between the values at its ends reaches
// the isovalue. The device counterpart of BlendedBrick::vertex(). `values` are the field's values
// at the brick's nodes, x fastest. for_each(wanted, visit) calls visit(atom, item) for the atoms
// that reach the brick, in list order, on all lanes of the warp together; it may leave out atoms
// for which wanted(atom) is false. place_of(item) is the atom's list place. The label is the atom
// that contributes most at the vertex, and the normal points against the sum of the atoms'
// gradients.
template <BlendedKind Kind, class ForEach, class PlaceOf>
__device__ EdgeVertex blended_vertex(const FieldContext& f, const BrickGeometry& g,
                                     const float* values, const CrossedEdge& edge,
                                     ForEach&& for_each, PlaceOf&& place_of) {
  const auto value = [&](const int node[3]) {
    return values[(node[2] * kBrickReach + node[1]) * kBrickReach + node[0]];
  };
  EdgeVertex v =
      vertex_between(value(edge.inside), value(edge.outside), static_cast<float>(f.model.isovalue),
                     f.model.grid, edge, g.node(edge.inside[0], edge.inside[1], edge.inside[2]));
  const Vec3f local = cast<float>(v.position - g.node(0, 0, 0));
  // An atom with a sub-grid counts at the vertex if the sub-grid has the inside end of its edge.
  const LatticeNode inside = lattice_node(g.brick, edge.inside);
  const ShapeParameters<float>& shape = f.shape;
  LocalGradient gradient;
  const WarpBox box = box_of_warp(local);
  // An atom that adds nothing anywhere in the box adds nothing to any vertex of the warp.
  const auto reaches_box = [&](const VertexAtom& a) {
    return Kind::reaches(shape, box.square_to(a.center) * a.scale);
  };
  const auto add = [&](const VertexAtom& a, std::uint32_t item) {
    const Vec3f from = local - Vec3f{a.center[0], a.center[1], a.center[2]};
    add_gradient<Kind>(shape, from, a.scale, a.rank, item, gradient);
  };
  // Two loops, so that the common one does not ask about sub-grids at every atom.
  if (f.model.truncation != Truncation::subgrid) {
    for_each(reaches_box, add);
  } else {
    for_each(reaches_box, [&](const VertexAtom& a, std::uint32_t item) {
      if (in_subgrid_of(f.model, a, inside)) add(a, item);
    });
  }
  // If no atom contributes at the vertex, the label is the atom that contributes most at the inside
  // end.
  if (__any_sync(kAllLanes, !(gradient.strongest.value > 0))) {
    const bool wanting = !(gradient.strongest.value > 0);
    const auto any = [](const VertexAtom&) { return true; };
    for_each(any, [&](const VertexAtom& a, std::uint32_t item) {
      if (!wanting) return;
      const float alone = value_at_node<Kind>(f, g, place_of(item), a.scale, edge.inside);
      gradient.strongest.meet(alone, a.rank, item);
    });
  }
  v.normal = outward_normal(gradient, v);
  v.sphere = f.list.id[place_of(gradient.strongest.atom)];
  return v;
}

// Writes the vertices of each brick at the indices of their numbers, and adds clamped ones to
// `clamped`. `kept` is what counting has kept of each brick of the list. A warp per brick, 2 warps
// per thread block; the second launch bound makes 16 blocks fit on a multiprocessor. Static shared
// memory: 3.6 KB. Dynamic shared memory: for each warp `room` atoms, then for each warp room +
// kWarp list places. Precondition: no brick has more than `room` atoms. So one batch gathers all
// atoms of a brick, and `atoms` and `places` stay valid afterwards.
template <BlendedKind Kind, class Fields>
__global__ void __launch_bounds__(kBrickThreads, 16)
    emit_blended_vertices(const __grid_constant__ Fields fields, BrickList list, Sharers sharers,
                          const KeptBlended* kept, DeviceMeshView mesh, unsigned long long* clamped,
                          std::uint32_t room) {
  __shared__ WarpBrick shared[kBrickWarps];
  extern __shared__ __align__(16) unsigned char dynamic[];
  const unsigned warp = threadIdx.x / kWarp;
  auto* const atoms = reinterpret_cast<VertexAtom*>(dynamic) + warp * room;
  auto* const places =
      reinterpret_cast<ListPlace*>(reinterpret_cast<VertexAtom*>(dynamic) + kBrickWarps * room) +
      warp * (room + kWarp);
  WarpBrick& own = shared[warp];
  if (!load_brick(list, sharers, own.brick)) return;
  const FieldOfBlock owner = fields.of(own.brick.key);
  const FieldContext& f = owner.field;
  const BrickGeometry& g = own.geometry;
  share_geometry(f.model.grid, owner.own_key(own.brick.key), own.geometry);
  const NearPlaces<kKeptAtoms>& near = kept[own_brick(sharers)].near;
  const std::uint32_t met = near.count;
  const auto load = [&](std::uint32_t count) {
    for (std::uint32_t k = threadIdx.x % kWarp; k < count; k += kWarp) {
      atoms[k] = vertex_atom(f, g, places[k]);
    }
    // Never ends the gathering.
    return false;
  };
  if (met <= kKeptAtoms) {
    for (std::uint32_t k = threadIdx.x % kWarp; k < met; k += kWarp) places[k] = near.place[k];
    load(met);  // each lane has written the places that it reads
    __syncwarp();
  } else {
    gather_by_warp(f, g.node(0, 0, 0), g.node(kBrickSide, kBrickSide, kBrickSide), places, room,
                   load);
  }
  const float* const values_of_brick = kept[own_brick(sharers)].values;
  const auto for_each = [&](auto&& wanted, auto&& visit) {
    visit_wanted(atoms, met, wanted, visit);
  };
  const auto place_of = [&](std::uint32_t k) { return places[k]; };
  store_vertices_of(own.brick, own_share(sharers), list.before[own_brick(sharers)].vertices,
                    own.stage, mesh, clamped, [&](const CrossedEdge& edge) {
                      return blended_vertex<Kind>(f, g, values_of_brick, edge, for_each, place_of);
                    });
}

// The same for any number of atoms near a brick, more slowly: for every vertex the warp visits the
// cell list. No dynamic shared memory. The last parameter is unused; with it, both kernels have one
// type.
template <BlendedKind Kind, class Fields>
__global__ void __launch_bounds__(kBrickThreads)
    emit_crowded_vertices(const __grid_constant__ Fields fields, BrickList list, Sharers sharers,
                          const KeptBlended* kept, DeviceMeshView mesh, unsigned long long* clamped,
                          std::uint32_t) {
  __shared__ WarpBrick shared[kBrickWarps];
  WarpBrick& own = shared[threadIdx.x / kWarp];
  if (!load_brick(list, sharers, own.brick)) return;
  const FieldOfBlock owner = fields.of(own.brick.key);
  const FieldContext& f = owner.field;
  const BrickGeometry& g = own.geometry;
  share_geometry(f.model.grid, owner.own_key(own.brick.key), own.geometry);
  const Vec3d lower = g.node(0, 0, 0), upper = g.node(kBrickSide, kBrickSide, kBrickSide);
  const float* const values_of_brick = kept[own_brick(sharers)].values;
  const auto for_each = [&](auto&&, auto&& visit) {
    visit_near_box(f.list, lower, upper, [&](ListPlace place) {
      // Visitor of visit_near_box(): false goes on to the next sphere.
      if (!reaches_brick(f.model, g, f.list.spheres[place])) return false;
      visit(vertex_atom(f, g, place), to_index(place));
      return false;
    });
  };
  const auto place_of = [](std::uint32_t item) { return ListPlace{item}; };
  store_vertices_of(own.brick, own_share(sharers), list.before[own_brick(sharers)].vertices,
                    own.stage, mesh, clamped, [&](const CrossedEdge& edge) {
                      return blended_vertex<Kind>(f, g, values_of_brick, edge, for_each, place_of);
                    });
}

// The most atoms of a brick that are kept in shared memory. With the list places, 2 warps take 37
// KB then.
constexpr std::uint32_t kMostAtoms = 512;

// ---- sampled fields ----

// Writes the vertices of each brick at the indices of their numbers, and adds clamped ones to
// `clamped`. Reads the field's values at the ends of crossed edges and, for normals, around them. A
// warp per brick, 2 warps per thread block; about 3 KB of shared memory. The second launch bound is
// the number of blocks that must fit on a multiprocessor; normals need more registers.
template <Normals normals>
__global__ void __launch_bounds__(kBrickThreads, normals == Normals::none ? 24 : 16)
    emit_sampled_vertices(SampledFieldView field, BrickList list, Sharers sharers,
                          DeviceMeshView mesh, unsigned long long* clamped) {
  __shared__ ActiveBrick bricks[kBrickWarps];
  __shared__ VertexStage stages[kBrickWarps];
  const unsigned warp = threadIdx.x / kWarp;
  if (!load_brick(list, sharers, bricks[warp])) return;
  const BrickIndex index = brick_of_key(bricks[warp].key);
  store_vertices_of(bricks[warp], own_share(sharers), list.before[own_brick(sharers)].vertices,
                    stages[warp], mesh, clamped, [&](const CrossedEdge& edge) {
                      const LatticeNode inside = lattice_node(index, edge.inside);
                      Vec3d node{};
                      for (int axis = 0; axis < 3; ++axis) {
                        node[axis] = lattice_coordinate(field.grid, axis, inside.index[axis]);
                      }
                      const EdgeValues values = sampled_values(field, index, edge);
                      load_now(values.inside);
                      load_now(values.outside);
                      EdgeVertex v = sampled_vertex(field, values, edge, node);
                      if constexpr (normals == Normals::gradients) {
                        v.normal = sampled_normal(field, index, edge, v);
                      }
                      return v;
                    });
}

template <class Fields>
void emit_vertices(const Fields& fields, const BrickList& bricks, std::uint32_t most_atoms,
                   const void* kept, const DeviceMeshView& mesh, unsigned long long* clamped,
                   const Stream& stream) {
  LaunchShape shape = shape_of(bricks.size);
  const Sharers sharers = sharers_of(bricks.size);
  if (fields.kind() == FieldKind::vdw) {
    launch("emit_union_vertices", emit_union_vertices<Fields>, shape, stream, fields, bricks,
           sharers, static_cast<const KeptUnion*>(kept), mesh, clamped);
    return;
  }
  const std::uint32_t room = std::min(most_atoms, kMostAtoms);
  shape.shared = kBrickWarps * (room * sizeof(VertexAtom) + (room + kWarp) * sizeof(std::uint32_t));
  with_blended(fields.kind(), [&]<class Kind>(Kind) {
    const bool crowded = most_atoms > kMostAtoms;
    const auto kernel =
        crowded ? emit_crowded_vertices<Kind, Fields> : emit_blended_vertices<Kind, Fields>;
    check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize,
                                    static_cast<int>(shape.shared)),
               "shared memory");
    launch(crowded ? "emit_crowded_vertices" : "emit_blended_vertices", kernel, shape, stream,
           fields, bricks, sharers, static_cast<const KeptBlended*>(kept), mesh, clamped, room);
  });
}

}  // namespace

void emit_vertices_on_device(const OneField& fields, const BrickList& bricks,
                             std::uint32_t most_atoms, const void* kept, const DeviceMeshView& mesh,
                             unsigned long long* clamped, const Stream& stream) {
  emit_vertices(fields, bricks, most_atoms, kept, mesh, clamped, stream);
}

void emit_vertices_on_device(const FieldStack& fields, const BrickList& bricks,
                             std::uint32_t most_atoms, const void* kept, const DeviceMeshView& mesh,
                             unsigned long long* clamped, const Stream& stream) {
  emit_vertices(fields, bricks, most_atoms, kept, mesh, clamped, stream);
}

void emit_sampled_vertices_on_device(const SampledFieldView& field, const BrickList& bricks,
                                     const DeviceMeshView& mesh, unsigned long long* clamped,
                                     const Stream& stream) {
  const auto kernel = mesh.normals ? emit_sampled_vertices<Normals::gradients>
                                   : emit_sampled_vertices<Normals::none>;
  launch("emit_sampled_vertices", kernel, shape_of(bricks.size), stream, field, bricks,
         sharers_of(bricks.size), mesh, clamped);
}

}  // namespace vdwmesh

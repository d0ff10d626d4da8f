// Prepares the spheres of a field, or of a stack of fields, for searches on the device: float4
// copies of centre and reach (RoughSpheres), relative to the grid's origin. With them
// gather_by_warp() rules out spheres that do not reach a box. The copies take half the memory of
// the spheres in double. The reach is widened by more than all rounding errors, so no sphere that
// reaches a box is ruled out.
//
// The cell lists of a stack are made on the host. Their arrays are joined there, one list behind
// the other, and copied together; the addresses in each list's view follow from where it begins.
#include <tbb/parallel_for.h>

#include <algorithm>

#include "cuda/extract/bricks/extract_stages.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/transfer.cuh"
#include "extract/blended/field_formulas.hpp"
#include "extract/field_kinds.hpp"
#include "spheres/level_extent.hpp"

namespace vdwmesh {
namespace {

constexpr unsigned kFieldThreads = 256;

// `margin`: rounding_margin() of all spheres.
__device__ float4 rough_sphere(const FieldModel& model, const Sphere& s, float margin) {
  const Vec3d c = s.center - model.grid.origin;
  // With sub-grids the distance of an atom does not decide, as in reaches_box(): its reach is made
  // endless, so that it is never ruled out. 1e18 still has a finite square in float32.
  const bool endless = model.kind != FieldKind::vdw && model.truncation == Truncation::subgrid;
  const auto reach = static_cast<float>(field_reach(model, s.radius));
  return {static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z),
          endless ? 1e18f : reach * (1 + 1e-5f) + margin};
}

// Writes the float4 copy of each sphere. A thread per sphere of the list.
__global__ void round_spheres(CellListView list, FieldModel model, float margin, float4* rough) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < list.size) rough[i] = rough_sphere(model, list.spheres[ListPlace{i}], margin);
}

// The same for a stack, a thread block for each field. `rough` is where the copies of all fields
// begin, `spheres` the spheres of all fields.
__global__ void round_stack(FieldStack stack, const Sphere* spheres, float4* rough) {
  const StackedField& field = stack.fields[blockIdx.x];
  const CellListView& list = field.context.list;
  float4* const own = rough + (list.spheres.data() - spheres);
  for (std::uint32_t i = threadIdx.x; i < list.size; i += blockDim.x) {
    own[i] = rough_sphere(field.context.model, list.spheres[ListPlace{i}], field.rounding);
  }
}

// A bound, Å, on the rounding error of float32 distances between points of the grid and the spheres
// near it. All coordinates involved are at most about `extent`: the longest side of the grid plus
// the largest reach of every level. 1e-6 is 17 units of 2^-24, the relative rounding error; a
// distance takes fewer roundings.
float rounding_margin(const CellListView& list, const GridSpec& grid) {
  double extent = 0;
  for (int axis = 0; axis < 3; ++axis) {
    extent = std::max(extent, static_cast<double>(grid.cells[axis] + 2) * grid.spacing);
  }
  for (int l = 0; l < list.level_count; ++l) extent += list.levels[l].reach;
  return static_cast<float>(1e-6 * extent);
}

// ---- the shape of a stack ----

// Blocks of 2^level bricks along an axis; a block at the end may reach beyond the grid.
std::int32_t block_count(std::int64_t cells, int level) {
  return (brick_count(cells) + (1 << level) - 1) >> level;
}

// The finest level, 1 or above, of which all fields together have few blocks. Coarser blocks would
// be too few to keep the device busy, finer ones too many where the grids are mostly empty.
int first_level_of(std::span<const HostField> fields) {
  constexpr std::uint64_t for_all = 65536, for_each = 512;
  const std::uint64_t most = std::max(for_all, for_each * fields.size());
  for (int level = 1;; ++level) {
    std::uint64_t all = 0;
    for (const HostField& f : fields) {
      std::uint64_t own = 1;
      for (int axis = 0; axis < 3; ++axis) {
        own *= static_cast<std::uint64_t>(block_count(f.model.grid.cells[axis], level));
      }
      all += own;
    }
    if (all <= most) return level;
  }
}

// The layers that a field takes. One more than it has bricks stays free behind it, so that no brick
// has a neighbour of another field.
std::int64_t layer_count(const HostField& field, int level) {
  return std::int64_t{block_count(field.model.grid.cells.z + kBrickSide, level)} << level;
}

std::vector<std::int32_t> layers_of(std::span<const HostField> fields, int level) {
  std::vector<std::int32_t> first(1, 0);
  for (const HostField& f : fields) {
    first.push_back(first.back() + static_cast<std::int32_t>(layer_count(f, level)));
  }
  return first;
}

std::vector<std::uint32_t> fields_of_layers(const std::vector<std::int32_t>& first_layers) {
  std::vector<std::uint32_t> field(static_cast<std::size_t>(first_layers.back()));
  for (std::size_t f = 0; f + 1 < first_layers.size(); ++f) {
    std::fill(field.begin() + first_layers[f], field.begin() + first_layers[f + 1],
              static_cast<std::uint32_t>(f));
  }
  return field;
}

// Puts a field on top of the fields that the stack has. Its first layer is known.
void stand_on(FieldStack& stack, StackedField& field) {
  const GridSpec& grid = field.context.model.grid;
  field.first_block = stack.first_blocks;
  std::uint64_t blocks = 1;
  for (int axis = 0; axis < 3; ++axis) {
    field.blocks[axis] = block_count(grid.cells[axis], stack.first_level);
    blocks *= static_cast<std::uint64_t>(field.blocks[axis]);
    stack.bricks[axis] = std::max(stack.bricks[axis], brick_count(grid.cells[axis]));
  }
  stack.first_blocks += blocks;
  stack.field_kind = field.context.model.kind;
  ++stack.field_count;
}

// ---- the cell lists of a stack ----

std::vector<ListStart> starts_of(std::span<const HostField> fields) {
  std::vector<ListStart> starts(1, {0, 0});
  for (const HostField& f : fields) {
    std::size_t cells = 0;
    for (int l = 0; l < f.list.level_count; ++l) cells += cell_count(f.list.levels[l]) + 1;
    starts.push_back({starts.back().sphere + f.list.size, starts.back().cell + cells});
  }
  return starts;
}

// A list on the host with the addresses of its arrays on the device.
CellListView view_of(const CellListView& host, const Sphere* spheres, const Rank* rank,
                     const SphereId* id, const std::uint32_t* cell_start) {
  CellListView view = host;
  view.spheres = spheres;
  view.rank = rank;
  view.id = id;
  for (int l = 0; l < view.level_count; ++l) {
    view.levels[l].cell_start = cell_start;
    cell_start += cell_count(view.levels[l]) + 1;
  }
  return view;
}

// The arrays of all lists, joined.
struct JoinedLists {
  Buffer<Sphere> spheres;
  Buffer<Rank> rank;
  Buffer<SphereId> id;
  Buffer<std::uint32_t> cell_start;

  JoinedLists(std::span<const HostField> fields, const std::vector<ListStart>& starts)
      : spheres(starts.back().sphere),
        rank(spheres.size()),
        id(spheres.size()),
        cell_start(starts.back().cell) {
    tbb::parallel_for(std::size_t{0}, fields.size(), [&](std::size_t f) {
      const CellListView& list = fields[f].list;
      const auto first = static_cast<std::ptrdiff_t>(starts[f].sphere);
      std::copy_n(list.spheres.data(), list.size, spheres.begin() + first);
      std::copy_n(list.rank.data(), list.size, rank.begin() + first);
      std::copy_n(list.id.data(), list.size, id.begin() + first);
      auto to = cell_start.begin() + static_cast<std::ptrdiff_t>(starts[f].cell);
      for (int l = 0; l < list.level_count; ++l) {
        to = std::copy_n(list.levels[l].cell_start, cell_count(list.levels[l]) + 1, to);
      }
    });
  }
};

}  // namespace

FieldContext field_context(const CellListView& list, const FieldModel& model, const float4* rough) {
  FieldContext f{list, model, {rough, model.grid.origin}, {}, {}};
  if (model.kind == FieldKind::vdw) return f;
  f.shape = shape_parameters<float>(model);
  f.nodes = with_blended(model.kind, [&]<class Kind>(Kind) { return Kind::node_shape(model); });
  return f;
}

DeviceField::DeviceField(const CellListView& list, const FieldModel& model, const Stream& stream)
    : rough_(list.size, stream.get()), fields_{field_context(list, model, rough_.data())} {
  launch("round_spheres", round_spheres, over(list.size, kFieldThreads), stream, list, model,
         rounding_margin(list, model.grid), rough_.data());
}

// Keys have 21 bits for the layer.
bool can_stack(std::span<const HostField> fields) {
  constexpr std::int64_t most = std::int64_t{1} << 21;
  const int level = first_level_of(fields);
  std::int64_t layers = 0;
  for (const HostField& f : fields) layers += layer_count(f, level);
  return layers <= most;
}

DeviceFieldStack::DeviceFieldStack(std::span<const HostField> fields, const Stream& stream) {
  stack_.first_level = first_level_of(fields);
  first_layers_ = layers_of(fields, stack_.first_level);
  const std::vector<ListStart> starts = starts_of(fields);
  const std::size_t spheres = starts.back().sphere;
  spheres_ = DeviceArray<Sphere>(spheres, stream.get());
  rank_ = DeviceArray<Rank>(spheres, stream.get());
  id_ = DeviceArray<SphereId>(spheres, stream.get());
  rough_ = DeviceArray<float4>(spheres, stream.get());
  cell_start_ = DeviceArray<std::uint32_t>(starts.back().cell, stream.get());
  std::vector<StackedField> stacked(fields.size());
  for (std::size_t f = 0; f < fields.size(); ++f) {
    stacked[f].context = field_context(
        view_of(fields[f].list, spheres_.data() + starts[f].sphere, rank_.data() + starts[f].sphere,
                id_.data() + starts[f].sphere, cell_start_.data() + starts[f].cell),
        fields[f].model, rough_.data() + starts[f].sphere);
    stacked[f].rounding = rounding_margin(fields[f].list, fields[f].model.grid);
    stacked[f].first_layer = first_layers_[f];
    spacings_.push_back(fields[f].model.grid.spacing);
    stand_on(stack_, stacked[f]);
  }
  stack_.bricks[2] = first_layers_.back();
  upload_stack(fields, starts, stacked, stream);
}

void DeviceFieldStack::upload_stack(std::span<const HostField> fields,
                                    const std::vector<ListStart>& starts,
                                    const std::vector<StackedField>& stacked,
                                    const Stream& stream) {
  const std::vector<std::uint32_t> field_of_layer = fields_of_layers(first_layers_);
  const JoinedLists joined(fields, starts);
  stacked_ = DeviceArray<StackedField>(stacked.size(), stream.get());
  field_of_layer_ = DeviceArray<std::uint32_t>(field_of_layer.size(), stream.get());
  const auto part = [](const auto& to, const auto& from) {
    return UploadPart{to.data(), from.data(), to.bytes()};
  };
  upload_parts({part(spheres_, joined.spheres), part(rank_, joined.rank), part(id_, joined.id),
                part(cell_start_, joined.cell_start), part(field_of_layer_, field_of_layer),
                part(stacked_, stacked)},
               stream);
  stack_.fields = stacked_.data();
  stack_.field_of_layer = field_of_layer_.data();
  launch("round_stack", round_stack, {static_cast<unsigned>(stacked.size()), kFieldThreads}, stream,
         stack_, spheres_.data(), rough_.data());
}

}  // namespace vdwmesh

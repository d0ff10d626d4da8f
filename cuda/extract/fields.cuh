// The fields over spheres that kernels read: one field, or a stack of many that are extracted
// together. Kernels about fields have a template parameter for OneField or FieldStack, and ask it
// for the field of a brick.
//
// A stack stands the grids of its fields on each other along z: each field gets layers of bricks of
// its own. So a brick's key says which field it belongs to, keys rise from one field to the next,
// and one list of bricks, one prefix sum and one launch of each kernel serve all fields. Only
// keys are stacked. Coordinates, grids and lattice indices of a field stay what they are when it is
// alone, so its mesh has the same bits.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cuda/memory/device_structures.cuh"
#include "extract/blended/kind_types.hpp"
#include "extract/bricks/brick.hpp"

namespace vdwmesh {

// float4 copies of the spheres of a cell list: x, y and z are the centre relative to `origin`, w is
// the reach (Å), widened by more than the rounding errors of float32.
struct RoughSpheres {
  ByListPlace<float4> spheres;
  Vec3d origin;
};

// What the kernels about a field of spheres need; passed by value. It owns nothing. `shape` and
// `nodes` follow from the model and are made on the host: a kernel would convert the model's
// doubles again for every atom. They are 0 for a union of balls.
struct FieldContext {
  CellListView list;
  FieldModel model;
  RoughSpheres rough;
  ShapeParameters<float> shape;
  NodeShape nodes;
};
FieldContext field_context(const CellListView& list, const FieldModel& model, const float4* rough);

// The field of a block of bricks, and the layer of bricks with which the field begins.
struct FieldOfBlock {
  const FieldContext& field;
  std::int32_t first_layer;

  // The index within the field of a block of 2^level bricks that has this index in the stack.
  __device__ BrickIndex index_in_field(const BrickIndex& block, int level) const {
    return {block.x, block.y, block.z - (first_layer >> level)};
  }
  __device__ std::uint64_t own_key(std::uint64_t key) const {
    return key - brick_key({0, 0, first_layer});
  }
};

struct OneField {
  FieldContext context;

  FieldKind kind() const { return context.model.kind; }
  // The field of the block of 2^level bricks with this key.
  __device__ FieldOfBlock of(std::uint64_t, int = 0) const { return {context, 0}; }
};

struct StackedField {
  FieldContext context;
  std::int32_t first_layer;   // a multiple of 2^FieldStack::first_level
  float rounding;             // rounding_margin() of its spheres, Å
  std::int32_t blocks[3];     // of level FieldStack::first_level, along each axis
  std::uint64_t first_block;  // how many of them the fields before have
};

// Passed to kernels by value; owns nothing.
struct FieldStack {
  const StackedField* fields;           // device memory
  const std::uint32_t* field_of_layer;  // device memory
  std::uint32_t field_count;
  FieldKind field_kind;        // of all fields
  std::int32_t bricks[3];      // along each axis; of all layers, of the widest field
  int first_level;             // of the blocks with which the search begins, 1 or above
  std::uint64_t first_blocks;  // how many blocks of that level all fields have

  FieldKind kind() const { return field_kind; }
  std::int32_t layers() const { return bricks[2]; }
  __device__ FieldOfBlock of(std::uint64_t key, int level = 0) const {
    const StackedField& f = fields[field_of_layer[brick_of_key(key).z << level]];
    return {f.context, f.first_layer};
  }
};

// Makes a OneField, and owns its rough spheres.
class DeviceField {
 public:
  DeviceField(const CellListView& list, const FieldModel& model, const Stream& stream);
  const OneField& fields() const { return fields_; }

 private:
  DeviceArray<float4> rough_;
  OneField fields_;
};

// A field on the host: its cell list lies there.
struct HostField {
  FieldModel model;
  CellListView list;
};

// Where the arrays of a field's list begin in those of all fields of a stack: its spheres, and the
// cells of its levels one behind the other, each level with one more element for its end.
struct ListStart {
  std::size_t sphere, cell;
};

// Whether keys of bricks can number the layers of a stack of these fields.
bool can_stack(std::span<const HostField> fields);

// Copies the cell lists of fields of one kind to the device, makes a FieldStack of them, and owns
// its arrays. The host fields are not needed afterwards.
class DeviceFieldStack {
 public:
  // Precondition: there are fields, and can_stack() is true of them.
  DeviceFieldStack(std::span<const HostField> fields, const Stream& stream);
  const FieldStack& fields() const { return stack_; }
  // The layer of bricks with which each field begins, and last the end of the stack.
  const std::vector<std::int32_t>& first_layers() const { return first_layers_; }
  // Of the grid of each field, Å.
  const std::vector<double>& spacings() const { return spacings_; }

 private:
  void upload_stack(std::span<const HostField> fields, const std::vector<ListStart>& starts,
                    const std::vector<StackedField>& stacked, const Stream& stream);

  std::vector<std::int32_t> first_layers_;
  std::vector<double> spacings_;
  DeviceArray<Sphere> spheres_;
  DeviceArray<Rank> rank_;
  DeviceArray<SphereId> id_;
  DeviceArray<std::uint32_t> cell_start_, field_of_layer_;
  DeviceArray<float4> rough_;
  DeviceArray<StackedField> stacked_;
  FieldStack stack_{};
};

}  // namespace vdwmesh

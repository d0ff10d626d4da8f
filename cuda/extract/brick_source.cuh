// What marching cubes on the device asks of a surface, brick by brick.
#pragma once

#include "cuda/extract/extract_stages.cuh"

namespace vdwmesh {

// A surface on one device, and the stream that all work about it runs on. Marching cubes over it is
// the same for all sources: see DeviceBrickMesher in brick_mesher.cuh.
class BrickSource {
 public:
  explicit BrickSource(const Stream& stream) : stream_(stream) {}
  virtual ~BrickSource() = default;

  const Stream& stream() const { return stream_; }
  virtual const GridSpec& grid() const = 0;
  virtual LabelWidth label_width() const = 0;

  // How many floats counting leaves behind for each brick, which emitting its vertices needs.
  virtual std::uint64_t values_per_brick() const { return 0; }

  // Keys of the bricks of a range that may hold surface, rising. Throws LimitExceeded beyond
  // `most`.
  virtual KeyList candidates(const KeyRange& range, std::uint64_t most) const = 0;

  // Signs and counts of the bricks with these keys; `values` has values_per_brick() for each.
  virtual void count(const std::uint64_t* keys, std::uint64_t size, ActiveBrick* bricks,
                     float* values, const BrickCounts& counts) const = 0;

  // Positions, normals and labels of the vertices of the bricks, at their numbers; adds the clamped
  // ones to `clamped`. `values` as counted, of these bricks.
  virtual void emit_vertices(const BrickList& bricks, std::uint32_t most_atoms, const float* values,
                             const DeviceMeshView& mesh, unsigned long long* clamped) const = 0;

 private:
  const Stream& stream_;
};

// The surface of a field over spheres that stand on the device.
class SphereSource final : public BrickSource {
 public:
  SphereSource(const CellListView& list, const FieldModel& model, const Stream& stream)
      : BrickSource(stream), field_(list, model, stream) {}

  const GridSpec& grid() const override { return context().model.grid; }
  LabelWidth label_width() const override { return LabelWidth::one; }
  std::uint64_t values_per_brick() const override {
    return context().model.kind == FieldKind::vdw ? 0 : kBrickValues;
  }
  KeyList candidates(const KeyRange& range, std::uint64_t most) const override {
    return candidate_bricks_on_device(context(), range, most, stream());
  }
  void count(const std::uint64_t* keys, std::uint64_t size, ActiveBrick* bricks, float* values,
             const BrickCounts& counts) const override {
    count_bricks_on_device(context(), keys, size, bricks, values, counts, stream());
  }
  void emit_vertices(const BrickList& bricks, std::uint32_t most_atoms, const float* values,
                     const DeviceMeshView& mesh, unsigned long long* clamped) const override {
    emit_vertices_on_device(context(), bricks, most_atoms, values, mesh, clamped, stream());
  }

 private:
  const FieldContext& context() const { return field_.context(); }

  DeviceField field_;
};

}  // namespace vdwmesh

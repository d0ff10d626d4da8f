// The interface through which marching cubes on the device asks for a surface, brick by brick, and
// its implementation for fields over spheres. FieldSource (field_source.cuh) is the other one.
#pragma once

#include "cuda/extract/extract_stages.cuh"
#include "cuda/extract/kept_bricks.cuh"

namespace vdwmesh {

// A surface on one device, and the stream on which all its work runs. The rest of marching cubes is
// the same for all sources: DeviceBrickMesher in brick_mesher.cuh.
class BrickSource {
 public:
  explicit BrickSource(const Stream& stream) : stream_(stream) {}
  virtual ~BrickSource() = default;

  const Stream& stream() const { return stream_; }
  virtual const GridSpec& grid() const = 0;
  // How many spheres the labels of its vertices name.
  virtual LabelWidth label_width() const = 0;

  // How many bytes counting keeps of each brick, which emit_vertices() reads later: the field's
  // values at its nodes, and the spheres near it. 0: none.
  virtual std::uint64_t kept_per_brick() const { return 0; }

  // Keys, rising, of the bricks of a range that may hold surface. Throws LimitExceeded if they are
  // more than `most`.
  virtual KeyList candidates(const KeyRange& range, std::uint64_t most) const = 0;

  // Writes the signs and counts of the `size` bricks with these keys to `bricks` and `counts`, and
  // kept_per_brick() bytes of each to `kept`.
  virtual void count(const std::uint64_t* keys, std::uint64_t size, ActiveBrick* bricks, void* kept,
                     const BrickCounts& counts) const = 0;

  // Writes positions, normals and labels of the vertices of the bricks to `mesh`, at the indices of
  // their numbers. Adds the number of clamped vertices to `clamped`. most_atoms is
  // BrickTotals::most_atoms, and `kept` is what count() has kept of these bricks.
  virtual void emit_vertices(const BrickList& bricks, std::uint32_t most_atoms, const void* kept,
                             const DeviceMeshView& mesh, unsigned long long* clamped) const = 0;

 private:
  const Stream& stream_;
};

// The surface of a field over spheres (the union or a blended field), with the cell list on the
// device.
class SphereSource final : public BrickSource {
 public:
  SphereSource(const CellListView& list, const FieldModel& model, const Stream& stream)
      : BrickSource(stream), field_(list, model, stream) {}

  const GridSpec& grid() const override { return context().model.grid; }
  LabelWidth label_width() const override { return LabelWidth::one; }
  std::uint64_t kept_per_brick() const override { return kept_bytes(context().model.kind); }
  KeyList candidates(const KeyRange& range, std::uint64_t most) const override {
    return candidate_bricks_on_device(context(), range, most, stream());
  }
  void count(const std::uint64_t* keys, std::uint64_t size, ActiveBrick* bricks, void* kept,
             const BrickCounts& counts) const override {
    count_bricks_on_device(context(), keys, size, bricks, kept, counts, stream());
  }
  void emit_vertices(const BrickList& bricks, std::uint32_t most_atoms, const void* kept,
                     const DeviceMeshView& mesh, unsigned long long* clamped) const override {
    emit_vertices_on_device(context(), bricks, most_atoms, kept, mesh, clamped, stream());
  }

 private:
  const FieldContext& context() const { return field_.context(); }

  DeviceField field_;
};

}  // namespace vdwmesh

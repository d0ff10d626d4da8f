// The interface through which marching cubes on the device asks for a surface, brick by brick, and
// its implementation for fields over spheres. FieldSource (field_source.cuh) is the other one.
#pragma once

#include "cuda/extract/bricks/extract_stages.cuh"
#include "cuda/extract/bricks/kept_bricks.cuh"

namespace vdwmesh {

// A surface on one device, and the stream on which all its work runs. The rest of marching cubes is
// the same for all sources: DeviceBrickMesher in brick_mesher.cuh.
class BrickSource {
 public:
  explicit BrickSource(const Stream& stream) : stream_(stream) {}
  virtual ~BrickSource() = default;

  const Stream& stream() const { return stream_; }
  // How many spheres the labels of its vertices name.
  virtual LabelWidth label_width() const = 0;

  // How many bytes counting keeps of each brick, which emit_vertices() reads later: the field's
  // values at its nodes, and the spheres near it. 0: none.
  virtual std::uint64_t kept_per_brick() const { return 0; }

  // Keys, rising, of the bricks of a range that may hold surface. Throws LimitExceeded if
  // they are more than `most`.
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

// The surfaces of fields over spheres (unions or blended fields): OneField, or the stacked surfaces
// of a FieldStack.
template <class Fields>
class SpheresSource : public BrickSource {
 public:
  using BrickSource::BrickSource;

  LabelWidth label_width() const override { return LabelWidth::one; }
  std::uint64_t kept_per_brick() const override { return kept_bytes(fields().kind()); }
  KeyList candidates(const KeyRange& range, std::uint64_t most) const override {
    return candidate_bricks_on_device(fields(), range, most, stream());
  }
  void count(const std::uint64_t* keys, std::uint64_t size, ActiveBrick* bricks, void* kept,
             const BrickCounts& counts) const override {
    count_bricks_on_device(fields(), keys, size, bricks, kept, counts, stream());
  }
  void emit_vertices(const BrickList& bricks, std::uint32_t most_atoms, const void* kept,
                     const DeviceMeshView& mesh, unsigned long long* clamped) const override {
    emit_vertices_on_device(fields(), bricks, most_atoms, kept, mesh, clamped, stream());
  }

 private:
  virtual const Fields& fields() const = 0;
};

// The surface of one field, with the cell list on the device.
class SphereSource final : public SpheresSource<OneField> {
 public:
  SphereSource(const CellListView& list, const FieldModel& model, const Stream& stream)
      : SpheresSource(stream), field_(list, model, stream) {}

 private:
  const OneField& fields() const override { return field_.fields(); }

  DeviceField field_;
};

// The surfaces of a stack, which must outlive the source.
class StackSource final : public SpheresSource<FieldStack> {
 public:
  StackSource(const DeviceFieldStack& stack, const Stream& stream)
      : SpheresSource(stream), stack_(stack) {}

 private:
  const FieldStack& fields() const override { return stack_.fields(); }

  const DeviceFieldStack& stack_;
};

}  // namespace vdwmesh

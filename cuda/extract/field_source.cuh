// The surface of a field that is given by its values at the nodes, for marching cubes on the
// device.
#pragma once

#include "cuda/extract/bricks/brick_source.cuh"

namespace vdwmesh {

// The layout of the signs of a grid's nodes: one bit each, in rows of 32-bit words along x. Bit i
// of word w of a row is set if the node with lattice index 32 w + i along x is inside. The virtual
// nodes at the ends of a row have the bit 0; rows of virtual nodes are not stored. So rows are
// numbered by grid indices, y faster than z.
struct SignGrid {
  std::int64_t words;          // per row
  std::int64_t height, depth;  // number of rows along y and z
  std::int32_t bricks[3];      // number of bricks along x, y, z

  // Words in all.
  __host__ __device__ std::int64_t size() const { return words * height * depth; }
  __host__ __device__ std::int64_t brick_total() const {
    return static_cast<std::int64_t>(bricks[0]) * bricks[1] * bricks[2];
  }
};

// The constructor reads the field once and makes a bit per node. Everything later uses the bits,
// except for the vertices, which need the values at the ends of crossed edges.
class FieldSource final : public BrickSource {
 public:
  // Packs the signs. Throws DeviceMemoryExceeded if they need more memory than
  // options.device_memory or than is available. The field's values must outlive the object.
  FieldSource(const SampledFieldView& field, const ExtractOptions& options, const Stream& stream);

  LabelWidth label_width() const override { return LabelWidth::none; }
  KeyList candidates(const KeyRange& range, std::uint64_t most) const override;
  void count(const std::uint64_t* keys, std::uint64_t size, ActiveBrick* bricks, void* kept,
             const BrickCounts& counts) const override;
  void emit_vertices(const BrickList& bricks, std::uint32_t most_atoms, const void* kept,
                     const DeviceMeshView& mesh, unsigned long long* clamped) const override;

 private:
  SampledFieldView field_;
  SignGrid signs_;
  DeviceArray<std::uint32_t> words_;
};

}  // namespace vdwmesh

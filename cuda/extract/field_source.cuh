// The surface of a field in device memory, for marching cubes on the device.
#pragma once

#include "cuda/extract/brick_source.cuh"

namespace vdwmesh {

// One bit per node of a grid, in rows of 32-bit words along x. Bit i of word w of a row is set if
// lattice node 32 w + i is inside. Virtual nodes within a row are 0; rows of virtual nodes are not
// stored.
struct SignGrid {
  std::int64_t words;          // per row
  std::int64_t height, depth;  // rows along y and z
  std::int32_t bricks[3];

  __host__ __device__ std::int64_t size() const { return words * height * depth; }
  __host__ __device__ std::int64_t brick_total() const {
    return static_cast<std::int64_t>(bricks[0]) * bricks[1] * bricks[2];
  }
};

// The field is streamed once into a bit per node. All that follows sees bits, except for the values
// at the ends of crossed edges.
class FieldSource final : public BrickSource {
 public:
  // Packs the signs. Throws DeviceMemoryExceeded if they take more than options.device_memory or
  // than there is. The field's values must outlive it.
  FieldSource(const SampledFieldView& field, const ExtractOptions& options, const Stream& stream);

  const GridSpec& grid() const override { return field_.grid; }
  LabelWidth label_width() const override { return LabelWidth::none; }
  KeyList candidates(const KeyRange& range, std::uint64_t most) const override;
  void count(const std::uint64_t* keys, std::uint64_t size, ActiveBrick* bricks, float* values,
             const BrickCounts& counts) const override;
  void emit_vertices(const BrickList& bricks, std::uint32_t most_atoms, const float* values,
                     const DeviceMeshView& mesh, unsigned long long* clamped) const override;

 private:
  SampledFieldView field_;
  SignGrid signs_;
  DeviceArray<std::uint32_t> words_;
};

}  // namespace vdwmesh

// A field given by its values at the nodes of a grid: made from spheres, and meshed.
#pragma once

#include <memory>
#include <string>

#include "core/buffer.hpp"
#include "extract/extractor.hpp"
#include "extract/field.hpp"
#include "extract/grid.hpp"

namespace vdwmesh {

// values[(k * (cells.y + 1) + j) * (cells.x + 1) + i] is the value at node (i, j, k); inside is
// where the value is at or above the isovalue.
struct SampledFieldView {
  GridSpec grid;
  const float* values;
  float isovalue;
};

struct SampledField {
  GridSpec grid{};
  Buffer<float> values;
  float isovalue = 1;
  std::string fallback{};  // why the CPU sampled what a device was to sample; empty: it did not

  SampledFieldView view() const { return {grid, values.data(), isovalue}; }
};

// Fields that stand in memory whole. Every backend gives the same values and the same meshes, bit
// by bit.
class FieldMesher {
 public:
  virtual ~FieldMesher() = default;

  // The blended field of `options` at every node of its grid: the float32 values whose signs the
  // Extractor takes. Throws InvalidInput for FieldKind::vdw and as the Extractor does,
  // LimitExceeded beyond options.memory_limit.
  virtual SampledField sample(const SphereSet& spheres, const ExtractOptions& options) const = 0;

  // Marching cubes, in the Extractor's order, closed like its meshes; only connectivity, normals,
  // memory limit, device memory, monitor, workspace and on_size of `options` are used. Vertices
  // interpolate between two nodes; normals are those of central differences, interpolated likewise;
  // vertex_spheres is empty. Where the grid's border cuts the surface, the vertex is a whole edge
  // outside. A value that is not a number counts as outside. Throws InvalidInput for a grid without
  // sense (spacing, negative cells), values that are not one per node and an isovalue that is not
  // finite; LimitExceeded.
  virtual void mesh_into(ExtractResult& result, const SampledField& field,
                         const ExtractOptions& options) const = 0;

  // The same into a new result.
  ExtractResult mesh(const SampledField& field, const ExtractOptions& options) const {
    ExtractResult result;
    mesh_into(result, field, options);
    return result;
  }
};

// The CPU backend: all cores, through TBB.
std::unique_ptr<FieldMesher> make_cpu_field_mesher();

}  // namespace vdwmesh

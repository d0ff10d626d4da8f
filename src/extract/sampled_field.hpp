// Fields that are given by their values at the nodes of a grid. A FieldMesher makes a mesh of such
// a field.
#pragma once

#include <memory>

#include "extract/extractor.hpp"
#include "extract/grid.hpp"

namespace vdwmesh {

// values[(k * (cells.y + 1) + j) * (cells.x + 1) + i] is the value at node (i, j, k). A node is
// inside if its value is at or above the isovalue. The view does not own the values.
struct SampledFieldView {
  GridSpec grid;
  const float* values;
  float isovalue;
};

// Meshes fields whose values at the nodes of the whole grid are in memory. Every backend makes the
// same meshes, bit by bit.
class FieldMesher {
 public:
  virtual ~FieldMesher() = default;

  // Marching cubes over a sampled field. Replaces `result`. The mesh is closed, and its vertices
  // and triangles are in the order of the Extractor. A vertex is found by linear interpolation
  // between the two nodes of its edge. Its normal is interpolated in the same way between the
  // central differences at these nodes. vertex_spheres is empty. If the border of the grid cuts the
  // surface, the vertex lies at the outer end of an edge that leaves the grid. A value that is not
  // a number counts as outside.
  //
  // Of `options`, only connectivity, normals, memory_limit, device_memory, monitor, workspace and
  // on_size are used. Throws InvalidInput for a grid whose spacing or number of cells is invalid,
  // and for an isovalue that is not finite. Throws LimitExceeded as the Extractor does.
  // Precondition: the view, whose values lie in the memory of the host, has one for each node.
  virtual void mesh_into(ExtractResult& result, const SampledFieldView& field,
                         const ExtractOptions& options) const = 0;

  // mesh_into() a new result.
  ExtractResult mesh(const SampledFieldView& field, const ExtractOptions& options) const;
};

// The CPU backend. It uses all cores through oneTBB.
std::unique_ptr<FieldMesher> make_cpu_field_mesher();

}  // namespace vdwmesh

// Fields over spheres by their values at the nodes of a grid, for tests of FieldMesher.
#pragma once

#include "core/buffer.hpp"
#include "extract/extractor.hpp"
#include "extract/sampled_field.hpp"

namespace vdwmesh::testing {

// A SampledFieldView with values of its own.
struct SampledField {
  GridSpec grid{};
  Buffer<float> values;
  float isovalue = 1;

  operator SampledFieldView() const { return {grid, values.data(), isovalue}; }
};

// The blended field of `options` at every node of its grid. The float32 values are those by which
// the Extractor decides which nodes are inside.
SampledField sampled_spheres(const SphereSet& spheres, const ExtractOptions& options);

}  // namespace vdwmesh::testing

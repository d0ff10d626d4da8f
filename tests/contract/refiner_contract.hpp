// What the refiner's contract tests share.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "contract/extractor_contract.hpp"
#include "refine/refiner.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh::testing {

class RefinerContract : public BackendTest, public ::testing::WithParamInterface<Backend> {
 protected:
  void SetUp() override { need(GetParam()); }
  RefineResult refine(const SphereSet& spheres, const IndexedMesh& mesh,
                      const RefineOptions& options) const {
    return make_refiner(GetParam())->refine(spheres, mesh, options);
  }
};

class RefinerFieldContract : public BackendTest,
                             public ::testing::WithParamInterface<std::tuple<Backend, FieldKind>> {
 protected:
  void SetUp() override { need(std::get<0>(GetParam())); }
  FieldKind kind() const { return std::get<1>(GetParam()); }
  RefineResult refine(const SphereSet& spheres, const IndexedMesh& mesh,
                      const RefineOptions& options) const {
    return make_refiner(std::get<0>(GetParam()))->refine(spheres, mesh, options);
  }
};

#define VDWMESH_INSTANTIATE_BLENDED_FIELDS(Suite)                                    \
  INSTANTIATE_TEST_SUITE_P(                                                          \
      Backends, Suite,                                                               \
      ::testing::Combine(::testing::Values(Backend::cpu, Backend::cuda),             \
                         ::testing::Values(FieldKind::blinn, FieldKind::soft_object, \
                                           FieldKind::inverse_squared)),             \
      [](const auto& each) { return backend_and_field_name(each.param); })

inline SphereSet spheres_of(std::vector<Sphere> spheres) { return SphereSet(std::move(spheres)); }

// Marching cubes on the CPU: the mesh that refinement begins with.
inline ExtractResult marching_cubes(const SphereSet& spheres, double spacing,
                                    FieldKind kind = FieldKind::vdw) {
  ExtractOptions options;
  options.field.kind = kind;
  options.grid.spacing = spacing;
  return make_cpu_extractor()->extract(spheres, options);
}

inline RefineOptions refine_options(int subdivisions, Projection projection) {
  RefineOptions options;
  options.subdivisions = subdivisions;
  options.projection = projection;
  return options;
}

inline RefineOptions field_options(int subdivisions, FieldKind kind, const GridSpec& grid) {
  RefineOptions options = refine_options(subdivisions, Projection::field);
  options.field.kind = kind;
  options.grid = grid;
  return options;
}

inline reference::MeshFacts facts_of(const IndexedMesh& mesh) {
  return reference::inspect(to_reference(mesh));
}

// Vertices that a run left where they were.
inline std::uint64_t left_out(const RefineResult& result) {
  std::uint64_t count = 0;
  for (const ProjectionStats& s : result.levels) count += s.unconverged + s.out_of_reach + s.undone;
  return count;
}

}  // namespace vdwmesh::testing

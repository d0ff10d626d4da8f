// What the extractor's contract tests share: the backends, and the way to the reference code.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "cuda/backend.hpp"
#include "extract/extractor.hpp"
#include "reference/field_oracle.hpp"
#include "reference/mesh_checks.hpp"
#include "support/reference_mesh.hpp"

namespace vdwmesh::testing {

std::string backend_name(Backend backend);
std::string field_name(FieldKind kind);
std::string backend_and_field_name(const std::tuple<Backend, FieldKind>& parameters);

// Empty where the backend can run here, else why it cannot.
std::string missing_backend(Backend backend);

// Skips, or fails with VDWMESH_REQUIRE_CUDA=1, where the backend is missing.
class BackendTest : public ::testing::Test {
 protected:
  void need(Backend backend);
};

class ExtractorContract : public BackendTest, public ::testing::WithParamInterface<Backend> {
 protected:
  void SetUp() override { need(GetParam()); }
  ExtractResult extract(const SphereSet& spheres, const ExtractOptions& options) const {
    return make_extractor(GetParam())->extract(spheres, options);
  }
};

class ExtractorFieldContract
    : public BackendTest,
      public ::testing::WithParamInterface<std::tuple<Backend, FieldKind>> {
 protected:
  void SetUp() override { need(std::get<0>(GetParam())); }
  FieldKind kind() const { return std::get<1>(GetParam()); }
  ExtractOptions at_spacing(double spacing) const;  // this test's field, radius-aware
  ExtractResult extract(const SphereSet& spheres, const ExtractOptions& options) const {
    return make_extractor(std::get<0>(GetParam()))->extract(spheres, options);
  }
};

// Every test file has fixtures of its own, derived from these two.
#define VDWMESH_INSTANTIATE_BACKENDS(Suite)                                                 \
  INSTANTIATE_TEST_SUITE_P(Backends, Suite, ::testing::Values(Backend::cpu, Backend::cuda), \
                           [](const auto& each) { return backend_name(each.param); })

#define VDWMESH_INSTANTIATE_FIELDS(Suite)                                                        \
  INSTANTIATE_TEST_SUITE_P(                                                                      \
      Backends, Suite,                                                                           \
      ::testing::Combine(::testing::Values(Backend::cpu, Backend::cuda),                         \
                         ::testing::Values(FieldKind::vdw, FieldKind::blinn,                     \
                                           FieldKind::soft_object, FieldKind::inverse_squared)), \
      [](const auto& each) { return backend_and_field_name(each.param); })

// Balls and fields as the reference code takes them, and what it finds of a mesh.
std::vector<reference::Ball> to_balls(const SphereSet& spheres);
reference::FieldOracle to_oracle(const FieldOptions& field, const GridSpec& grid);
reference::MeshFacts facts_of(const ExtractResult& result);

// Everything that holds for every mesh: arrays of matching length, closed, oriented, 2-manifold, no
// degenerate triangle, Euler characteristic even and by Gauss-Bonnet.
void expect_sound(const ExtractResult& result, const std::string& what,
                  Connectivity connectivity = Connectivity::triangles);

SphereSet one_sphere(double radius);
SphereSet two_spheres(double r1, double r2, double distance);
SphereSet ring_of_spheres(int count, double ring_radius, double radius);
// `count` balls on a Fibonacci lattice of the sphere of the given radius, `ball_radius` each.
SphereSet hollow_shell(int count, double shell_radius, double ball_radius);
// A compact random cluster like a small molecule: radii 1.2 ... 1.9 Å, about 1.4 Å apart.
SphereSet cluster(int count, unsigned seed);

SphereSet translated(const SphereSet& spheres, const Vec3d& by);

// Sphere i of the result is sphere order[i] of the set.
SphereSet permuted(const SphereSet& spheres, const std::vector<SphereId>& order);
// The same mesh, bit for bit, but for its labels, which are permuted. Of spheres that are equal the
// lowest id is named, in either order.
void expect_permuted(const SphereSet& spheres, const ExtractResult& original,
                     const ExtractResult& shuffled, const std::vector<SphereId>& order);

}  // namespace vdwmesh::testing

// The CUDA backend against the CPU backend on the same input: every array of the IndexedMesh equal
// bit by bit, twice in a row. Skips without a device; VDWMESH_REQUIRE_CUDA=1 makes that a failure.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "cuda/backend.hpp"
#include "support/requirements.hpp"

namespace vdwmesh::testing {

class Parity : public ::testing::Test {
 protected:
  void SetUp() override {
    const DeviceList list = cuda_devices();
    if (!list.devices.empty()) return;
    VDWMESH_MISSING("VDWMESH_REQUIRE_CUDA", list.reason);
  }
};

inline std::string to_string(const IndexedMeshHash& h) {
  char text[100];
  std::snprintf(text, sizeof text, "%016llx %016llx %016llx %016llx %016llx",
                static_cast<unsigned long long>(h.positions),
                static_cast<unsigned long long>(h.normals),
                static_cast<unsigned long long>(h.vertex_spheres),
                static_cast<unsigned long long>(h.triangles),
                static_cast<unsigned long long>(h.triangle_spheres));
  return text;
}

inline void expect_same(const IndexedMesh& cpu, const IndexedMesh& cuda, const std::string& what) {
  ASSERT_EQ(cpu.vertex_count(), cuda.vertex_count()) << what;
  ASSERT_EQ(cpu.triangle_count(), cuda.triangle_count()) << what;
  EXPECT_EQ(cpu.opposite, cuda.opposite) << what;
  const IndexedMeshHash a = hash(cpu), b = hash(cuda);
  std::printf("%-44s V %9zu T %9zu  %s\n", what.c_str(), cpu.vertex_count(), cpu.triangle_count(),
              to_string(b).c_str());
  EXPECT_EQ(to_string(a), to_string(b)) << what;
}

// The counts that follow from the surface; slabs and seconds depend on who made it.
inline void expect_same_counts(const ExtractStats& a, const ExtractStats& b,
                               const std::string& what) {
  EXPECT_EQ(a.clamped_vertices, b.clamped_vertices) << what;
  EXPECT_EQ(a.grid_clipped, b.grid_clipped) << what;
  EXPECT_EQ(a.surface_bricks, b.surface_bricks) << what;
}

inline void expect_parity(const SphereSet& spheres, const ExtractOptions& options,
                          const std::string& what) {
  const ExtractResult cpu = make_extractor(Backend::cpu)->extract(spheres, options);
  const ExtractResult cuda = make_extractor(Backend::cuda)->extract(spheres, options);
  expect_same(cpu.mesh, cuda.mesh, what);
  expect_same_counts(cpu.stats, cuda.stats, what);
  const ExtractResult again = make_extractor(Backend::cuda)->extract(spheres, options);
  EXPECT_EQ(hash(cuda.mesh), hash(again.mesh)) << what << ", second run";
}

inline constexpr FieldKind kFields[] = {FieldKind::vdw, FieldKind::blinn, FieldKind::soft_object,
                                        FieldKind::inverse_squared};
inline const char* name_of(FieldKind kind) {
  const char* names[] = {"vdw", "blinn", "soft", "inverse-squared"};
  return names[static_cast<int>(kind)];
}

// The moves that a refinement took back, of all levels together.
inline std::uint64_t taken_back(const std::vector<ProjectionStats>& levels) {
  std::uint64_t total = 0;
  for (const ProjectionStats& level : levels) total += level.undone;
  return total;
}

inline SphereSet crowd(std::size_t count, double box, double r_min, double r_max, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-box, box), radius(r_min, r_max);
  std::vector<Sphere> spheres(count);
  for (Sphere& s : spheres) s = {{place(random), place(random), place(random)}, radius(random)};
  return SphereSet(spheres);
}

inline ExtractOptions options_of(FieldKind kind, double spacing) {
  ExtractOptions options;
  options.field.kind = kind;
  options.grid.spacing = spacing;
  options.connectivity = Connectivity::half_edges;
  return options;
}

}  // namespace vdwmesh::testing

// What does not fit a device, and what is done in its place.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "cuda/backend.hpp"
#include "cuda/parity.hpp"
#include "cuda/refused_memory.hpp"

namespace vdwmesh::testing {
namespace {

TEST_F(Parity, NoRoomForASlab) {
  ExtractOptions options = options_of(FieldKind::vdw, 0.4);
  options.device_memory = 1000;
  try {
    make_extractor(Backend::cuda)->extract(crowd(2000, 15, 0.8, 2.0, 18), options);
    FAIL() << "1000 bytes were enough";
  } catch (const LimitExceeded& error) {
    EXPECT_NE(std::string(error.what()).find("needs"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("1000 are available"), std::string::npos)
        << error.what();
  }
}

// What does not fit the device is refused by the CUDA backend, and left to the CPU by the automatic
// one, which says so.
TEST_F(Parity, RefinementThatDoesNotFit) {
  const SphereSet spheres = crowd(300, 8, 0.8, 2.0, 19);
  ExtractOptions extract = options_of(FieldKind::vdw, 0.5);
  std::vector<std::uint64_t> told;
  RefineOptions refine;
  refine.subdivisions = 1;
  const PipelineResult cpu = make_pipeline(Backend::cpu)->run(spheres, extract, refine);
  std::vector<int> levels;
  refine.on_level = [&](int level, const IndexedMesh&) { levels.push_back(level); };
  refine.device_memory = 1 << 20;
  EXPECT_THROW(make_pipeline(Backend::cuda)->run(spheres, extract, refine), DeviceMemoryExceeded);
  extract.on_size = [&](const MeshSize& size) { told.push_back(size.triangles); };
  const PipelineResult automatic = make_pipeline(Backend::automatic)->run(spheres, extract, refine);
  EXPECT_EQ(told, std::vector<std::uint64_t>{automatic.mesh.triangle_count()});
  EXPECT_EQ(levels, (std::vector<int>{0, 1}));
  expect_same(cpu.mesh, automatic.mesh, "refined on the CPU");
  EXPECT_GT(automatic.extract.slabs, 0u) << "extracted on the CPU too";
  EXPECT_NE(automatic.fallback.find("refinement needs"), std::string::npos) << automatic.fallback;
  EXPECT_NE(automatic.fallback.find("1048576 are available"), std::string::npos)
      << automatic.fallback;
  refine.device_memory = kNoMemoryLimit;
  EXPECT_EQ(make_pipeline(Backend::automatic)->run(spheres, extract, refine).fallback, "");
}

TEST_F(Parity, ExtractionThatDoesNotFit) {
  const SphereSet spheres = crowd(2000, 15, 0.8, 2.0, 18);
  ExtractOptions extract = options_of(FieldKind::vdw, 0.4);
  const PipelineResult cpu = make_pipeline(Backend::cpu)->run(spheres, extract, {});
  extract.device_memory = 1000;
  const PipelineResult automatic = make_pipeline(Backend::automatic)->run(spheres, extract, {});
  expect_same(cpu.mesh, automatic.mesh, "meshed on the CPU");
  EXPECT_NE(automatic.fallback.find("extraction needs"), std::string::npos) << automatic.fallback;
}

// What does not fit beside the field is meshed in slabs: less and less memory, the same mesh.
TEST_F(Parity, AFieldInMemoryIsMeshedInSlabs) {
  const SphereSet spheres = crowd(300, 8, 0.8, 2.0, 20);
  ExtractOptions options = options_of(FieldKind::blinn, 0.4);
  const SampledField field = make_field_mesher(Backend::cpu)->sample(spheres, options);
  const ExtractResult cpu = make_field_mesher(Backend::cpu)->mesh(field, options);
  std::uint64_t most_slabs = 0;
  for (std::uint64_t memory = std::uint64_t{1} << 28; memory > 1000; memory -= memory / 10) {
    options.device_memory = memory;
    try {
      const ExtractResult cuda = make_field_mesher(Backend::cuda)->mesh(field, options);
      ASSERT_EQ(hash(cuda.mesh), hash(cpu.mesh)) << memory << " bytes";
      most_slabs = std::max(most_slabs, cuda.stats.slabs);
    } catch (const DeviceMemoryExceeded&) {
      break;
    }
  }
  EXPECT_GT(most_slabs, 2u);
}

// The automatic classes mesh on the CPU what does not fit, and say so; the CUDA ones refuse it.
TEST_F(Parity, AutomaticBackendsFallBack) {
  const SphereSet spheres = crowd(300, 8, 0.8, 2.0, 19);
  ExtractOptions options = options_of(FieldKind::blinn, 0.5);
  const ExtractResult cpu = make_extractor(Backend::cpu)->extract(spheres, options);
  const SampledField field = make_field_mesher(Backend::cpu)->sample(spheres, options);
  const ExtractResult sampled = make_field_mesher(Backend::cpu)->mesh(field, options);
  const auto expect_fallback = [&](const std::string& why) {
    const ExtractResult meshed = make_extractor(Backend::automatic)->extract(spheres, options);
    expect_same(cpu.mesh, meshed.mesh, "extracted, " + why);
    const auto mesher = make_field_mesher(Backend::automatic);
    const SampledField again = mesher->sample(spheres, options);
    ASSERT_EQ(field.values.size(), again.values.size());
    EXPECT_TRUE(std::equal(field.values.begin(), field.values.end(), again.values.begin()));
    const ExtractResult remeshed = mesher->mesh(field, options);
    expect_same(sampled.mesh, remeshed.mesh, "meshed from a field, " + why);
    const auto part = make_extractor(Backend::automatic)->count(spheres, {}, options);
    for (const std::string& fallback :
         {meshed.fallback, again.fallback, remeshed.fallback, part->fallback}) {
      EXPECT_EQ(fallback.find("on the CPU: ") != std::string::npos, !why.empty()) << fallback;
    }
  };
  expect_fallback("");
  {
    const RefusedMemory refused;
    EXPECT_THROW(make_extractor(Backend::cuda)->extract(spheres, options), DeviceMemoryExceeded);
    expect_fallback("the driver has no memory");
  }
  options.device_memory = 1000;
  EXPECT_THROW(make_field_mesher(Backend::cuda)->mesh(field, options), DeviceMemoryExceeded);
  EXPECT_THROW(make_field_mesher(Backend::cuda)->sample(spheres, options), DeviceMemoryExceeded);
  expect_fallback("1000 bytes");
}

}  // namespace
}  // namespace vdwmesh::testing

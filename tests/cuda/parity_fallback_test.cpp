// What does not fit a device, and what is done in its place.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "cuda/backend.hpp"
#include "cuda/parity.hpp"
#include "cuda/refused_memory.hpp"
#include "extract/batch_extractor.hpp"
#include "support/sampled_spheres.hpp"

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

// A batch is divided if its stack of grids has more layers than keys of bricks can number: here 17
// grids, each as high as an axis may be. A set that is too large for a mesh is then named by its
// number in the batch, not in the part that was extracted together. The ball of that set has
// 6 pi (r / h)^2 vertices, the grid lines that it crosses twice in each direction: 7.7e8, so 4.6e9
// half-edges, more than 2^32. Its 12 million bricks take some 10 GB; on a device without them the
// set is refused alone, with the same number.
TEST_F(Parity, DividedBatchNamesTheSetThatIsTooLarge) {
  constexpr std::size_t tall = 17, large = tall, small = tall + 1;
  const std::vector<Sphere> balls = [] {
    std::vector<Sphere> all(small + 1, Sphere{{0, 0, 0}, 1});
    all[large].radius = 64;
    return all;
  }();
  std::vector<std::size_t> offsets;
  for (std::size_t set = 0; set <= balls.size(); ++set) offsets.push_back(set);
  std::vector<GridOptions> grids(balls.size());
  for (std::size_t set = 0; set < tall; ++set) {
    grids[set].given = GridSpec{{-3, -3, -3}, 0.5, {12, 12, kMaxCellsPerAxis}};
  }
  grids[large].spacing = 0.01;
  ExtractOptions options;
  options.connectivity = Connectivity::half_edges;
  const auto extractor = make_batch_extractor(Backend::cuda);
  // The sets before the large one: they fit the device, and are divided all the same.
  const BatchExtraction some = extractor->extract(
      {{.spheres = balls.data(), .size = tall, .offsets = std::span(offsets).first(tall + 1)},
       std::span(grids).first(tall)},
      options);
  EXPECT_EQ(some.stats.slabs, 2u);
  EXPECT_EQ(some.set_count(), tall);
  try {
    extractor->extract({{.spheres = balls.data(), .size = balls.size(), .offsets = offsets}, grids},
                       options);
    FAIL() << "4.6e9 half-edges were numbered by 32 bits";
  } catch (const LimitExceeded& error) {
    EXPECT_EQ(std::string(error.what()).rfind("set 17: ", 0), 0u) << error.what();
  }
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
  const SampledField field = sampled_spheres(spheres, options);
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

// A grid of 41 x 41 x 41 bricks.
TEST_F(Parity, AFieldOfManyBricksInMemory) {
  constexpr std::int64_t cells = 320;
  SampledField field{{{0, 0, 0}, 0.5, {cells, cells, cells}}, {}, 0.0f};
  field.values.resize(field.grid.node_count());
  const Vec3d middle{80.1, 79.9, 80.2};
  auto value = field.values.begin();
  for (std::int64_t z = 0; z <= cells; ++z) {
    for (std::int64_t y = 0; y <= cells; ++y) {
      for (std::int64_t x = 0; x <= cells; ++x) {
        const Vec3d p =
            0.5 * Vec3d{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
        *value++ = static_cast<float>(60 - norm(p - middle));
      }
    }
  }
  ExtractOptions options;
  options.connectivity = Connectivity::half_edges;
  const ExtractResult cpu = make_field_mesher(Backend::cpu)->mesh(field, options);
  const ExtractResult cuda = make_field_mesher(Backend::cuda)->mesh(field, options);
  expect_same(cpu.mesh, cuda.mesh, "a ball in many bricks");
  expect_same_counts(cpu.stats, cuda.stats, "a ball in many bricks");
}

// The automatic classes mesh on the CPU what does not fit, and say so; the CUDA ones refuse it.
TEST_F(Parity, AutomaticBackendsFallBack) {
  const SphereSet spheres = crowd(300, 8, 0.8, 2.0, 19);
  ExtractOptions options = options_of(FieldKind::blinn, 0.5);
  const ExtractResult cpu = make_extractor(Backend::cpu)->extract(spheres, options);
  const SampledField field = sampled_spheres(spheres, options);
  const ExtractResult sampled = make_field_mesher(Backend::cpu)->mesh(field, options);
  const auto expect_fallback = [&](const std::string& why) {
    const ExtractResult meshed = make_extractor(Backend::automatic)->extract(spheres, options);
    expect_same(cpu.mesh, meshed.mesh, "extracted, " + why);
    const auto mesher = make_field_mesher(Backend::automatic);
    const ExtractResult remeshed = mesher->mesh(field, options);
    expect_same(sampled.mesh, remeshed.mesh, "meshed from a field, " + why);
    const auto part = make_extractor(Backend::automatic)->count(spheres, {}, options);
    for (const std::string& fallback : {meshed.fallback, remeshed.fallback, part->fallback}) {
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
  expect_fallback("1000 bytes");
}

}  // namespace
}  // namespace vdwmesh::testing

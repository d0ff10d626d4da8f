// Many sets in one call: the mesh of each is that of a call for the set alone, bit for bit, however
// different the sets are, and wherever the batch is cut. The Extractor of the same backend is the
// reference; its own contract says what is right.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "contract/extractor_contract.hpp"
#include "core/errors.hpp"
#include "core/monitor.hpp"
#include "support/dice.hpp"
#include "support/extract_sets.hpp"

namespace vdwmesh::testing {
namespace {

// Sets one after another, as a caller has them.
class Sets {
 public:
  void add(const SphereSet& spheres, const GridOptions& grid = {}) {
    all_.insert(all_.end(), spheres.spheres().begin(), spheres.spheres().end());
    offsets_.push_back(all_.size());
    grids_.push_back(grid);
  }
  ExtractBatch batch() const {
    return {{.spheres = all_.data(), .size = all_.size(), .offsets = offsets_}, grids_};
  }
  std::size_t size() const { return grids_.size(); }
  SphereSet set(std::size_t i) const { return SphereSet::view(batch().spheres.set(i)); }
  const GridOptions& grid(std::size_t i) const { return grids_[i]; }

 private:
  std::vector<Sphere> all_;
  std::vector<std::size_t> offsets_{0};
  std::vector<GridOptions> grids_;
};

GridOptions spaced(double spacing) {
  GridOptions grid;
  grid.spacing = spacing;
  return grid;
}

// Grids that the sets around the origin leave, and one that is nothing but nodes in a plane.
GridOptions given(const Vec3d& origin, double spacing, const Vec3i& cells) {
  GridOptions grid;
  grid.given = GridSpec{origin, spacing, cells};
  return grid;
}

// Sets unlike each other: compact, of one ball, of two that are far apart, of balls of very
// different size, coincident, many, cut by their grid, outside of it, on coarse and on fine grids.
Sets odd_sets() {
  Sets sets;
  sets.add(cluster(120, 3), spaced(0.5));
  sets.add(one_sphere(1.7), spaced(0.5));
  sets.add(SphereSet({{{-400, 0, 3}, 1.5}, {{400, 250, -300}, 2}}), spaced(0.7));
  sets.add(SphereSet({{{0, 0, 0}, 30}, {{30, 0, 0}, 0.4}, {{0, 31, 0}, 0.9}}), spaced(1));
  sets.add(one_sphere(0.01), spaced(2));
  sets.add(SphereSet({{{1, 2, 3}, 1.2}, {{1, 2, 3}, 1.2}, {{1, 2, 3}, 1.1}}), spaced(0.3));
  sets.add(cluster(400, 9), given({-3, -2, -1}, 0.4, {17, 12, 30}));
  sets.add(one_sphere(1), given({50, 50, 50}, 0.5, {20, 20, 20}));
  sets.add(cluster(40, 5), given({-3, 0.1, -3}, 0.5, {12, 0, 12}));
  sets.add(hollow_shell(300, 9, 1.2), spaced(0.35));
  sets.add(translated(cluster(60, 4), {1e4, -1e5, 3e3}), spaced(0.6));
  sets.add(cluster(120, 3), spaced(0.5));  // the first one again
  return sets;
}

class BatchExtractorContract : public ExtractorFieldContract {
 protected:
  Backend backend() const { return std::get<0>(GetParam()); }
  std::unique_ptr<BatchExtractor> extractor() const { return make_batch_extractor(backend()); }
  ExtractResult alone(const Sets& sets, std::size_t set, ExtractOptions options) const {
    options.grid = sets.grid(set);
    return make_extractor(backend())->extract(sets.set(set), options);
  }
  void expect_as_alone(const BatchExtraction& found, const Sets& sets,
                       const ExtractOptions& options) const {
    ASSERT_EQ(found.set_count(), sets.size());
    ASSERT_EQ(found.before.size(), sets.size() + 1);
    ExtractStats sum;
    for (std::size_t set = 0; set < sets.size(); ++set) {
      const ExtractResult own = alone(sets, set, options);
      EXPECT_EQ(hash(found.mesh(set)), hash(own.mesh)) << "set " << set;
      EXPECT_EQ(found.size(set).vertices, own.mesh.vertex_count()) << "set " << set;
      EXPECT_EQ(found.size(set).triangles, own.mesh.triangle_count()) << "set " << set;
      EXPECT_EQ(found.grids[set].origin, own.grid.origin) << "set " << set;
      EXPECT_EQ(found.grids[set].cells, own.grid.cells) << "set " << set;
      sum += own.stats;
    }
    EXPECT_EQ(found.before.back().vertices, found.meshes.vertex_count());
    EXPECT_EQ(found.before.back().triangles, found.meshes.triangle_count());
    EXPECT_EQ(found.stats.surface_bricks, sum.surface_bricks);
    EXPECT_EQ(found.stats.clamped_vertices, sum.clamped_vertices);
    EXPECT_EQ(found.stats.grid_clipped, sum.grid_clipped);
    EXPECT_EQ(found.stats.unmatched_faces, 0);
    EXPECT_TRUE(found.fallback.empty());
  }
};

TEST_P(BatchExtractorContract, MeshesOfOddSetsAreThoseOfCallsAlone) {
  const Sets sets = odd_sets();
  for (const Connectivity connectivity : {Connectivity::triangles, Connectivity::half_edges}) {
    ExtractOptions options = at_spacing(0.5);
    options.connectivity = connectivity;
    options.normals = connectivity == Connectivity::triangles ? Normals::gradients : Normals::none;
    expect_as_alone(extractor()->extract(sets.batch(), options), sets, options);
  }
}

// Sets of a survey: gases, crowds, chains, lattices, one huge ball among tiny ones, borders.
TEST_P(BatchExtractorContract, MeshesOfRandomSetsAreThoseOfCallsAlone) {
  Sets sets;
  for (std::uint32_t index = 0; index < 60; ++index) {
    const ExtractSet random = extract_set(20261124, index);
    sets.add(random.spheres, random.options.grid);
  }
  ExtractOptions options = at_spacing(0.5);
  options.connectivity = Connectivity::half_edges;
  expect_as_alone(extractor()->extract(sets.batch(), options), sets, options);
}

// The presets with sub-grids sum over boxes of grid cells, which are those of each set's own grid.
TEST_P(BatchExtractorContract, SubgridsAreThoseOfTheSet) {
  Sets sets;
  for (const unsigned seed : {1u, 2u, 3u}) {
    sets.add(cluster(50, seed), preset_grid(FieldPreset::thesis, 0.6, {}));
  }
  ExtractOptions options = at_spacing(0.6);
  if (kind() != FieldKind::vdw) options.field.preset = FieldPreset::thesis;  // vdw has no presets
  expect_as_alone(extractor()->extract(sets.batch(), options), sets, options);
}

// Without grids, the options' grid serves all sets; all spheres are one set without offsets.
TEST_P(BatchExtractorContract, OneGridServesAllSets) {
  const Sets sets = odd_sets();
  ExtractBatch batch = sets.batch();
  const std::size_t offsets[] = {0, sets.set(0).size(), sets.set(0).size() + 1};
  batch.grids = {};
  batch.spheres.offsets = offsets;
  batch.spheres.size = offsets[2];
  const ExtractOptions options = at_spacing(0.8);
  const BatchExtraction found = extractor()->extract(batch, options);
  ASSERT_EQ(found.set_count(), 2u);
  for (std::size_t set = 0; set < 2; ++set) {
    EXPECT_EQ(hash(found.mesh(set)),
              hash(make_extractor(backend())->extract(sets.set(set), options).mesh));
  }
  batch.spheres.offsets = {};
  const BatchExtraction whole = extractor()->extract(batch, options);
  ASSERT_EQ(whole.set_count(), 1u);
  const SphereSet all = SphereSet::view({batch.spheres.spheres, batch.spheres.size});
  EXPECT_EQ(hash(whole.meshes), hash(make_extractor(backend())->extract(all, options).mesh));
}

// Memory that holds some sets of the batch, but not all: CUDA divides the batch, and a set that
// does not fit alone is made in slabs.
TEST_P(BatchExtractorContract, LittleDeviceMemoryGivesTheSameMeshes) {
  const Sets sets = odd_sets();
  ExtractOptions options = at_spacing(0.5);
  options.connectivity = Connectivity::half_edges;
  const BatchExtraction whole = extractor()->extract(sets.batch(), options);
  for (const std::uint64_t bytes : {200'000u, 2'000'000u}) {
    options.device_memory = bytes;
    const BatchExtraction found = extractor()->extract(sets.batch(), options);
    EXPECT_EQ(hash(found.meshes), hash(whole.meshes)) << bytes;
    EXPECT_EQ(found.stats.clamped_vertices, whole.stats.clamped_vertices);
    if (backend() == Backend::cuda) {
      EXPECT_GT(found.stats.slabs, whole.stats.slabs);
    }
  }
}

TEST_P(BatchExtractorContract, ResultsAreRefilledAndSizesTold) {
  const Sets sets = odd_sets();
  Sets one;
  one.add(cluster(30, 8), spaced(0.5));
  ExtractOptions options = at_spacing(0.5);
  BatchExtraction result = extractor()->extract(sets.batch(), options);
  std::vector<MeshSize> told;
  options.on_size = [&](const MeshSize& size) { told.push_back(size); };
  options.normals = Normals::none;
  extractor()->extract_into(result, one.batch(), options);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].vertices, result.size(0).vertices);
  EXPECT_EQ(told[0].triangles, result.size(0).triangles);
  expect_as_alone(result, one, options);
}

class CountingMonitor final : public Monitor {
 public:
  explicit CountingMonitor(bool stop) : stop_(stop) {}
  void begin_stage(std::string_view, std::uint64_t steps) override { wanted += steps; }
  void advance(std::uint64_t steps) override { done += steps; }
  bool cancelled() const override { return stop_; }

  std::uint64_t wanted = 0, done = 0;

 private:
  bool stop_;
};

// A step of progress for each set, however the batch is cut; and a chance to stop.
TEST_P(BatchExtractorContract, ProgressCountsSetsAndCanStop) {
  const Sets sets = odd_sets();
  for (const std::uint64_t bytes : {kNoMemoryLimit, std::uint64_t{2'000'000}}) {
    ExtractOptions options = at_spacing(0.5);
    options.device_memory = bytes;
    CountingMonitor goes_on(false), stops(true);
    options.monitor = &goes_on;
    extractor()->extract(sets.batch(), options);
    EXPECT_EQ(goes_on.wanted, sets.size());
    EXPECT_EQ(goes_on.done, sets.size());
    options.monitor = &stops;
    EXPECT_THROW(extractor()->extract(sets.batch(), options), Cancelled);
    EXPECT_EQ(stops.done, 0u);
  }
}

// ---- wrong inputs ----

std::string message_of(const BatchExtractor& extractor, const ExtractBatch& batch,
                       const ExtractOptions& options) {
  try {
    extractor.extract(batch, options);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST_P(BatchExtractorContract, RefusesWrongBatches) {
  const Sets sets = odd_sets();
  const ExtractOptions options = at_spacing(0.5);
  const auto refused = [&](const ExtractBatch& batch) {
    return message_of(*extractor(), batch, options);
  };
  EXPECT_EQ(refused({}), "set 0 of the batch has no spheres: its union is not defined");
  ExtractBatch batch = sets.batch();
  const std::size_t none[] = {0};
  batch.spheres.offsets = none;
  EXPECT_NE(refused(batch).find("must begin with 0 and end with"), std::string::npos);
  batch = sets.batch();
  std::vector<std::size_t> offsets(batch.spheres.offsets.begin(), batch.spheres.offsets.end());
  batch.spheres.offsets = offsets;
  offsets[3] = offsets[2];
  EXPECT_EQ(refused(batch), "set 2 of the batch has no spheres: its union is not defined");
  offsets[3] = offsets[2] - 1;
  EXPECT_EQ(refused(batch), "offset 3 of a batch is below the one before");
  batch = sets.batch();
  batch.grids = batch.grids.subspan(1);
  EXPECT_EQ(refused(batch), "11 grids for 12 sets: give one for each set, or none");
  batch = sets.batch();
  batch.spheres.memory = MemorySpace::device;
  EXPECT_EQ(refused(batch),
            "the spheres are in device memory: a batch is extracted from host memory");
}

// What is wrong with one set is said with its number; a sphere is named by its index in the batch.
TEST_P(BatchExtractorContract, NamesTheSetThatIsWrong) {
  Sets sets;
  sets.add(cluster(20, 1), spaced(0.5));
  sets.add(cluster(20, 2), spaced(-1));
  sets.add(cluster(20, 3), spaced(0));
  EXPECT_EQ(message_of(*extractor(), sets.batch(), at_spacing(0.5)).rfind("set 1: ", 0), 0u);
  Sets fine;
  fine.add(one_sphere(1), spaced(0.5));
  fine.add(SphereSet({{{0, 0, 0}, 1}, {{9e29, 0, 0}, 1}}), spaced(0.5));
  ExtractOptions options = at_spacing(0.5);
  EXPECT_THROW(extractor()->extract(fine.batch(), options), LimitExceeded);
  std::vector<Sphere> broken{{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{2, 0, 0}, -1}};
  const std::size_t offsets[] = {0, 2, 3};
  EXPECT_NE(message_of(*extractor(), {{broken.data(), broken.size(), offsets}}, options).find('2'),
            std::string::npos);
}

// A limit that all meshes exceed together, and none alone.
TEST_P(BatchExtractorContract, MemoryLimitHoldsForAllMeshesTogether) {
  Sets sets;
  for (const unsigned seed : {1u, 2u, 3u, 4u}) sets.add(cluster(100, seed), spaced(0.5));
  ExtractOptions options = at_spacing(0.5);
  const std::uint64_t need = indexed_mesh_bytes(extractor()->extract(sets.batch(), options).meshes);
  options.memory_limit = 2 * need;
  EXPECT_EQ(indexed_mesh_bytes(extractor()->extract(sets.batch(), options).meshes), need);
  options.memory_limit = need - 1;
  EXPECT_NO_THROW(alone(sets, 3, options));
  EXPECT_THROW(extractor()->extract(sets.batch(), options), LimitExceeded);
}

VDWMESH_INSTANTIATE_FIELDS(BatchExtractorContract);

}  // namespace
}  // namespace vdwmesh::testing

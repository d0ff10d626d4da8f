// Meshes of both backends.
#include "cuda/parity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "cuda/backend.hpp"
#include "support/crease_meshes.hpp"
#include "support/sampled_spheres.hpp"
#include "support/shared_files.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

TEST_F(Parity, RandomAndDegenerateSets) {
  const std::vector<std::pair<std::string, SphereSet>> sets = {
      {"one ball", SphereSet({{{0.1, 0.2, 0.3}, 1.7}})},
      {"coincident", SphereSet({{{0, 0, 0}, 1.7}, {{0, 0, 0}, 1.7}, {{0, 0, 0}, 1.2}})},
      {"tangent", SphereSet({{{0, 0, 0}, 1.5}, {{3, 0, 0}, 1.5}, {{0, 3, 0}, 1.5}})},
      {"on nodes", SphereSet({{{0, 0, 0}, 1.5}, {{2, 0, 0}, 1.5}, {{1, 1, 0}, 1.0}})},
      {"tiny", SphereSet({{{0, 0, 0}, 0.01}, {{5, 5, 5}, 0.02}})},
      {"giant among small", crowd(300, 12, 0.1, 2.0, 5)},
      {"crowd", crowd(2000, 15, 0.8, 2.0, 6)},
      {"far apart", SphereSet({{{0, 0, 0}, 1.7}, {{4000, 0, 100}, 1.5}})}};
  for (const auto& [name, spheres] : sets) {
    for (const FieldKind kind : kFields) {
      for (const double spacing : {0.5, 0.23}) {
        expect_parity(spheres, options_of(kind, spacing),
                      name + " " + name_of(kind) + " " + std::to_string(spacing));
      }
    }
  }
}

// Nodes on spheres, and off by 1e-16 to 1e-6 of the radius either way: float32, which the CPU tries
// first, decides none of these signs. Balls lie apart from each other, of 1 to 10 spacings.
TEST_F(Parity, NodesAlmostOnSpheres) {
  ExtractOptions options = options_of(FieldKind::vdw, 0.25);
  options.grid.given = GridSpec{{-4, -4, -4}, 0.25, {256, 256, 32}};
  const int steps[][3] = {{1, 0, 0}, {2, 1, 0}, {3, 4, 0}, {2, 2, 1},
                          {6, 2, 3}, {1, 4, 8}, {9, 2, 2}, {5, 5, 5}};
  std::vector<Sphere> balls;
  for (std::size_t i = 0; i < std::size(steps); ++i) {
    const auto [x, y, z] = steps[i];
    const double radius = 0.25 * std::sqrt(static_cast<double>(x * x + y * y + z * z));
    for (int k = 0; k < 8; ++k) {
      const double off =
          k == 0 ? 0 : (k % 2 == 0 ? 1 : -1) * std::pow(10.0, -16 + 10 * (k / 2) / 3);
      balls.push_back({{7.0 * static_cast<double>(i), 7.0 * k, 0}, radius * (1 + off)});
    }
  }
  expect_parity(SphereSet(balls), options, "nodes almost on spheres");
}

// 1, 31, 32 and 33 bricks in a row, and a surface through the corners of bricks.
TEST_F(Parity, SizesAroundAWarp) {
  for (const int bricks : {1, 31, 32, 33}) {
    std::vector<Sphere> row;
    const double spacing = 0.5;
    for (double x = 0; x <= bricks * kBrickSide * spacing - 6; x += 1.1)
      row.push_back({{x, 0, 0}, 1.5});
    if (row.empty()) row.push_back({{0, 0, 0}, 0.4});
    for (const FieldKind kind : kFields) {
      expect_parity(SphereSet(row), options_of(kind, spacing),
                    std::to_string(bricks) + " bricks " + name_of(kind));
    }
  }
}

TEST_F(Parity, SurfaceCutByTheGrid) {
  for (const FieldKind kind : kFields) {
    ExtractOptions options = options_of(kind, 0.4);
    options.grid.padding = 0;
    options.grid.box = GridBox::centers;
    expect_parity(crowd(100, 5, 1, 2, 9), options, std::string("cut ") + name_of(kind));
  }
}

// More spheres near a brick than fit in shared memory at a time.
TEST_F(Parity, CoarseGridsOverManySpheres) {
  for (const FieldKind kind : kFields) {
    expect_parity(crowd(6000, 18, 0.8, 2.0, 10), options_of(kind, 2.0),
                  std::string("coarse ") + name_of(kind));
  }
}

TEST_F(Parity, ThesisPresets) {
  for (const FieldPreset preset : {FieldPreset::thesis, FieldPreset::thesis_vdw}) {
    for (const FieldKind kind :
         {FieldKind::blinn, FieldKind::soft_object, FieldKind::inverse_squared}) {
      ExtractOptions options = options_of(kind, 0.4);
      options.field.preset = preset;
      options.grid = preset_grid(preset, {}, {});
      expect_parity(crowd(200, 8, 1, 2, 11), options, std::string("thesis ") + name_of(kind));
    }
  }
}

void expect_mesher_parity(const SampledField& field, const ExtractOptions& options,
                          const std::string& what);

// What does not fit is made in slabs, and several devices share them: the mesh is the same.
TEST_F(Parity, SlabsWithoutNormals) {
  const SphereSet spheres = crowd(2000, 15, 0.8, 2.0, 18);
  ExtractOptions options = options_of(FieldKind::vdw, 0.4);
  options.normals = Normals::none;
  const ExtractResult cpu = make_extractor(Backend::cpu)->extract(spheres, options);
  options.device_memory = std::uint64_t{3} << 20;
  const ExtractResult cuda = make_extractor(Backend::cuda)->extract(spheres, options);
  EXPECT_GT(cuda.stats.slabs, 1u);
  EXPECT_TRUE(cuda.mesh.normals.empty());
  expect_same(cpu.mesh, cuda.mesh, "no normals");
}

// Of so many spheres the cell list is built on the device: with several levels of reach, with every
// sphere twice, and with one far away.
TEST_F(Parity, ListsBuiltOnTheDevice) {
  std::vector<Sphere> twice;
  const SphereSet once = crowd(5000, 20, 0.8, 2.0, 32), cloud = crowd(9000, 25, 1.0, 2.0, 33);
  for (const Sphere& s : once.spheres()) twice.insert(twice.end(), 2, s);
  std::vector<Sphere> far;
  for (const Sphere& s : cloud.spheres()) far.push_back(s);
  far.push_back({{300, 10, -20}, 1.5});
  const std::vector<std::pair<std::string, SphereSet>> sets = {
      {"levels", crowd(9000, 25, 0.1, 4.0, 31)},
      {"twice", SphereSet(twice)},
      {"far", SphereSet(far)}};
  for (const auto& [name, spheres] : sets) {
    for (const FieldKind kind : {FieldKind::vdw, FieldKind::blinn}) {
      expect_parity(spheres, options_of(kind, 1.0), name + " " + name_of(kind));
    }
  }
}

// A pipeline puts its mesh into the memory of the one before, larger or smaller.
TEST_F(Parity, IntoTheMemoryOfTheMeshBefore) {
  const auto cpu = make_pipeline(Backend::cpu), cuda = make_pipeline(Backend::cuda);
  for (const int subdivisions : {0, 1}) {
    RefineOptions refine;
    refine.subdivisions = subdivisions;
    PipelineResult kept;
    const Vec3d* first = nullptr;
    for (const std::size_t size : {std::size_t{1000}, std::size_t{300}, std::size_t{2000}}) {
      const SphereSet spheres = crowd(size, 12, 0.8, 2.0, 34);
      const ExtractOptions options = options_of(FieldKind::vdw, 0.6);
      cuda->run_into(kept, spheres, options, refine);
      expect_same(cpu->run(spheres, options, refine).mesh, kept.mesh,
                  "kept memory, " + std::to_string(size) + " spheres");
      if (size == 1000) first = kept.mesh.positions.data();
      if (size == 300) {
        EXPECT_EQ(kept.mesh.positions.data(), first);
      }
    }
  }
}

// Opposite half-edges are made where they are asked for, and nothing else depends on that.
// The limit of a device's memory that leaves each of its workers `bytes`.
std::uint64_t for_each_worker(std::uint64_t bytes, int workers) {
  if (bytes == kNoMemoryLimit) return bytes;
  const auto all = static_cast<std::uint64_t>(workers);
  const std::uint64_t present = cuda_devices().devices.size();
  return bytes * ((all + present - 1) / present);
}

TEST_F(Parity, WithoutHalfEdges) {
  const SphereSet spheres = crowd(2000, 15, 0.8, 2.0, 18);
  for (const FieldKind kind : kFields) {
    ExtractOptions options = options_of(kind, 0.4);
    options.connectivity = Connectivity::triangles;
    const ExtractResult cpu = make_extractor(Backend::cpu)->extract(spheres, options);
    ASSERT_TRUE(cpu.mesh.opposite.empty());
    for (const int devices : {1, 3}) {
      for (const std::uint64_t memory : {kNoMemoryLimit, std::uint64_t{2} << 20}) {
        options.devices = devices;
        options.device_memory = for_each_worker(memory, devices);
        const ExtractResult cuda = make_extractor(Backend::cuda)->extract(spheres, options);
        expect_same(cpu.mesh, cuda.mesh, std::string("triangles alone, ") + name_of(kind));
        EXPECT_EQ(cuda.stats.slabs > static_cast<std::uint64_t>(devices), memory != kNoMemoryLimit);
      }
    }
    if (kind == FieldKind::vdw) continue;
    const SampledField field = sampled_spheres(spheres, options);
    options.device_memory = kNoMemoryLimit;
    expect_mesher_parity(field, options, std::string("triangles alone, sampled ") + name_of(kind));
  }
}

TEST_F(Parity, SlabsAndDevices) {
  const SphereSet spheres = crowd(2000, 15, 0.8, 2.0, 18);
  for (const FieldKind kind : kFields) {
    ExtractOptions options = options_of(kind, 0.4);
    const ExtractResult whole = make_extractor(Backend::cuda)->extract(spheres, options);
    EXPECT_EQ(whole.stats.slabs, 1u);
    for (const int devices : {1, 2, 3, 7}) {
      for (const std::uint64_t memory : {kNoMemoryLimit, std::uint64_t{3} << 20}) {
        options.devices = devices;
        options.device_memory = for_each_worker(memory, devices);
        const ExtractResult result = make_extractor(Backend::cuda)->extract(spheres, options);
        const std::string what = std::string(name_of(kind)) + " " + std::to_string(devices) +
                                 " devices, " + std::to_string(memory) + " bytes";
        expect_same(whole.mesh, result.mesh, what);
        expect_same_counts(whole.stats, result.stats, what);
        const auto shares = static_cast<std::uint64_t>(devices);
        if (memory == kNoMemoryLimit) {
          EXPECT_EQ(result.stats.slabs, shares) << what;
        } else {
          EXPECT_GE(result.stats.slabs, std::max(shares, std::uint64_t{4})) << what;
        }
      }
    }
  }
}

// With subdivisions too: what is extracted in slabs, or on several devices, is refined afterwards.
TEST_F(Parity, RefinedSlabsAndDevices) {
  const SphereSet spheres = crowd(2000, 15, 0.8, 2.0, 18);
  for (const FieldKind kind : {FieldKind::vdw, FieldKind::blinn}) {
    ExtractOptions extract = options_of(kind, 0.4);
    RefineOptions refine;
    refine.subdivisions = 1;
    refine.field = extract.field;
    refine.projection = kind == FieldKind::vdw ? Projection::vdw : Projection::field;
    const PipelineResult cpu = make_pipeline(Backend::cpu)->run(spheres, extract, refine);
    for (const Backend backend : {Backend::cuda, Backend::automatic}) {
      for (const int devices : {1, 3}) {
        for (const std::uint64_t memory : {kNoMemoryLimit, std::uint64_t{3} << 20}) {
          extract.devices = devices;
          extract.device_memory = memory;
          std::vector<int> levels;
          refine.on_level = [&](int level, const IndexedMesh&) { levels.push_back(level); };
          const PipelineResult result = make_pipeline(backend)->run(spheres, extract, refine);
          const std::string what = std::string("refined after slabs, ") + name_of(kind) + " " +
                                   std::to_string(devices) + " devices";
          expect_same(cpu.mesh, result.mesh, what);
          EXPECT_EQ(levels, (std::vector<int>{0, 1})) << what;
          EXPECT_EQ(result.fallback, "") << what;
          const bool together = devices == 1 && memory == kNoMemoryLimit;
          EXPECT_EQ(result.extract.slabs == 0, together) << what;
          EXPECT_GE(result.extract.slabs, memory == kNoMemoryLimit ? 0u : 4u) << what;
        }
      }
    }
  }
}

// Memory is kept between runs until it is given back, and then there is as much of it as before.
TEST_F(Parity, RunsAfterMemoryWasReleased) {
  const SphereSet spheres = crowd(300, 8, 0.8, 2.0, 19);
  const ExtractOptions options = options_of(FieldKind::vdw, 0.5);
  const ExtractResult first = make_extractor(Backend::cuda)->extract(spheres, options);
  release_device_memory();
  const ExtractResult second = make_extractor(Backend::cuda)->extract(spheres, options);
  expect_same(first.mesh, second.mesh, "after memory was released");
}

// Fields that stand in memory.
void expect_mesher_parity(const SampledField& field, const ExtractOptions& options,
                          const std::string& what) {
  const ExtractResult cpu = make_field_mesher(Backend::cpu)->mesh(field, options);
  const ExtractResult cuda = make_field_mesher(Backend::cuda)->mesh(field, options);
  expect_same(cpu.mesh, cuda.mesh, what);
  expect_same_counts(cpu.stats, cuda.stats, what);
}

void expect_sampled_parity(const SphereSet& spheres, const ExtractOptions& options,
                           const std::string& what) {
  expect_mesher_parity(sampled_spheres(spheres, options), options, what);
}

TEST_F(Parity, SampledFields) {
  for (const FieldKind kind :
       {FieldKind::blinn, FieldKind::soft_object, FieldKind::inverse_squared}) {
    const std::string name = std::string("sampled ") + name_of(kind);
    expect_sampled_parity(crowd(300, 8, 0.3, 2.0, 14), options_of(kind, 0.37), name);
    expect_sampled_parity(crowd(4000, 14, 0.8, 2.0, 15), options_of(kind, 1.7), name + " coarse");
    expect_sampled_parity(SphereSet({{{0, 0, 0}, 1.5}}), options_of(kind, 0.5), name + " one");
    ExtractOptions thesis = options_of(kind, 0.4);
    thesis.field.preset = FieldPreset::thesis;
    thesis.grid = preset_grid(thesis.field.preset, {}, {});
    expect_sampled_parity(crowd(100, 6, 1, 2, 16), thesis, name + " thesis");
  }
}

// Every case and every way to meet the border; some values are not numbers.
TEST_F(Parity, SampledNoise) {
  std::mt19937_64 random(17);
  std::uniform_real_distribution<float> value(-1, 1);
  for (const std::int64_t cells : {1, 6, 7, 8, 29, 30, 31, 32, 61}) {
    SampledField field{{{0.1, -0.2, 0.3}, 0.25, {cells, 17, 40 - cells / 2}}, {}, 0.25f};
    field.values.resize(field.grid.node_count());
    for (float& v : field.values) {
      v = value(random);
      if (v > 0.99f) v = std::numeric_limits<float>::quiet_NaN();
    }
    ExtractOptions options;
    options.connectivity = Connectivity::half_edges;
    expect_mesher_parity(field, options, "noise " + std::to_string(cells));
  }
}

void expect_same_levels(const std::vector<ProjectionStats>& cpu,
                        const std::vector<ProjectionStats>& cuda, const std::string& name) {
  ASSERT_EQ(cpu.size(), cuda.size());
  for (std::size_t l = 0; l < cpu.size(); ++l) {
    const ProjectionStats &a = cpu[l], &b = cuda[l];
    EXPECT_EQ(a.projected, b.projected) << name << " level " << l;
    EXPECT_EQ(a.unconverged, b.unconverged) << name << " level " << l;
    EXPECT_EQ(a.out_of_reach, b.out_of_reach) << name << " level " << l;
    EXPECT_EQ(a.undone, b.undone) << name << " level " << l;
    EXPECT_EQ(a.turned, b.turned) << name << " level " << l;
    EXPECT_EQ(a.iterations_max, b.iterations_max) << name << " level " << l;
    EXPECT_EQ(a.residual_max, b.residual_max) << name << " level " << l;
  }
}

// The whole pipeline: extraction, subdivision, projection.
void expect_pipeline_parity(const SphereSet& spheres, const ExtractOptions& extract,
                            int subdivisions, const std::string& what,
                            Crossings crossings = Crossings::undo) {
  RefineOptions refine;
  refine.crossings = crossings;
  refine.subdivisions = subdivisions;
  refine.field = extract.field;
  refine.projection = extract.field.kind == FieldKind::vdw ? Projection::vdw : Projection::field;
  const PipelineResult cpu = make_pipeline(Backend::cpu)->run(spheres, extract, refine);
  const PipelineResult cuda = make_pipeline(Backend::cuda)->run(spheres, extract, refine);
  const std::string name = what + " x" + std::to_string(subdivisions);
  expect_same(cpu.mesh, cuda.mesh, name);
  expect_same_levels(cpu.levels, cuda.levels, name);
}

// Meshes whose triangles name their spheres.
void expect_constrained_parity(const CreaseMesh& m, Projection projection,
                               const std::string& name) {
  for (const int subdivisions : {0, 1, 3}) {
    RefineOptions options;
    options.subdivisions = subdivisions;
    options.projection = projection;
    std::vector<IndexedMeshHash> seen[2];
    RefineResult results[2];
    for (const Backend backend : {Backend::cpu, Backend::cuda}) {
      const std::size_t which = backend == Backend::cuda;
      options.on_level = [&](int, const IndexedMesh& mesh) {
        IndexedMesh bare = mesh;  // without what an observer is not promised
        bare.normals.clear();
        bare.opposite.clear();
        seen[which].push_back(hash(bare));
      };
      results[which] = make_refiner(backend)->refine(m.spheres, m.mesh, options);
    }
    expect_same(results[0].mesh, results[1].mesh, name + " x" + std::to_string(subdivisions));
    expect_same_levels(results[0].levels, results[1].levels, name);
    EXPECT_EQ(seen[0], seen[1]) << name << ": levels seen";
  }
}

TEST_F(Parity, ConstrainedRefinement) {
  std::mt19937_64 random(31);
  std::uniform_real_distribution<double> place(-1, 1), size(1.2, 1.9), overlap(1e-9, 0.9);
  for (int i = 0; i < 8; ++i) {
    const Vec3d at{10 * place(random), 10 * place(random), 10 * place(random)};
    const Vec3d along = unit_along({place(random), place(random), place(random)});
    const double r = size(random), s = size(random);
    const Sphere a{at, r}, b{at + (r + s - overlap(random)) * along, s};
    const CreaseMesh two = two_balls_mesh(a, b, 7 + i, 3 + i);
    expect_constrained_parity(two, Projection::vdw, "two balls " + std::to_string(i));
    const Vec3d across = any_normal_to(along);
    const Sphere c{at + (0.5 * (r + s) * along) + 1.3 * across, size(random)};
    const std::array<Sphere, 3> three{Sphere{at, r}, {at + 1.8 * along, s}, c};
    const CreaseMesh cornered = three_balls_mesh(three, 4 + i, 5 + i);
    expect_constrained_parity(cornered, Projection::vdw, "three balls " + std::to_string(i));
    expect_constrained_parity(cornered, Projection::none, "three balls, no projection");
  }
}

TEST_F(Parity, RefinedCrowds) {
  for (const FieldKind kind : kFields) {
    for (const int subdivisions : {1, 2}) {
      expect_pipeline_parity(crowd(300, 8, 0.3, 2.0, 12), options_of(kind, 0.5), subdivisions,
                             std::string("refined ") + name_of(kind));
    }
  }
  expect_pipeline_parity(crowd(300, 8, 0.3, 2.0, 12), options_of(FieldKind::vdw, 0.5), 2,
                         "refined, crossings allowed", Crossings::allow);
  ExtractOptions thesis = options_of(FieldKind::inverse_squared, 0.4);
  thesis.field.preset = FieldPreset::thesis_vdw;
  thesis.grid = preset_grid(thesis.field.preset, {}, {});
  expect_pipeline_parity(crowd(200, 8, 1, 2, 13), thesis, 1, "refined thesis-vdw");
}

// Coarse meshes of sets unlike molecules, which cross themselves when they are projected: many
// vertices in a line or a plane, coordinates far from the origin, no volume to speak of, patches of
// very different sizes in the cells of a grid. From level 2 on a patch has parts.
TEST_F(Parity, RefinedSetsUnlikeMolecules) {
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Sphere> lattice, far, flat, large{{{0, 0, 0}, 3}};
  for (int i = 0; i < 27; ++i) {
    lattice.push_back({{1.5 * (i % 3), 1.5 * (i / 3 % 3), 1.5 * (i / 9)}, 1});
  }
  for (int i = 0; i < 9; ++i) {
    far.push_back({{3e4 + 3 * unit(random), -2e4 + 3 * unit(random), 1e5 + 3 * unit(random)},
                   0.5 + unit(random)});
    flat.push_back({{2 * unit(random), 2 * unit(random), 0.05 * unit(random)}, 0.5});
    large.push_back({{3 * unit(random), 3 * unit(random), 3 * unit(random)}, 0.3});
  }
  const std::vector<std::tuple<std::string, SphereSet, double>> sets = {
      {"lattice", SphereSet(lattice), 0.6},
      {"far away", SphereSet(far), 0.6},
      {"flat", SphereSet(flat), 0.5},
      {"small in large", SphereSet(large), 0.5},
      {"crowd of all sizes", crowd(300, 12, 0.1, 2.0, 5), 1.1}};
  for (const auto& [name, spheres, spacing] : sets) {
    const ExtractOptions extract = options_of(FieldKind::vdw, spacing);
    for (const int subdivisions : {0, 1, 3}) {
      expect_pipeline_parity(spheres, extract, subdivisions, name);
      // The given vertices lie on the spheres, so level 0 has nothing to take back.
      if (subdivisions == 0) continue;
      RefineOptions refine;
      refine.subdivisions = subdivisions;
      const auto run = [&] { return make_pipeline(Backend::cpu)->run(spheres, extract, refine); };
      const std::uint64_t with_crossings = taken_back(run().levels);
      refine.crossings = Crossings::allow;
      EXPECT_GT(with_crossings, taken_back(run().levels)) << name << ": nothing crosses";
    }
  }
}

const std::vector<std::string> kMolecules = {
    "110D", "133D", "1BK2",        "1CKB", "1F4K",     "1GZI",     "1HH0",    "1IZH",
    "1ORC", "1QL2", "1QL2_chainA", "4HHB", "4INS",     "4PTI",     "19HC",    "1CRN",
    "1EJG", "1F2N", "1L2Y",        "1UBQ", "2spheres", "3spheres", "benzene", "cube"};

TEST_F(Parity, RefinedMolecules) {
  VDWMESH_NEEDS_SHARED("reference/4PTI.xyzr");
  for (const std::string& name : kMolecules) {
    const SphereSet spheres = read_xyzr(shared_path("reference/" + name + ".xyzr"));
    for (const double spacing : {0.5, 0.25}) {
      for (const int subdivisions : {1, 2}) {
        expect_pipeline_parity(spheres, options_of(FieldKind::vdw, spacing), subdivisions,
                               name + " " + std::to_string(spacing));
      }
    }
  }
}

TEST_F(Parity, Ribosome) {
  const std::string file = plain_or_gzipped("reference/6ZU5.xyzr");
  VDWMESH_NEEDS_SHARED(file);
  const SphereSet spheres = read_xyzr(shared_path(file));
  for (const int subdivisions : {0, 1, 2}) {
    expect_pipeline_parity(spheres, options_of(FieldKind::vdw, 0.5), subdivisions, "6ZU5 0.5");
  }
  for (const int subdivisions : {0, 1}) {
    expect_pipeline_parity(spheres, options_of(FieldKind::vdw, 0.25), subdivisions, "6ZU5 0.25");
  }
}

TEST_F(Parity, Molecules) {
  VDWMESH_NEEDS_SHARED("reference/4PTI.xyzr");
  for (const std::string& name : kMolecules) {
    const SphereSet spheres = read_xyzr(shared_path("reference/" + name + ".xyzr"));
    for (const double spacing : {0.5, 0.25}) {
      expect_parity(spheres, options_of(FieldKind::vdw, spacing),
                    name + " " + std::to_string(spacing));
    }
    expect_parity(spheres, options_of(FieldKind::blinn, 0.5), name + " blinn");
  }
}

}  // namespace
}  // namespace vdwmesh::testing

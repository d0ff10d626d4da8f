// What several processes, frames and calls rest on: a given grid, a given frame of the cell list,
// ranges of bricks, and a workspace. The mesh of one plain call is the reference for all of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "contract/extractor_contract.hpp"
#include "core/errors.hpp"
#include "core/workspace.hpp"
#include "cuda/count_part.hpp"
#include "support/dice.hpp"
#include "support/extract_sets.hpp"

namespace vdwmesh::testing {
namespace {

enum class FrameOfPart { of_all, own };

class ExtractorParts : public ExtractorFieldContract {
 protected:
  std::unique_ptr<Extractor> extractor() const { return make_extractor(std::get<0>(GetParam())); }

  void expect_parts_of_rod(int of_piece, double pitch, double spacing, Connectivity connectivity,
                           FrameOfPart frame_of_part = FrameOfPart::of_all);
  void expect_refusals_beyond_frame(int spheres);
};

ExtractOptions with_half_edges(ExtractOptions options) {
  options.connectivity = Connectivity::half_edges;
  return options;
}

// Puts a part's arrays behind those of the mesh.
void append(IndexedMesh& mesh, const IndexedMesh& part) {
  const auto add = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  add(mesh.positions, part.positions);
  add(mesh.normals, part.normals);
  add(mesh.vertex_spheres.atoms, part.vertex_spheres.atoms);
  add(mesh.triangles, part.triangles);
  add(mesh.opposite, part.opposite);
}

// Triangles name vertices of their own part and of its halo behind it, and no others, and only the
// last ones those of the halo: by that, processes find the number of a vertex from its 32 bits.
void expect_named_vertices_near(const SurfacePart& part, const MeshSize& first,
                                const IndexedMesh& mesh) {
  const HaloVertices halo = part.halo();
  const std::uint64_t own_end = first.vertices + part.size().vertices;
  ASSERT_LE(halo.naming_triangles, mesh.triangle_count());
  const std::size_t first_naming = mesh.triangle_count() - halo.naming_triangles;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    for (const std::uint64_t corner : mesh.triangles[t]) {
      ASSERT_GE(corner, first.vertices);
      ASSERT_LT(corner, own_end + (t < first_naming ? 0 : halo.behind));
    }
  }
}

struct Joined {
  IndexedMesh mesh;
  ExtractStats stats;
};

// Meshes the ranges between the keys as processes do: all count, then all emit.
Joined join_parts(const Extractor& extractor, const SphereSet& spheres,
                  const ExtractOptions& options, const std::vector<std::uint64_t>& cuts) {
  std::vector<std::unique_ptr<SurfacePart>> parts;
  std::uint64_t begin = 0;
  for (const std::uint64_t cut : cuts) {
    parts.push_back(extractor.count(spheres, {begin, cut}, options));
    begin = cut;
  }
  parts.push_back(extractor.count(spheres, {begin, kNoBrickKey}, options));
  Joined joined;
  MeshSize first;
  for (const std::unique_ptr<SurfacePart>& part : parts) {
    IndexedMesh mesh;
    const ExtractStats stats = part->emit(first, mesh);
    EXPECT_EQ(mesh.vertex_count(), part->size().vertices);
    EXPECT_EQ(mesh.triangle_count(), part->size().triangles);
    expect_named_vertices_near(*part, first, mesh);
    append(joined.mesh, mesh);
    joined.stats += stats;
    first = {first.vertices + part->size().vertices, first.triangles + part->size().triangles};
  }
  return joined;
}

void expect_whole(const Joined& joined, const ExtractResult& whole, const std::string& what) {
  EXPECT_EQ(hash(joined.mesh), hash(whole.mesh)) << what;
  EXPECT_EQ(joined.stats.surface_bricks, whole.stats.surface_bricks) << what;
  EXPECT_EQ(joined.stats.clamped_vertices, whole.stats.clamped_vertices) << what;
  EXPECT_EQ(joined.stats.grid_clipped, whole.stats.grid_clipped) << what;
  EXPECT_EQ(joined.stats.unmatched_faces, 0) << what;
}

// Keys of random bricks of the grid, rising; some cut in the middle of a row or a layer.
std::vector<std::uint64_t> random_cuts(const GridSpec& grid, Dice& dice, int count) {
  std::vector<std::uint64_t> cuts;
  const auto below = [&](std::int64_t cells) {
    return static_cast<std::int32_t>(dice.whole(0, static_cast<int>(cells / kBrickSide) + 1));
  };
  for (int i = 0; i < count; ++i) {
    cuts.push_back(brick_key({below(grid.cells.x), below(grid.cells.y), below(grid.cells.z)}));
  }
  std::ranges::sort(cuts);
  return cuts;
}

// A halo is never larger than what is around the range, and a whole mesh has none. Only half-edges
// need what is before the range.
TEST_P(ExtractorParts, HalosArePartOfTheMesh) {
  const SphereSet spheres = cluster(300, 11);
  const ExtractOptions options = at_spacing(0.4);
  const ExtractResult whole = extract(spheres, options);
  Dice dice(17);
  std::uint64_t begin = 0, before = 0;
  for (const std::uint64_t cut : random_cuts(whole.grid, dice, 5)) {
    const auto part = extractor()->count(spheres, {begin, cut}, options);
    const std::uint64_t behind = whole.mesh.vertex_count() - before - part->size().vertices;
    EXPECT_EQ(part->halo().before, 0u);
    EXPECT_LE(part->halo().behind, behind);
    EXPECT_TRUE(behind == 0 || part->size().triangles == 0 || part->halo().behind > 0);
    const auto joined = extractor()->count(spheres, {begin, cut}, with_half_edges(options));
    EXPECT_LE(joined->halo().before, before);
    EXPECT_TRUE(before == 0 || part->size().triangles == 0 || joined->halo().before > 0);
    before += part->size().vertices;
    begin = cut;
  }
  const HaloVertices none = extractor()->count(spheres, {}, options)->halo();
  EXPECT_EQ(none.before, 0u);
  EXPECT_EQ(none.behind, 0u);
}

// As those of a part of a set, of which every third sphere is in the part. The cell list of few
// spheres is made on the host, that of many on the device.
TEST_P(ExtractorParts, LabelsCallSpheresByTheirIds) {
  const Backend backend = std::get<0>(GetParam());
  for (const int count : {300, 9000}) {
    const SphereSet spheres = cluster(count, 11);
    std::vector<SphereId> ids;
    for (int i = 0; i < count; ++i) ids.push_back(static_cast<SphereId>(3 * i + 1));
    const ExtractOptions options = at_spacing(1);
    IndexedMesh expected = extract(spheres, options).mesh;
    for (SphereId& atom : expected.vertex_spheres.atoms) {
      if (atom != kNoSphere) atom = ids[atom];
    }
    IndexedMesh mesh;
    count_part(backend, spheres, ids, {}, options)->emit({}, mesh);
    EXPECT_EQ(hash(mesh), hash(expected)) << count;
  }
}

TEST_P(ExtractorParts, RangesJoinToTheWholeMesh) {
  const SphereSet spheres = cluster(300, 11);
  for (const ExtractOptions& options : {at_spacing(0.4), with_half_edges(at_spacing(0.4))}) {
    const ExtractResult whole = extract(spheres, options);
    expect_sound(whole, "whole", options.connectivity);
    Dice dice(12);
    for (const int count : {0, 1, 2, 7, 40}) {
      const auto cuts = random_cuts(whole.grid, dice, count);
      expect_whole(join_parts(*extractor(), spheres, options, cuts), whole,
                   std::to_string(count) + " cuts");
    }
  }
}

TEST_P(ExtractorParts, RangesJoinWhateverTheSpheresAreLike) {
  Dice dice(13);
  for (std::uint32_t index = 0; index < 24; ++index) {
    ExtractSet set = extract_set(14, index);
    if (set.options.field.kind != kind()) continue;
    set.options.connectivity = Connectivity::half_edges;
    const ExtractResult whole = extract(set.spheres, set.options);
    const auto cuts = random_cuts(whole.grid, dice, 5);
    expect_whole(join_parts(*extractor(), set.spheres, set.options, cuts), whole, set.name);
  }
}

// A range far into the mesh numbers its corners from what it is told, modulo 2^32.
TEST_P(ExtractorParts, NumbersBeginWhereTheyAreToldTo) {
  const SphereSet spheres = cluster(60, 15);
  const ExtractOptions options = with_half_edges(at_spacing(0.5));
  const ExtractResult whole = extract(spheres, options);
  constexpr std::uint64_t kVertices = (std::uint64_t{1} << 32) + 5, kTriangles = 7;
  IndexedMesh mesh;
  extractor()->count(spheres, {}, options)->emit({kVertices, kTriangles}, mesh);
  ASSERT_EQ(mesh.triangle_count(), whole.mesh.triangle_count());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(mesh.triangles[t][k], whole.mesh.triangles[t][k] + 5) << t;
      ASSERT_EQ(mesh.opposite[3 * t + k], whole.mesh.opposite[3 * t + k] + 3 * kTriangles) << t;
    }
  }
  EXPECT_EQ(0, std::memcmp(mesh.positions.data(), whole.mesh.positions.data(),
                           mesh.positions.size() * sizeof(Vec3d)));
}

// In slabs too, which give up what counting had kept.
TEST_P(ExtractorParts, APartCanBeEmittedAgain) {
  const SphereSet spheres = cluster(200, 15);
  for (const std::uint64_t memory : {kNoMemoryLimit, std::uint64_t{3} << 20}) {
    ExtractOptions options = with_half_edges(at_spacing(0.4));
    options.device_memory = memory;
    const ExtractResult whole = extract(spheres, options);
    const auto part = extractor()->count(spheres, {}, options);
    for (const std::uint64_t first : {0u, 1000u, 0u, 0u}) {
      IndexedMesh mesh;
      const ExtractStats stats = part->emit({first, first}, mesh);
      EXPECT_EQ(stats.clamped_vertices, whole.stats.clamped_vertices);
      if (first == 0) {
        EXPECT_EQ(hash(mesh), hash(whole.mesh));
      }
    }
  }
}

TEST_P(ExtractorParts, ARangeWithoutSurfaceIsEmpty) {
  const SphereSet spheres = cluster(20, 16);
  const auto part = extractor()->count(spheres, {5, 5}, at_spacing(0.5));
  EXPECT_EQ(part->size().vertices, 0u);
  EXPECT_EQ(part->size().triangles, 0u);
  IndexedMesh mesh;
  part->emit({}, mesh);
  EXPECT_EQ(mesh.triangle_count(), 0u);
}

// ---- a given grid, a given frame ----

TEST_P(ExtractorParts, AGivenGridIsTaken) {
  const SphereSet spheres = cluster(80, 17);
  ExtractOptions options = at_spacing(0.45);
  const ExtractResult own = extract(spheres, options);
  options.grid = {};
  options.grid.spacing = 2;  // does not count
  options.grid.given = own.grid;
  const ExtractResult given = extract(spheres, options);
  EXPECT_EQ(hash(given.mesh), hash(own.mesh));
  EXPECT_EQ(given.grid.cells, own.grid.cells);

  // A ball alone on the same grid: all its vertices are on lines of that grid.
  options.grid.given = own.grid;
  const ExtractResult part = extract(SphereSet({spheres[0]}), options);
  expect_sound(part, "one ball on the grid of all");
  EXPECT_EQ(part.stats.grid_clipped, 0u);
}

TEST_P(ExtractorParts, AGridWithoutSenseIsRefused) {
  const SphereSet spheres = one_sphere(1);
  ExtractOptions options = at_spacing(0.5);
  const GridSpec good = make_grid(spheres, options.grid);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refuses = [&](GridSpec grid) {
    options.grid.given = grid;
    EXPECT_THROW(extract(spheres, options), InvalidInput);
  };
  refuses({good.origin, 0, good.cells});
  refuses({good.origin, -0.5, good.cells});
  refuses({good.origin, nan, good.cells});
  refuses({{nan, 0, 0}, 0.5, good.cells});
  refuses({good.origin, 0.5, {3, -1, 3}});
  options.grid.given = GridSpec{good.origin, 0.5, {3, kMaxCellsPerAxis + 1, 3}};
  EXPECT_THROW(extract(spheres, options), LimitExceeded);
}

// A process that has only the spheres near its range, with the grid and the frame of all, makes the
// same part: the sums of a blended field run in the same order there. A union of balls is no sum:
// its parts may have frames of their own.
// Without half-edges the bricks before the range are not needed, nor the spheres near them.
void ExtractorParts::expect_parts_of_rod(int of_piece, double pitch, double spacing,
                                         Connectivity connectivity, FrameOfPart frame_of_part) {
  std::vector<Sphere> rod;
  for (unsigned k = 0; k < 12; ++k) {
    const SphereSet piece = translated(cluster(of_piece, 18 + k), {0.3 * k, -0.2 * k, pitch * k});
    rod.insert(rod.end(), piece.spheres().begin(), piece.spheres().end());
  }
  const SphereSet spheres(rod);
  ExtractOptions options = at_spacing(spacing);
  options.connectivity = connectivity;
  const ExtractResult whole = extract(spheres, options);
  options.grid.given = whole.grid;
  const FieldModel model = make_field_model(options.field, whole.grid);
  const CellListFrame frame = make_field_frame(spheres, model);
  if (frame_of_part == FrameOfPart::of_all) options.frame = &frame;
  const std::int32_t layers = static_cast<std::int32_t>(whole.grid.cells.z / kBrickSide) + 1;
  ASSERT_GE(layers, 10);
  std::size_t fewest = spheres.size();
  Joined joined;
  MeshSize first;
  for (std::int32_t layer = 0; layer < layers; ++layer) {
    const KeyRange range{brick_key({0, 0, layer}),
                         layer + 1 == layers ? kNoBrickKey : brick_key({0, 0, layer + 1})};
    const int layers_before = connectivity == Connectivity::half_edges ? 1 : 0;
    const double reach = frame.levels.back().reach + 2 * whole.grid.spacing;
    const double thickness = kBrickSide * whole.grid.spacing;
    const double lower = whole.grid.origin.z + (layer - layers_before) * thickness - reach;
    const double upper = whole.grid.origin.z + (layer + 3) * thickness + reach;
    std::vector<Sphere> near;
    std::vector<SphereId> ids;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      if (spheres[i].center.z < lower || spheres[i].center.z > upper) continue;
      near.push_back(spheres[i]);
      ids.push_back(static_cast<SphereId>(i));
    }
    fewest = std::min(fewest, near.size());
    if (near.empty()) near.push_back(spheres[0]), ids.push_back(0);
    IndexedMesh mesh;
    const auto part = extractor()->count(SphereSet(near), range, options);
    joined.stats.unmatched_faces += part->emit(first, mesh).unmatched_faces;
    for (SphereId& id : mesh.vertex_spheres.atoms) id = ids[id];
    append(joined.mesh, mesh);
    first = {first.vertices + part->size().vertices, first.triangles + part->size().triangles};
  }
  EXPECT_EQ(hash(joined.mesh), hash(whole.mesh));
  EXPECT_EQ(joined.stats.unmatched_faces, 0);
  EXPECT_LT(fewest, spheres.size() / 2) << "the parts had nearly all spheres";
}

TEST_P(ExtractorParts, SpheresFarFromARangeAreNotNeeded) {
  expect_parts_of_rod(60, 7.3, 0.6, Connectivity::triangles);
  expect_parts_of_rod(60, 7.3, 0.6, Connectivity::half_edges);
}

TEST_P(ExtractorParts, PartsOfAUnionNeedNoFrame) {
  if (at_spacing(1).field.kind != FieldKind::vdw) return;
  expect_parts_of_rod(60, 7.3, 0.6, Connectivity::triangles, FrameOfPart::own);
  expect_parts_of_rod(5000, 28, 1.5, Connectivity::triangles, FrameOfPart::own);
}

// A device makes the cell list of so many spheres by itself, in the cells that it is given.
TEST_P(ExtractorParts, ManySpheresFarFromARangeAreNotNeeded) {
  expect_parts_of_rod(5000, 28, 1.5, Connectivity::half_edges);
}

void ExtractorParts::expect_refusals_beyond_frame(int spheres) {
  const SphereSet some = cluster(spheres, 19);
  ExtractOptions options = at_spacing(0.5);
  const FieldModel model = make_field_model(options.field, make_grid(some, options.grid));
  const CellListFrame frame = make_field_frame(some, model);
  options.frame = &frame;
  std::vector<Sphere> more(some.spheres().begin(), some.spheres().end());
  more.push_back({{1000, 0, 0}, 1.5});
  EXPECT_THROW(extract(SphereSet(more), options), InvalidInput);
  more.back() = {some[0].center, 1000};
  options.grid.spacing = 200;
  EXPECT_THROW(extract(SphereSet(more), options), InvalidInput);
}

TEST_P(ExtractorParts, ASphereBeyondTheFrameIsRefused) {
  expect_refusals_beyond_frame(20);
  expect_refusals_beyond_frame(9000);
}

// ---- a workspace ----

TEST_P(ExtractorParts, AWorkspaceChangesNoBit) {
  Workspace workspace;
  ExtractResult kept;
  for (std::uint32_t index = 0; index < 30; ++index) {
    ExtractSet set = extract_set(20, index);
    set.options.connectivity = index % 2 == 0 ? Connectivity::half_edges : Connectivity::triangles;
    set.options.normals = index % 3 == 0 ? Normals::none : Normals::gradients;
    const ExtractResult fresh = extract(set.spheres, set.options);
    set.options.workspace = &workspace;
    for (int again = 0; again < 2; ++again) {
      extractor()->extract_into(kept, set.spheres, set.options);
      EXPECT_EQ(hash(kept.mesh), hash(fresh.mesh)) << set.name;
    }
  }
}

// The list of a workspace belongs to the contents of a set, not to the set.
TEST_P(ExtractorParts, AWorkspaceSeesThatSpheresMoved) {
  Workspace workspace;
  ExtractOptions options = at_spacing(0.5);
  options.workspace = &workspace;
  SphereSet spheres = cluster(100, 21);
  const SphereSet frames[] = {cluster(100, 22), translated(spheres, {3, 1, -2}), spheres};
  extract(spheres, options);
  for (const SphereSet& frame : frames) {
    std::vector<Vec3d> centers;
    std::vector<Sphere> same;
    for (std::size_t i = 0; i < frame.size(); ++i) {
      centers.push_back(frame[i].center);
      same.push_back({frame[i].center, spheres[i].radius});
    }
    spheres.move_to(centers);
    EXPECT_EQ(hash(extract(spheres, options).mesh),
              hash(extract(SphereSet(same), at_spacing(0.5)).mesh));
  }
}

// Frames of one size: once the arrays are there, they stay where they are.
TEST_P(ExtractorParts, AMeshIsRefilledInPlace) {
  Workspace workspace;
  ExtractOptions options = at_spacing(0.5);
  options.workspace = &workspace;
  const SphereSet spheres = cluster(100, 23);
  ExtractResult result;
  extractor()->extract_into(result, spheres, options);
  const Vec3d* const positions = result.mesh.positions.data();
  const Triangle* const triangles = result.mesh.triangles.data();
  extractor()->extract_into(result, spheres, options);
  EXPECT_EQ(result.mesh.positions.data(), positions);
  EXPECT_EQ(result.mesh.triangles.data(), triangles);
}

VDWMESH_INSTANTIATE_FIELDS(ExtractorParts);

}  // namespace
}  // namespace vdwmesh::testing

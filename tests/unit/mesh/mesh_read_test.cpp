// Reading mesh files: what comes back of what was written, layouts of others, damaged files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <new>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "mesh/mesh_io.hpp"
#include "mesh_files.hpp"
#include "support/sanitized.hpp"
#include "support/temporary_directory.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using testing::expect_same_bits;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kFormats;
using testing::labelled_mesh;
using testing::round_trip;
using testing::TemporaryDirectory;

TEST(MeshIo, PlyKeepsTheSpheresOfFaces) {
  IndexedMesh mesh = labelled_mesh();
  EXPECT_TRUE(round_trip(mesh, MeshFormat::ply).mesh.triangle_spheres.empty());
  for (SphereId t = 0; t < mesh.triangle_count(); ++t) mesh.triangle_spheres.push_back(3 * t);
  mesh.triangle_spheres[4] = kNoSphere;
  const IndexedMesh back = round_trip(mesh, MeshFormat::ply).mesh;
  EXPECT_EQ(back.triangle_spheres, mesh.triangle_spheres);
  EXPECT_EQ(back.triangles, mesh.triangles);
  expect_same_bits(back, mesh);
}

// Not the layout that we write: the atom first, as another number, and a quadrilateral.
TEST(MeshIo, PlyFansPolygonsOfAtoms) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face 2\nproperty uchar atom\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n6 4 0 1 2 3\n2 3 0 2 1\n";
  const IndexedMesh mesh = decode_mesh(text, MeshFormat::ply).mesh;
  EXPECT_EQ(mesh.triangle_spheres, (Buffer<SphereId>{6, 6, 2}));
}

TEST(MeshIo, PlyKeepsEveryBit) {
  IndexedMesh mesh = labelled_mesh();
  mesh.positions[0] = {-0.0, std::numeric_limits<double>::denorm_min(), 1e300};
  mesh.positions[1] = {std::nextafter(1.0, 2.0), 0.1, -1.0 / 3};
  const MeshFile back = round_trip(mesh, MeshFormat::ply);
  expect_same_bits(back.mesh, mesh);
  EXPECT_EQ(back.mesh.triangles, mesh.triangles);
  EXPECT_EQ(back.mesh.normals, mesh.normals);
  EXPECT_EQ(back.mesh.vertex_spheres, mesh.vertex_spheres);
  EXPECT_FALSE(back.welded);
  EXPECT_THAT(back.notes, IsEmpty());
}

TEST(MeshIo, ObjAndOffKeepEveryBitOfPositions) {
  IndexedMesh mesh = labelled_mesh();
  mesh.positions[0] = {-0.0, std::numeric_limits<double>::denorm_min(), 1e300};
  for (const MeshFormat format : {MeshFormat::obj, MeshFormat::off}) {
    const MeshFile back = round_trip(mesh, format);
    expect_same_bits(back.mesh, mesh);
    EXPECT_EQ(back.mesh.triangles, mesh.triangles);
    EXPECT_THAT(back.notes, IsEmpty());
  }
  EXPECT_EQ(round_trip(mesh, MeshFormat::obj).mesh.normals, mesh.normals);
}

TEST(MeshIo, StlKeepsFloats) {
  const IndexedMesh mesh = labelled_mesh();
  const MeshFile back = round_trip(mesh, MeshFormat::stl);
  EXPECT_TRUE(back.welded);
  ASSERT_EQ(back.mesh.vertex_count(), mesh.vertex_count());
  ASSERT_EQ(back.mesh.triangle_count(), mesh.triangle_count());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    for (unsigned k = 0; k < 3; ++k)
      EXPECT_EQ(cast<float>(back.mesh.positions[back.mesh.triangles[t][k]]),
                cast<float>(mesh.positions[mesh.triangles[t][k]]));
  ASSERT_EQ(back.notes.size(), 1u);
  EXPECT_THAT(back.notes[0], HasSubstr("welded"));
}

TEST(MeshIo, GlbKeepsFloatsAboutItsOffset) {
  // Half the box is 17 Å < 2^5, so a float's rounding there is at most 2^-20 Å, wherever the mesh
  // lies; adding the offset back rounds in double.
  const double kRounding = 0x1p-20 + 1e-10;
  const IndexedMesh mesh = testing::translated(labelled_mesh(), {1e5, -2e5, 3e5});
  const EncodedMesh encoded = encode_mesh(to_surface_mesh(mesh), MeshFormat::glb);
  EXPECT_THAT(encoded.warnings, IsEmpty());
  const MeshFile back = decode_mesh(encoded.bytes, MeshFormat::glb);
  ASSERT_EQ(back.mesh.vertex_count(), mesh.vertex_count());
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    EXPECT_LE(norm(back.mesh.positions[v] - mesh.positions[v]), std::sqrt(3.0) * kRounding);
  EXPECT_EQ(back.mesh.triangles, mesh.triangles);
  EXPECT_EQ(back.mesh.normals, mesh.normals);
}

// The file with its JSON replaced, in chunks of whole words (glTF 2.0, 4.4).
std::string with_json(const std::string& glb, const nlohmann::json& json) {
  std::uint32_t old_size;
  std::memcpy(&old_size, glb.data() + 12, sizeof old_size);
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string bytes = glb.substr(0, 20) + text + glb.substr(20 + old_size);
  const auto json_size = static_cast<std::uint32_t>(text.size());
  const auto all = static_cast<std::uint32_t>(bytes.size());
  std::memcpy(bytes.data() + 8, &all, sizeof all);
  std::memcpy(bytes.data() + 12, &json_size, sizeof json_size);
  return bytes;
}

// A node's matrix stands in the file column by column (glTF 2.0, 5.25.3), and applies before that
// of its parent. Small whole numbers: no rounding.
TEST(MeshIo, GlbNodesMoveTheirMeshes) {
  const IndexedMesh mesh = testing::cube();
  const std::string glb = encode_mesh(to_surface_mesh(mesh), MeshFormat::glb).bytes;
  std::uint32_t json_size;
  std::memcpy(&json_size, glb.data() + 12, sizeof json_size);
  auto json = nlohmann::json::parse(glb.substr(20, json_size));
  // x' = 2 x - 3 y + 10, y' = x + z + 20, z' = 4 z - y + 30; then doubled, and moved along x. The
  // writer's own offset, by the middle of the box, does not matter.
  json["nodes"] = {
      {{"translation", {5, 0, 0}}, {"scale", {2, 2, 2}}, {"children", {1}}},
      {{"mesh", 0}, {"matrix", {2, 1, 0, 0, -3, 0, -1, 0, 0, 1, 4, 0, 10, 20, 30, 1}}}};
  json["scenes"] = {{{"nodes", {0}}}};
  json["scene"] = 0;
  const MeshFile moved = decode_mesh(with_json(glb, json), MeshFormat::glb);
  ASSERT_EQ(moved.mesh.vertex_count(), mesh.vertex_count());
  std::vector<float> stored(3 * mesh.vertex_count());
  std::memcpy(stored.data(), glb.data() + 20 + json_size + 8, stored.size() * sizeof(float));
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const double x = stored[3 * v], y = stored[3 * v + 1], z = stored[3 * v + 2];
    const Vec3d expected{2 * (2 * x - 3 * y + 10) + 5, 2 * (x + z + 20), 2 * (4 * z - y + 30)};
    EXPECT_EQ(moved.mesh.positions[v], expected);
  }
  // Its determinant is 2 (0·4 + 1) + 3 (1·4 - 0) > 0: no mirror.
  EXPECT_EQ(moved.mesh.triangles, mesh.triangles);
}

// A mirror turns the winding round, and normals still point out of the mesh: those of a sphere
// about the origin point away from it.
TEST(MeshIo, GlbNormalsOfAMirroredMeshPointOutward) {
  IndexedMesh mesh = testing::cube();
  const Vec3d middle = 0.5 * (mesh.positions.front() + mesh.positions.back());
  for (Vec3d& p : mesh.positions) p = p - middle;
  for (const Vec3d& p : mesh.positions) mesh.normals.push_back(cast<float>((1 / norm(p)) * p));
  const std::string glb = encode_mesh(to_surface_mesh(mesh), MeshFormat::glb).bytes;
  std::uint32_t json_size;
  std::memcpy(&json_size, glb.data() + 12, sizeof json_size);
  auto json = nlohmann::json::parse(glb.substr(20, json_size));
  json["nodes"] = {{{"mesh", 0}, {"scale", {-1, 1, 1}}}};
  json["scenes"] = {{{"nodes", {0}}}};
  json["scene"] = 0;
  const IndexedMesh mirrored = decode_mesh(with_json(glb, json), MeshFormat::glb).mesh;
  ASSERT_EQ(mirrored.normals.size(), mirrored.positions.size());
  for (std::size_t v = 0; v < mirrored.normals.size(); ++v) {
    EXPECT_GT(dot(cast<double>(mirrored.normals[v]), mirrored.positions[v]), 0) << v;
  }
  for (const Triangle& t : mirrored.triangles) {
    const Vec3d &a = mirrored.positions[t[0]], &b = mirrored.positions[t[1]],
                &c = mirrored.positions[t[2]];
    EXPECT_GT(dot(cross(b - a, c - a), a), 0);
  }
}

// The words of another format in a comment do not make a binary file a text.
TEST(MeshIo, ABinaryPlyMaySpeakOfTextInAComment) {
  std::string bytes = encode_mesh(to_surface_mesh(testing::cube()), MeshFormat::ply).bytes;
  const std::size_t at = bytes.find("comment");
  ASSERT_NE(at, std::string::npos);
  bytes.insert(at, "comment format ascii was too long\n");
  EXPECT_EQ(decode_mesh(bytes, MeshFormat::ply).mesh.triangles, testing::cube().triangles);
}

// The JSON of a GLB file.
nlohmann::json json_of(const std::string& glb) {
  std::uint32_t size;
  std::memcpy(&size, glb.data() + 12, sizeof size);
  return nlohmann::json::parse(glb.substr(20, size));
}

// An extension that the file requires is refused by name, unless it is about looks; one that it
// uses is named in a note.
TEST(MeshIo, GlbExtensionsAreAppliedNotedOrRefused) {
  const std::string glb = encode_mesh(to_surface_mesh(testing::cube()), MeshFormat::glb).bytes;
  const auto with = [&](const char* list, const char* name) {
    nlohmann::json json = json_of(glb);
    json[list] = {name};
    return decode_mesh(with_json(glb, json), MeshFormat::glb);
  };
  EXPECT_THAT(with("extensionsRequired", "KHR_materials_unlit").notes, IsEmpty());
  EXPECT_THAT(with("extensionsUsed", "EXT_mesh_gpu_instancing").notes, IsEmpty());
  EXPECT_THAT(with("extensionsUsed", "XY_bend").notes, ElementsAre(HasSubstr("XY_bend")));
  try {
    with("extensionsRequired", "KHR_draco_mesh_compression");
    FAIL() << "accepted";
  } catch (const FileFormatError& error) {
    EXPECT_THAT(error.what(), HasSubstr("KHR_draco_mesh_compression"));
  }
}

// The eight corners of the cube are the translations of EXT_mesh_gpu_instancing, whose transforms
// come before that of the node.
TEST(MeshIo, GlbInstancesArePlaced) {
  const IndexedMesh mesh = testing::cube();
  const std::string glb = encode_mesh(to_surface_mesh(mesh), MeshFormat::glb).bytes;
  nlohmann::json json = json_of(glb);
  json["nodes"] = {{{"mesh", 0}, {"scale", {2, 2, 2}}}};
  const IndexedMesh alone = decode_mesh(with_json(glb, json), MeshFormat::glb).mesh;
  auto& attributes = json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes["TRANSLATION"] = 0;
  attributes["SCALE"] = 0;
  const IndexedMesh placed = decode_mesh(with_json(glb, json), MeshFormat::glb).mesh;
  ASSERT_EQ(placed.vertex_count(), 8 * mesh.vertex_count());
  ASSERT_EQ(placed.triangle_count(), 8 * mesh.triangle_count());
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3d place = 0.5 * alone.positions[i];  // as stored
    for (std::size_t v = 0; v < 8; ++v) {
      const Vec3d &p = alone.positions[v], &q = placed.positions[8 * i + v];
      EXPECT_EQ(q, (Vec3d{place.x * p.x, place.y * p.y, place.z * p.z} + 2.0 * place));
    }
  }
  attributes["ROTATION"] = 0;  // three numbers where a quaternion has four
  EXPECT_THROW(decode_mesh(with_json(glb, json), MeshFormat::glb), FileFormatError);
}

// Primitives of a mesh that name the same vertices share them, so a file of many primitives makes
// no more of them; and a mesh that is placed too often is refused before memory is taken.
TEST(MeshIo, GlbPrimitivesShareVerticesWithinTheMemoryAllowed) {
  const IndexedMesh mesh = testing::icosphere(2);
  const std::string glb = encode_mesh(to_surface_mesh(mesh), MeshFormat::glb).bytes;
  nlohmann::json json = json_of(glb);
  auto& primitives = json["meshes"][0]["primitives"];
  for (int i = 1; i < 4; ++i) primitives.push_back(primitives[0]);
  const std::string many = with_json(glb, json);
  const IndexedMesh read = decode_mesh(many, MeshFormat::glb).mesh;
  EXPECT_EQ(read.vertex_count(), mesh.vertex_count());
  EXPECT_EQ(read.normals, decode_mesh(glb, MeshFormat::glb).mesh.normals);
  EXPECT_EQ(read.triangle_count(), 4 * mesh.triangle_count());
  const std::uint64_t bytes = 36 * mesh.vertex_count() + 48 * mesh.triangle_count();
  EXPECT_THROW(decode_mesh(many, MeshFormat::glb, bytes), LimitExceeded);
  EXPECT_NO_THROW(decode_mesh(many, MeshFormat::glb, bytes + 4 * 12));  // one more a primitive
}

// Strips and fans have the triangles of glTF 2.0, 3.7.2.1; a strip's double corners join its parts.
TEST(MeshIo, GlbStripsAndFans) {
  const std::string glb = encode_mesh(to_surface_mesh(testing::cube()), MeshFormat::glb).bytes;
  nlohmann::json json = json_of(glb);
  auto& primitive = json["meshes"][0]["primitives"][0];
  primitive.erase("indices");
  const auto triangles = [&](int mode) {
    primitive["mode"] = mode;
    return decode_mesh(with_json(glb, json), MeshFormat::glb).mesh.triangles;
  };
  EXPECT_THAT(triangles(5), ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}, Triangle{2, 3, 4},
                                        Triangle{3, 5, 4}, Triangle{4, 5, 6}, Triangle{5, 7, 6}));
  EXPECT_THAT(triangles(6), ElementsAre(Triangle{1, 2, 0}, Triangle{2, 3, 0}, Triangle{3, 4, 0},
                                        Triangle{4, 5, 0}, Triangle{5, 6, 0}, Triangle{6, 7, 0}));
}

// Two of the last triangle's indices without the third.
TEST(MeshIo, GlbSaysWhatItsPrimitivesLeaveOver) {
  const std::string glb = encode_mesh(to_surface_mesh(labelled_mesh()), MeshFormat::glb).bytes;
  std::uint32_t json_size;
  std::memcpy(&json_size, glb.data() + 12, sizeof json_size);
  auto json = nlohmann::json::parse(glb.substr(20, json_size));
  const std::size_t index = json["meshes"][0]["primitives"][0]["indices"];
  auto& count = json["accessors"][index]["count"];
  count = count.get<std::size_t>() - 1;
  const std::size_t whole = decode_mesh(glb, MeshFormat::glb).mesh.triangles.size();
  const MeshFile cut = decode_mesh(with_json(glb, json), MeshFormat::glb);
  EXPECT_EQ(cut.mesh.triangles.size(), whole - 1);
  ASSERT_EQ(cut.notes.size(), 1u);
  EXPECT_THAT(cut.notes[0], HasSubstr("2 indices at the ends of primitives"));
}

TEST(MeshIo, GlbSaysThatMorphTargetsAreNotApplied) {
  const std::string glb = encode_mesh(to_surface_mesh(labelled_mesh()), MeshFormat::glb).bytes;
  std::uint32_t json_size;
  std::memcpy(&json_size, glb.data() + 12, sizeof json_size);
  auto json = nlohmann::json::parse(glb.substr(20, json_size));
  json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}};
  const MeshFile moved = decode_mesh(with_json(glb, json), MeshFormat::glb);
  EXPECT_EQ(moved.mesh.positions, decode_mesh(glb, MeshFormat::glb).mesh.positions);
  ASSERT_EQ(moved.notes.size(), 1u);
  EXPECT_THAT(moved.notes[0], HasSubstr("1 meshes have morph targets"));
}

TEST(MeshIo, EmptyMeshesMakeTheRoundTrip) {
  for (const MeshFormat format : kFormats) {
    const MeshFile back = round_trip({}, format);
    EXPECT_EQ(back.mesh.vertex_count(), 0u);
    EXPECT_EQ(back.mesh.triangle_count(), 0u);
  }
}

TEST(MeshIo, OpenMeshesMakeTheRoundTrip) {
  for (const MeshFormat format : kFormats)
    EXPECT_EQ(round_trip(testing::flat_ring(), format).mesh.triangle_count(), 8u);
}

TEST(MeshIo, KnowsFormatsByExtension) {
  EXPECT_EQ(mesh_format("a/b.PLY"), MeshFormat::ply);
  EXPECT_EQ(mesh_format("x.stl"), MeshFormat::stl);
  EXPECT_THROW(mesh_format("x.xyz"), InvalidInput);
  EXPECT_THROW(mesh_format("ply"), InvalidInput);
  EXPECT_EQ(find_mesh_format("a.GlB"), MeshFormat::glb);
  EXPECT_FALSE(find_mesh_format("a.pdb"));
}

TEST(MeshIo, NamesTheFileInErrors) {
  const TemporaryDirectory directory;
  const SurfaceMesh mesh = to_surface_mesh(testing::cube());
  const auto message = [](auto&& action) -> std::string {
    try {
      action();
    } catch (const FileFormatError& error) {
      return error.what();
    }
    return "";
  };
  const fs::path missing = directory / "missing.ply", nowhere = directory / "no/such.ply";
  EXPECT_THAT(message([&] { read_mesh(missing); }), HasSubstr(missing.string()));
  EXPECT_THAT(message([&] { write_mesh(mesh, nowhere); }), HasSubstr(nowhere.string()));
  fs::create_directory(directory / "d.ply");
  EXPECT_THAT(message([&] { write_mesh(mesh, directory / "d.ply"); }), HasSubstr("d.ply"));
  EXPECT_THAT(message([&] { read_mesh(directory / "d.ply"); }), HasSubstr("d.ply"));
  std::ofstream(directory / "bad.obj") << "v 1 2 3\nv 1 2\n";
  EXPECT_THAT(message([&] { read_mesh(directory / "bad.obj"); }), HasSubstr("bad.obj: line 2"));
}

// Readers must refuse or accept a damaged file, and nothing else; sanitizers watch.
TEST(MeshIo, DamagedFilesAreRefusedOrRead) {
  std::mt19937 random(11);
  const SurfaceMesh mesh = to_surface_mesh(testing::icosphere(1));
  for (const MeshFormat format : kFormats) {
    const std::string good = encode_mesh(mesh, format).bytes;
    const auto try_to_read = [&](const std::string& bytes) {
      try {
        decode_mesh(bytes, format);
      } catch (const Error&) {
      }
    };
    for (std::size_t size = 0; size < good.size(); size += 1 + size / 200)
      try_to_read(good.substr(0, size));
    for (int round = 0; round < testing::sets(2000, 200); ++round) {
      std::string bad = good;
      for (int flips = 0; flips < 1 + round % 4; ++flips)
        bad[random() % (round % 2 == 0 ? bad.size() : std::min<std::size_t>(bad.size(), 700))] =
            static_cast<char>(random());
      try_to_read(bad);
    }
  }
}

// The sanitizers take more address space than any limit of ours.
#ifndef VDWMESH_SANITIZED
std::ptrdiff_t open_descriptors() {
  return std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator());
}

TEST(MeshIo, FilesThatDoNotFitMemoryAreClosed) {
  const TemporaryDirectory directory;
  const fs::path path = directory / "large.off";
  std::ofstream(path).close();
  fs::resize_file(path, std::uintmax_t{1} << 36);  // a hole: takes no room on the disk
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  const std::ptrdiff_t open = open_descriptors();
  const rlimit small{rlim_t{1} << 34, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_AS, &small), 0);
  EXPECT_THROW(read_mesh(path), std::bad_alloc);
  EXPECT_EQ(setrlimit(RLIMIT_AS, &before), 0);
  EXPECT_EQ(open_descriptors(), open);
}
#endif

}  // namespace
}  // namespace vdwmesh

#include "mesh/mesh_io.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <csignal>
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
#include <string_view>
#include <vector>

#include "core/errors.hpp"
#include "core/monitor.hpp"
#include "mesh/patch_properties.hpp"
#include "support/sanitized.hpp"
#include "support/temporary_directory.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::TemporaryDirectory;

constexpr MeshFormat kFormats[] = {MeshFormat::ply, MeshFormat::obj, MeshFormat::off,
                                   MeshFormat::stl, MeshFormat::glb};

// A mesh with coordinates that use every bit, normals and labels.
IndexedMesh labelled_mesh(double size = 50) {
  IndexedMesh mesh = testing::scaled(testing::icosphere(3), size / 3);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> shake(-0.01, 0.01);
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    Vec3d& p = mesh.positions[v];
    p = p + Vec3d{shake(random), shake(random), shake(random)};
    mesh.normals.push_back(cast<float>((1 / norm(p)) * p));
    mesh.vertex_spheres.push_back({v, v % 3 == 0 ? kNoSphere : v / 2, kNoSphere});
  }
  return mesh;
}

MeshFile round_trip(const IndexedMesh& mesh, MeshFormat format) {
  return decode_mesh(encode_mesh(to_surface_mesh(mesh), format).bytes, format);
}

bool same_bits(const Vec3d& a, const Vec3d& b) {
  for (int k = 0; k < 3; ++k)
    if (std::bit_cast<std::uint64_t>(a[k]) != std::bit_cast<std::uint64_t>(b[k])) return false;
  return true;
}

void expect_same_bits(const IndexedMesh& a, const IndexedMesh& b) {
  ASSERT_EQ(a.vertex_count(), b.vertex_count());
  for (std::size_t v = 0; v < a.vertex_count(); ++v)
    EXPECT_TRUE(same_bits(a.positions[v], b.positions[v])) << "vertex " << v;
}

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

// The patches stand behind what other programs read, and the curvatures behind each vertex.
TEST(MeshIo, PlySaysOfWhichPatchesASurfaceIsMade) {
  PatchedMesh patched;
  patched.mesh = labelled_mesh();
  SurfacePatch sphere, torus;
  sphere.atoms = {7, kNoSphere, kNoSphere};
  sphere.radius = 2;
  torus.kind = PatchKind::saddle;
  torus.atoms = {3, 5, kNoSphere};
  patched.patches = {sphere, torus};
  const std::size_t faces = patched.mesh.triangle_count(), vertices = patched.mesh.vertex_count();
  patched.triangle_patch.assign(faces, 0);
  SurfaceMesh mesh = to_surface_mesh(patched.mesh);
  EXPECT_FALSE(patch_properties(mesh).has_value());
  const std::string plain = encode_mesh(mesh, MeshFormat::ply).bytes;
  add_patch_properties(mesh, patched);
  mesh.property(patch_properties(mesh)->kind, OpenMesh::FaceHandle(int(faces) - 1)) = torus.kind;
  mesh.property(patch_properties(mesh)->atoms, OpenMesh::FaceHandle(int(faces) - 1)) = torus.atoms;
  const std::string bytes = encode_mesh(mesh, MeshFormat::ply).bytes;
  const std::size_t header = bytes.find("end_header\n") + 11;
  EXPECT_EQ(bytes.size() - header,
            plain.size() - (plain.find("end_header\n") + 11) + 8 * vertices + 13 * faces);
  for (const char* line :
       {"property int sphere3\nproperty float mean_curvature\nproperty float gaussian_curvature\n",
        "vertex_indices\nproperty uchar patch_kind\nproperty int patch_atom1\n"}) {
    EXPECT_THAT(bytes.substr(0, header), HasSubstr(line));
  }
  const auto number_at = [&]<class T>(std::size_t place, T) {
    T value;
    std::memcpy(&value, &bytes[place], sizeof value);
    return value;
  };
  EXPECT_EQ(number_at(header + 51, 0.0f), 0.5f);   // behind the first vertex: 1/r
  EXPECT_EQ(number_at(header + 55, 0.0f), 0.25f);  // 1/r²
  EXPECT_EQ(bytes[bytes.size() - 13], 1);
  EXPECT_EQ(number_at(bytes.size() - 12, 0), 3);
  EXPECT_EQ(number_at(bytes.size() - 8, 0), 5);
  EXPECT_EQ(number_at(bytes.size() - 4, 0), -1);
  EXPECT_EQ(number_at(header + 59 * vertices + 14, 0), 7);
  const IndexedMesh back = decode_mesh(bytes, MeshFormat::ply).mesh;
  expect_same_bits(back, patched.mesh);
  EXPECT_EQ(back.triangles, patched.mesh.triangles);
  EXPECT_EQ(back.vertex_spheres, patched.mesh.vertex_spheres);
  EXPECT_TRUE(back.triangle_spheres.empty());
  patched.triangle_patch.pop_back();
  EXPECT_THROW(add_patch_properties(mesh, patched), InvalidInput);
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

// The least and the greatest of the floats as stored, bit for bit, as glTF wants them.
TEST(MeshIo, GlbNamesTheBoundsOfItsFloats) {
  const IndexedMesh mesh = testing::translated(labelled_mesh(), {7, -13, 0.1});
  const std::string bytes = encode_mesh(to_surface_mesh(mesh), MeshFormat::glb).bytes;
  std::uint32_t json_size;
  std::memcpy(&json_size, bytes.data() + 12, sizeof json_size);
  const auto json = nlohmann::json::parse(bytes.substr(20, json_size));
  const auto& accessor = json.at("accessors").at(0);
  ASSERT_EQ(accessor.at("count"), mesh.vertex_count());
  std::vector<float> floats(3 * mesh.vertex_count());
  std::memcpy(floats.data(), bytes.data() + 20 + json_size + 8, floats.size() * sizeof(float));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float least = floats[axis], greatest = floats[axis];
    for (std::size_t i = axis; i < floats.size(); i += 3) {
      least = std::min(least, floats[i]);
      greatest = std::max(greatest, floats[i]);
    }
    EXPECT_EQ(accessor.at("min").at(axis).get<double>(), double{least});
    EXPECT_EQ(accessor.at("max").at(axis).get<double>(), double{greatest});
  }
}

TEST(MeshIo, WarnsWhereFloatsLoseTooMuch) {
  const auto warnings = [](const IndexedMesh& mesh, MeshFormat format) {
    return encode_mesh(to_surface_mesh(mesh), format).warnings.size();
  };
  // Near 5000 Å floats are 2^-11 Å = 5e-4 Å apart.
  const IndexedMesh far = testing::translated(labelled_mesh(), {5000, 0, 0});
  EXPECT_EQ(warnings(far, MeshFormat::stl), 1u);
  EXPECT_EQ(warnings(far, MeshFormat::glb), 0u);
  EXPECT_EQ(warnings(far, MeshFormat::ply), 0u);
  EXPECT_EQ(warnings(labelled_mesh(), MeshFormat::stl), 0u);
  EXPECT_EQ(warnings(labelled_mesh(20000), MeshFormat::glb), 1u);
  EXPECT_THROW(warnings(testing::scaled(testing::cube(), 1e40), MeshFormat::stl), InvalidInput);
}

TEST(MeshIo, WarnsWhereStlCollapsesTriangles) {
  IndexedMesh mesh = testing::tetrahedron();
  mesh.positions[1] = {1e-12, 0, 0};
  mesh = testing::translated(mesh, {1, 1, 1});
  const EncodedMesh encoded = encode_mesh(to_surface_mesh(mesh), MeshFormat::stl);
  ASSERT_EQ(encoded.warnings.size(), 1u);
  EXPECT_THAT(encoded.warnings[0], HasSubstr("corners of 2 triangles"));
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

TEST(MeshIo, FilesAppearUnderTheirNames) {
  const TemporaryDirectory directory;
  const SurfaceMesh mesh = to_surface_mesh(testing::cube());
  for (const char* name : {"a.ply", "a.obj", "a.off", "a.stl", "a.glb"}) {
    write_mesh(mesh, directory / name);
    write_mesh(mesh, directory / name);  // over the file that is there
    EXPECT_EQ(read_mesh(directory / name).mesh.triangle_count(), 12u) << name;
  }
  EXPECT_EQ(directory.names().size(), 5u);
}

// Stops after some questions; counts them.
class CountingMonitor : public Monitor {
 public:
  explicit CountingMonitor(int most) : most_(most) {}
  void begin_stage(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return ++asked_ > most_; }
  int asked() const { return asked_; }

 private:
  int most_;
  mutable int asked_ = 0;
};

TEST(MeshIo, WritersAskOftenWhetherToStop) {
  constexpr std::uintmax_t kBetween = std::uintmax_t{1} << 19;  // bytes: milliseconds of work
  const TemporaryDirectory directory;
  const SurfaceMesh mesh = to_surface_mesh(testing::icosphere(testing::kSanitized ? 6 : 7));
  for (const char* name : {"a.ply", "a.obj", "a.off", "a.stl", "a.glb"}) {
    const CountingMonitor patient(std::numeric_limits<int>::max());
    write_mesh(mesh, directory / name, &patient);
    EXPECT_GE(patient.asked() * kBetween, fs::file_size(directory / name)) << name;
    fs::remove(directory / name);
    const CountingMonitor impatient(patient.asked() / 2);
    EXPECT_THROW(write_mesh(mesh, directory / name, &impatient), Cancelled) << name;
  }
  EXPECT_THAT(directory.names(), IsEmpty());
}

TEST(MeshIo, NothingIsLeftOfAFileThatCannotBeWrittenInFull) {
  const TemporaryDirectory directory;
  const SurfaceMesh mesh = to_surface_mesh(testing::icosphere(5));
  std::ofstream(directory / "old.ply") << "kept";
  rlimit before;
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 10'000;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  for (const char* name : {"new.ply", "old.ply", "new.obj", "new.glb"})
    EXPECT_THROW(write_mesh(mesh, directory / name), FileFormatError) << name;
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(directory.names(), ElementsAre("old.ply"));
  EXPECT_EQ(fs::file_size(directory / "old.ply"), 4u) << "the old file is untouched";
}

TEST(MeshIo, AFullDiskIsAnError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
  const TemporaryDirectory directory;
  fs::create_symlink("/dev/full", directory / "full.ply");
  EXPECT_THROW(write_mesh(to_surface_mesh(testing::cube()), directory / "full.ply"),
               FileFormatError);
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

TEST(MeshIo, RefusesToWriteWhatIsDeletedOrNotFinite) {
  SurfaceMesh deleted = to_surface_mesh(testing::icosphere(1));
  deleted.delete_face(OpenMesh::FaceHandle(3));
  EXPECT_THROW(encode_mesh(deleted, MeshFormat::ply), InvalidInput);
  SurfaceMesh infinite = to_surface_mesh(testing::cube());
  infinite.set_point(OpenMesh::VertexHandle(2), {0, std::nan(""), 0});
  EXPECT_THROW(encode_mesh(infinite, MeshFormat::obj), InvalidInput);
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

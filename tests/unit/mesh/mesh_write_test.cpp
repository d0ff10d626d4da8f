// Writing mesh files: their bytes, warnings, and what is left when that fails.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/errors.hpp"
#include "core/monitor.hpp"
#include "mesh/element_color.hpp"
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
using testing::labelled_mesh;
using ::testing::StartsWith;
using testing::TemporaryDirectory;

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), {});
}

// Text has the same numbers: doubles, floats that are doubles with the same value, and integers.
TEST(MeshIo, TextOfPlyIsReadBackTheSame) {
  IndexedMesh mesh = labelled_mesh();
  mesh.positions[0] = {1.0 / 3, -1e-308, 123456.789012345};
  const MeshFile binary = decode_mesh(encode_mesh(mesh, MeshFormat::ply).bytes, MeshFormat::ply);
  const std::string text = encode_mesh(mesh, MeshFormat::ply, MeshEncoding::text).bytes;
  EXPECT_THAT(text, StartsWith("ply\nformat ascii 1.0\n"));
  const MeshFile read = decode_mesh(text, MeshFormat::ply);
  EXPECT_EQ(read.mesh.positions, binary.mesh.positions);
  EXPECT_EQ(read.mesh.triangles, binary.mesh.triangles);
  EXPECT_EQ(read.mesh.normals, binary.mesh.normals);
  EXPECT_EQ(read.mesh.vertex_spheres.atoms, binary.mesh.vertex_spheres.atoms);
  EXPECT_EQ(read.mesh.triangle_spheres, binary.mesh.triangle_spheres);
}

// A cube with a lid, and one without parts but the first.
std::vector<NamedMesh> two_cubes() {
  NamedMesh lidded{.name = "cube 1",
                   .mesh = testing::cube(),
                   .parts = {},
                   .part_names = {"cube 1 wall", "cube 1 lid"},
                   .part_colors = {{255, 0, 0, 128}, {0, 255, 0, 255}}};
  lidded.parts.assign(lidded.mesh.triangle_count(), 0);
  lidded.parts[0] = lidded.parts[1] = 1;
  NamedMesh plain = lidded;
  plain.name = "cube 2", plain.part_names = {"cube 2 wall", "cube 2 lid"};
  plain.parts.assign(plain.mesh.triangle_count(), 0);
  return {lidded, plain};
}

TEST(MeshIo, SeveralMeshesAsGlbHaveANodeForEachPart) {
  const std::vector<NamedMesh> meshes = two_cubes();
  const std::string bytes = encode_meshes(meshes, MeshFormat::glb).bytes;
  std::uint32_t size = 0;
  std::memcpy(&size, bytes.data() + 12, sizeof size);
  const auto json = nlohmann::json::parse(bytes.substr(20, size));
  ASSERT_EQ(json["nodes"].size(), 3u);
  EXPECT_EQ(json["nodes"][0]["name"], "cube 1");
  EXPECT_EQ(json["nodes"][0]["children"], nlohmann::json({1}));
  EXPECT_EQ(json["nodes"][1]["name"], "cube 1 lid");
  EXPECT_EQ(json["scenes"][0]["nodes"], nlohmann::json({0, 2}));
  EXPECT_EQ(json["materials"][0]["alphaMode"], "BLEND");
  EXPECT_FALSE(json["materials"][1].contains("alphaMode"));
  // Read back, the parts lie where they were: each cube's area and place.
  const IndexedMesh read = decode_mesh(bytes, MeshFormat::glb).mesh;
  EXPECT_EQ(read.triangle_count(), 2 * meshes[0].mesh.triangle_count());
  for (const Vec3d& p : read.positions)
    EXPECT_THAT(meshes[0].mesh.positions, ::testing::Contains(p));
}

TEST(MeshIo, SeveralMeshesAsObjAndThreeMfKeepVerticesShared) {
  const std::vector<NamedMesh> meshes = two_cubes();
  const std::string obj = encode_meshes(meshes, MeshFormat::obj).bytes;
  EXPECT_THAT(obj, HasSubstr("\no cube_1\n"));
  EXPECT_THAT(obj, HasSubstr("\ng cube_1_lid\n"));
  const IndexedMesh read = decode_mesh(obj, MeshFormat::obj).mesh;
  EXPECT_EQ(read.vertex_count(), 2 * meshes[0].mesh.vertex_count());
  EXPECT_EQ(read.triangle_count(), 2 * meshes[0].mesh.triangle_count());
  EXPECT_THAT(encode_meshes(meshes, MeshFormat::three_mf).bytes, StartsWith("PK"));
  EXPECT_THROW(encode_meshes(meshes, MeshFormat::ply), InvalidInput);
}

// Which keeps vertices apart that float32 lets fall together.
TEST(MeshIo, TextOfStlHasDoubles) {
  IndexedMesh mesh = testing::cube();
  for (Vec3d& p : mesh.positions) p = 1e-9 * p + Vec3d{1, 1, 1};
  const EncodedMesh text = encode_mesh(mesh, MeshFormat::stl, MeshEncoding::text);
  EXPECT_TRUE(text.warnings.empty());
  EXPECT_THAT(text.bytes, StartsWith("solid "));
  const MeshFile read = decode_mesh(text.bytes, MeshFormat::stl);
  EXPECT_THAT(read.mesh.positions, ::testing::UnorderedElementsAreArray(mesh.positions));
  EXPECT_EQ(read.mesh.triangle_count(), mesh.triangle_count());
  EXPECT_FALSE(encode_mesh(mesh, MeshFormat::stl).warnings.empty());
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
  patched.triangle_patch.back() = 1;
  const std::string plain = encode_mesh(patched.mesh, MeshFormat::ply).bytes;
  const TemporaryDirectory directory;
  write_mesh(patched, directory / "patched.ply");
  const std::string bytes = bytes_of(directory / "patched.ply");
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
  EXPECT_THROW(write_mesh(patched, directory / "patched.ply"), InvalidInput);
}

// The arrays of a mesh give the bytes that the half-edge mesh of the same arrays gives.
TEST(MeshIo, ArraysAndHalfEdgesGiveTheSameFiles) {
  const TemporaryDirectory directory;
  IndexedMesh mesh = labelled_mesh();
  std::vector<std::string> elements(mesh.vertex_count() + 1);
  std::vector<RgbColor> colors;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    elements[i] = i % 3 == 0 ? "C" : (i % 3 == 1 ? "o" : "Xx");
    colors.push_back(element_color(elements[i]));
  }
  for (const bool labels : {true, false}) {
    if (!labels) mesh.triangle_spheres.clear();
    SurfaceMesh built = to_surface_mesh(mesh);
    color_by_element(built, elements);
    for (const char* format : {"ply", "obj", "off", "stl", "glb"}) {
      const fs::path half_edges = directory / (std::string("half_edges.") + format),
                     arrays = directory / (std::string("arrays.") + format);
      write_mesh(built, half_edges);
      write_mesh(mesh, arrays, colors);
      EXPECT_TRUE(bytes_of(half_edges) == bytes_of(arrays)) << format;
    }
  }
  const auto expect_refused = [&](const IndexedMesh& bad, std::size_t count, const char* why) {
    const fs::path path = directory / "bad.ply";
    try {
      write_mesh(bad, path, std::span(colors).first(count));
      ADD_FAILURE() << "was written: " << why;
    } catch (const InvalidInput& error) {
      EXPECT_THAT(error.what(), HasSubstr(why));
    }
    EXPECT_FALSE(fs::exists(path));
  };
  expect_refused(mesh, 1, "but there are 1 colours");
  IndexedMesh without_vertex = mesh, without_label = mesh;
  without_vertex.triangles[1][2] = static_cast<std::uint32_t>(mesh.vertex_count());
  expect_refused(without_vertex, colors.size(), "triangle 1 names vertex");
  without_label.triangle_spheres.assign(1, 0);
  expect_refused(without_label, colors.size(), "1 triangle labels");
  IndexedMesh bad = mesh;
  bad.positions[1].y = std::numeric_limits<double>::infinity();
  expect_refused(bad, colors.size(), "vertex 1 is at");
  bad.normals.assign(1, {0, 0, 1});
  expect_refused(bad, colors.size(), "1 vertex normals");
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

// Viewers show linear colours by the inverse of sRGB's curve (IEC 61966-2-1), on a material that is
// no metal: then a byte of every value comes back.
TEST(MeshIo, GlbColorsAreLinearAndNoMetal) {
  SurfaceMesh mesh = to_surface_mesh(testing::icosphere(3));
  ASSERT_GE(mesh.n_vertices(), 256u);
  for (int v = 0; v < 256; ++v) {
    const auto byte = static_cast<unsigned char>(v);
    mesh.set_color(OpenMesh::VertexHandle(v), {byte, 255, 0});
  }
  const std::string bytes = encode_mesh(mesh, MeshFormat::glb).bytes;
  std::uint32_t json_size;
  std::memcpy(&json_size, bytes.data() + 12, sizeof json_size);
  const auto json = nlohmann::json::parse(bytes.substr(20, json_size));
  const auto& primitive = json.at("meshes").at(0).at("primitives").at(0);
  const auto& accessor =
      json.at("accessors").at(primitive.at("attributes").at("COLOR_0").get<std::size_t>());
  ASSERT_EQ(accessor.at("componentType"), 5123);  // unsigned short
  ASSERT_EQ(accessor.at("type"), "VEC4");
  ASSERT_EQ(accessor.at("normalized"), true);
  const std::size_t first =
      json.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>()).at("byteOffset");
  for (int v = 0; v < 256; ++v) {
    std::array<std::uint16_t, 4> stored;
    std::memcpy(stored.data(),
                bytes.data() + 20 + json_size + 8 + first + 8 * static_cast<std::size_t>(v),
                sizeof stored);
    const double linear = stored[0] / 65535.0;
    const double shown =
        linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    EXPECT_EQ(std::lround(255 * shown), v);
    EXPECT_EQ(stored[1], 65535);
    EXPECT_EQ(stored[2], 0);
    EXPECT_EQ(stored[3], 65535);
  }
  const auto& material = json.at("materials").at(primitive.at("material").get<std::size_t>());
  EXPECT_EQ(material.at("pbrMetallicRoughness").at("metallicFactor"), 0);
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

// A factor of two changes no digit of a double, nor of a float.
TEST(MeshIo, CoordinatesAreMultipliedByTheScale) {
  const testing::TemporaryDirectory folder;
  const IndexedMesh mesh = labelled_mesh();
  for (const char* name : {"a.ply", "a.obj", "a.off", "a.stl", "a.glb"}) {
    const fs::path path = folder.path() / name;
    const auto written = [&](const IndexedMesh& made, double scale) {
      write_mesh(made, path, {}, nullptr, MeshEncoding::binary, scale);
      return read_mesh(path).mesh;
    };
    expect_same_bits(written(mesh, 4), written(testing::scaled(mesh, 4), 1));
  }
}

TEST(MeshIo, RefusesScalesThatLeaveNoMesh) {
  const testing::TemporaryDirectory folder;
  for (const double scale : {0.0, -1.0, std::nan(""), HUGE_VAL, 1e308}) {
    EXPECT_THROW(write_mesh(labelled_mesh(), folder.path() / "a.ply", {}, nullptr,
                            MeshEncoding::binary, scale),
                 InvalidInput);
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

// Losses are told in Å, whatever the file's unit: here half of the step of floats near 5000 Å.
TEST(MeshIo, WarnsOfLossesInAngstrom) {
  const testing::TemporaryDirectory folder;
  const IndexedMesh far = testing::translated(labelled_mesh(), {5000, 0, 0});
  for (const double scale : {0.0625, 1.0, 1024.0}) {
    const std::vector<std::string> warnings =
        write_mesh(far, folder.path() / "a.stl", {}, nullptr, MeshEncoding::binary, scale);
    EXPECT_THAT(warnings, ElementsAre(HasSubstr("up to 2.4e-04 Å"))) << scale;
  }
}

TEST(MeshIo, WarnsWhereStlCollapsesTriangles) {
  IndexedMesh mesh = testing::tetrahedron();
  mesh.positions[1] = {1e-12, 0, 0};
  mesh = testing::translated(mesh, {1, 1, 1});
  const EncodedMesh encoded = encode_mesh(to_surface_mesh(mesh), MeshFormat::stl);
  ASSERT_EQ(encoded.warnings.size(), 1u);
  EXPECT_THAT(encoded.warnings[0], HasSubstr("corners of 2 triangles"));
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

TEST(MeshIo, RefusesToWriteWhatIsDeletedOrNotFinite) {
  SurfaceMesh deleted = to_surface_mesh(testing::icosphere(1));
  deleted.delete_face(OpenMesh::FaceHandle(3));
  EXPECT_THROW(encode_mesh(deleted, MeshFormat::ply), InvalidInput);
  SurfaceMesh infinite = to_surface_mesh(testing::cube());
  infinite.set_point(OpenMesh::VertexHandle(2), {0, std::nan(""), 0});
  EXPECT_THROW(encode_mesh(infinite, MeshFormat::obj), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh

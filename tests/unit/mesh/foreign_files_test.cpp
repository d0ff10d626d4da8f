// Files as other programs write them, made here by hand, and files that are wrong.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/errors.hpp"
#include "mesh/mesh_io.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

constexpr double kAreaRounding = 1e-12;  // Å², of areas up to 100

using ::testing::ElementsAre;
using ::testing::HasSubstr;

void expect_tetrahedron(const MeshFile& file) {
  ASSERT_EQ(file.mesh.vertex_count(), 4u);
  EXPECT_EQ(file.mesh.positions[1], (Vec3d{1, 0, 0}));
  EXPECT_TRUE(std::ranges::equal(file.mesh.triangles, testing::tetrahedron().triangles));
}

template <class T>
void append(std::string& bytes, T value, bool reverse = false) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if (reverse) std::reverse(raw, raw + sizeof value);
  bytes.append(raw, sizeof value);
}

TEST(PlyFile, AsciiWithOtherPropertiesAndElements) {
  const MeshFile file = decode_mesh(
      "ply\r\nformat ascii 1.0\r\ncomment hello\r\nobj_info x\r\nelement camera 1\r\n"
      "property float fov\r\nproperty list uchar float lens\r\n"
      "element vertex 4\r\nproperty float32 x\r\nproperty uchar red\r\nproperty float64 y\r\n"
      "property double z\r\nproperty list uchar int extra\r\nelement face 3\r\n"
      "property uchar flags\r\nproperty list uint8 int32 vertex_index\r\n"
      "property list uchar float texcoord\r\nend_header\r\n"
      "45 2 1.5 2.5\r\n"
      "0 255 0 0 0\r\n1 255 0 0 1 7\r\n1 3 1 0 0\r\n0 0 1 -1.5e0 2 8 9\r\n"
      "1 3 0 1 2 0\r\n0 4 0 1 2 3 2 0.5 0.5\r\n9 2 0 1 0\r\n",
      MeshFormat::ply);
  ASSERT_EQ(file.mesh.vertex_count(), 4u);
  EXPECT_EQ(file.mesh.positions[3], (Vec3d{0, 1, -1.5}));
  EXPECT_THAT(file.mesh.triangles,
              ElementsAre(Triangle{0, 1, 2}, Triangle{0, 1, 2}, Triangle{0, 2, 3}));
  ASSERT_EQ(file.notes.size(), 2u);
  EXPECT_THAT(file.notes[0], HasSubstr("1 polygons were fanned"));
  EXPECT_THAT(file.notes[1], HasSubstr("1 faces of fewer"));
}

std::string binary_ply(bool big, bool quads) {
  std::string bytes = "ply\nformat ";
  bytes += big ? "binary_big_endian" : "binary_little_endian";
  bytes +=
      " 1.0\nelement vertex 4\nproperty float x\nproperty short pad\nproperty double y\n"
      "property float z\nproperty int atom\nelement face 2\n"
      "property list ushort uint vertex_indices\nproperty uchar flag\nend_header\n";
  for (int v = 0; v < 4; ++v) {
    append(bytes, static_cast<float>(v) + 0.5f, big);
    append(bytes, std::int16_t{-7}, big);
    append(bytes, 0.1 * v, big);
    append(bytes, -1.0f, big);
    append(bytes, v - 1, big);
  }
  for (int f = 0; f < 2; ++f) {
    const std::uint16_t corners = quads ? 4 : 3;
    append(bytes, corners, big);
    for (std::uint32_t k = 0; k < corners; ++k) append(bytes, k, big);
    append(bytes, std::uint8_t{1});
  }
  return bytes;
}

TEST(PlyFile, BinaryOfEitherEndianness) {
  for (const bool big : {false, true})
    for (const bool quads : {false, true}) {
      const MeshFile file = decode_mesh(binary_ply(big, quads), MeshFormat::ply);
      ASSERT_EQ(file.mesh.vertex_count(), 4u);
      EXPECT_EQ(file.mesh.positions[3], (Vec3d{3.5, 0.1 * 3, -1}));
      EXPECT_EQ(file.mesh.vertex_spheres[0][0], kNoSphere);
      EXPECT_EQ(file.mesh.vertex_spheres[3][0], 2u);
      EXPECT_EQ(file.mesh.triangle_count(), quads ? 4u : 2u);
      EXPECT_TRUE(file.mesh.normals.empty());
    }
}

using Outline = std::vector<std::pair<double, double>>;

// A polygon in the plane of (u, v) as the only face of an OFF file.
MeshFile read_polygon(const Outline& outline, const Vec3d& u, const Vec3d& v) {
  std::string text = fmt::format("OFF\n{} 1 0\n", outline.size());
  std::string face = fmt::format("{}", outline.size());
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec3d p = outline[i].first * u + outline[i].second * v;
    for (int axis = 0; axis < 3; ++axis) text += fmt::format("{} ", p[axis]);
    face += fmt::format(" {}", i);
    text += "\n";
  }
  return decode_mesh(text + face + "\n", MeshFormat::off);
}

// Twice the area by the shoelace formula.
double twice_area(const Outline& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto &a = p[i], &b = p[(i + 1) % p.size()];
    sum += a.first * b.second - b.first * a.second;
  }
  return sum;
}

// As many triangles as a polygon of n corners is cut into, none of them facing backwards, of the
// polygon's area together: so they do not overlap and cover it.
void expect_cut(const Outline& outline, const std::string& note) {
  const Vec3d u{0.6, 0, 0.8}, v{0, 1, 0};
  for (std::size_t turn = 0; turn < outline.size(); ++turn) {  // whichever corner comes first
    Outline turned = outline;
    std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(turn), turned.end());
    const MeshFile file = read_polygon(turned, u, v);
    ASSERT_EQ(file.mesh.triangle_count(), outline.size() - 2);
    double sum = 0;
    for (const auto& [a, b, c] : file.mesh.triangles) {
      const auto& p = file.mesh.positions;
      const double area = dot(cross(p[b] - p[a], p[c] - p[a]), cross(u, v));
      EXPECT_GE(area, -kAreaRounding);
      sum += area;
    }
    EXPECT_NEAR(sum, twice_area(outline), kAreaRounding);
    if (turn == 0 && !note.empty()) {
      ASSERT_EQ(file.notes.size(), 1u);
      EXPECT_THAT(file.notes[0], HasSubstr(note));
    }
  }
}

TEST(Polygons, AreCutWithoutOverlap) {
  expect_cut({{0, 0}, {2, 0}, {2, 1}, {0, 1}}, "1 polygons were fanned");
  expect_cut({{0, 0}, {4, 0}, {4, 4}, {3, 1}}, "concave");
  expect_cut({{1, 1}, {0, 1}, {0, 0}, {2, 0}, {2, 2}, {1, 2}}, "");  // from its notch: a fan
  expect_cut({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 1}},
             "1 polygons were fanned");
  // A comb: teeth of which none sees the next.
  Outline comb{{0, 0}};
  for (int k = 0; k < 9; ++k) comb.insert(comb.end(), {{2.0 * k + 1, -5}, {2.0 * k + 2, 0}});
  comb.insert(comb.end(), {{18, 1}, {0, 1}});
  expect_cut(comb, "concave");
  // A spiral.
  Outline spiral;
  for (int k = 0; k < 40; ++k)
    spiral.push_back({(1 + 0.2 * k) * std::cos(0.4 * k), (1 + 0.2 * k) * std::sin(0.4 * k)});
  for (int k = 40; k-- > 0;)
    spiral.push_back({(1.5 + 0.2 * k) * std::cos(0.4 * k), (1.5 + 0.2 * k) * std::sin(0.4 * k)});
  std::reverse(spiral.begin(), spiral.end());
  expect_cut(spiral, "concave");
  // A square with a square hole, cut open along one line that is gone along twice.
  expect_cut({{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 0}, {3, 3}, {3, 6}, {6, 6}, {6, 3}, {3, 3}},
             "concave");
}

TEST(Polygons, ThatCrossThemselvesAreFannedAndSaid) {
  const MeshFile file =
      read_polygon({{0, 0}, {4, 4}, {4, 0}, {0, 3}}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0});
  EXPECT_EQ(file.mesh.triangle_count(), 2u);
  ASSERT_EQ(file.notes.size(), 1u);
  EXPECT_THAT(file.notes[0], HasSubstr("cross themselves"));
}

// Labels of faces are those of their triangles, however these lie.
TEST(Polygons, KeepTheirAtoms) {
  const MeshFile file = decode_mesh(
      "ply\nformat ascii 1.0\nelement face 2\nproperty list uchar int vertex_indices\n"
      "property int atom\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n4 0 1 2 3 7\n3 0 1 2 8\n0 0 0\n4 0 0\n4 4 0\n3 1 0\n",
      MeshFormat::ply);
  EXPECT_THAT(file.mesh.triangle_spheres, ElementsAre(7u, 7u, 8u));
  EXPECT_THAT(file.mesh.triangles[2], (Triangle{0, 1, 2}));
  double area = 0;
  for (std::size_t t = 0; t < 2; ++t) {
    const auto& [a, b, c] = file.mesh.triangles[t];
    const auto& p = file.mesh.positions;
    area += norm(cross(p[b] - p[a], p[c] - p[a])) / 2;
  }
  EXPECT_NEAR(area, 4, kAreaRounding);  // that of the arrow, by the shoelace formula
}

TEST(PlyFile, FacesBeforeVertices) {
  const MeshFile file = decode_mesh(
      "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n"
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
      "3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n",
      MeshFormat::ply);
  EXPECT_THAT(file.mesh.triangles, ElementsAre(Triangle{0, 1, 2}));
}

// A binary file of a square's corners and elements of faces that name an atom, or not.
class LabelledFaces {
 public:
  using Face = std::pair<int, int>;  // corners, atom
  void add(bool names_atom, const std::vector<Face>& faces) {
    elements_ += "element face " + std::to_string(faces.size()) +
                 "\nproperty list uchar int vertex_indices\n";
    if (names_atom) elements_ += "property int atom\n";
    for (const auto& [corners, atom] : faces) {
      append(body_, static_cast<std::uint8_t>(corners));
      for (int k = 0; k < corners; ++k) append(body_, k);
      if (names_atom) append(body_, atom);
    }
  }
  IndexedMesh read() const {
    std::string bytes =
        "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\n"
        "property float y\nproperty float z\n" +
        elements_ + "end_header\n";
    for (int k = 0; k < 12; ++k) append(bytes, static_cast<float>(k * k));
    return decode_mesh(bytes + body_, MeshFormat::ply).mesh;
  }

 private:
  std::string elements_, body_;
};

TEST(PlyFile, OnlySomeFacesNameAnAtom) {
  LabelledFaces file;
  file.add(false, {{3, 0}});
  file.add(true, {{3, 7}, {3, -5}, {4, 9}});
  file.add(false, {{3, 0}});
  const IndexedMesh mesh = file.read();
  const Triangle first{0, 1, 2};
  EXPECT_THAT(mesh.triangles, ElementsAre(first, first, first, first, Triangle{0, 2, 3}, first));
  EXPECT_THAT(mesh.triangle_spheres, ElementsAre(kNoSphere, 7, kNoSphere, 9, 9, kNoSphere));
}

TEST(PlyFile, NoFacesNameNoAtom) {
  LabelledFaces file;
  file.add(false, {{3, 0}, {3, 0}});
  file.add(true, {});
  EXPECT_THAT(file.read().triangle_spheres, ElementsAre());
  file.add(true, {{4, 2}});
  EXPECT_THAT(file.read().triangle_spheres, ElementsAre(kNoSphere, kNoSphere, 2, 2));
}

TEST(ObjFile, EveryKindOfCorner) {
  const MeshFile file = decode_mesh(
      "# comment\nmtllib a.mtl\no thing\nv 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv +0 1.0e0 0\nv 0 0 1\n"
      "vt 0 0\nvn 0 0 1\nvn 0 1 0\ng part\nusemtl none\ns off\n"
      "f 1 3 2\nf 1/1 2/1 4/1\nf -4//-2 -1//1 3//2 # end\nf 2/1/1 \\\n3/1/1 4/1/1\nl 1 2\n",
      MeshFormat::obj);
  expect_tetrahedron(file);
}

TEST(ObjFile, NormalsOfEveryVertex) {
  const MeshFile file = decode_mesh(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 1 0 0\nf 1//1 2//2 3//1\nf 1//2 3//1 2//2\n",
      MeshFormat::obj);
  EXPECT_THAT(file.mesh.normals, ElementsAre(Vec3f{0, 0, 1}, Vec3f{1, 0, 0}, Vec3f{0, 0, 1}));
  ASSERT_EQ(file.notes.size(), 1u);
  EXPECT_THAT(file.notes[0], HasSubstr("several normals"));
}

TEST(ObjFile, PolygonsAreFanned) {
  const MeshFile file =
      decode_mesh("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4", MeshFormat::obj);
  EXPECT_THAT(file.mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
}

TEST(ObjFile, FacesMayComeFirst) {
  EXPECT_EQ(
      decode_mesh("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 1 1 0\n", MeshFormat::obj).mesh.triangle_count(),
      1u);
}

TEST(OffFile, Kinds) {
  const std::string faces = "3 0 2 1\n3 0 1 3 255 0 0\n3 0 3 2 0.1 0.1 0.1\n3 1 2 3\n";
  expect_tetrahedron(
      decode_mesh("OFF\n# c\n4 4 0\n0 0 0\n1 0 0\n\n0 1 0\n0 0 1\n" + faces, MeshFormat::off));
  expect_tetrahedron(
      decode_mesh("OFF 4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n" + faces, MeshFormat::off));
  expect_tetrahedron(decode_mesh(
      "COFF\n4 4 6\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n0 0 1 1 1 1 1\n" + faces,
      MeshFormat::off));
  const MeshFile with_normals = decode_mesh(
      "NOFF\n4 4 6\n0 0 0 0 0 1\n1 0 0 1 0 0\n0 1 0 0 1 0\n0 0 1 0 0 1\n" + faces, MeshFormat::off);
  expect_tetrahedron(with_normals);
  EXPECT_EQ(with_normals.mesh.normals[1], (Vec3f{1, 0, 0}));
}

// As NanoShaper, MeshLab, ModelNet, Geomview and writers that count no edges make them.
TEST(OffFile, KindsOfOtherPrograms) {
  const std::string faces = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  const std::string plain = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n" + faces;
  const auto read = [](const std::string& text) { return decode_mesh(text, MeshFormat::off); };
  expect_tetrahedron(read(
      "OFF+A\n# File created by NanoShaper\n4 4 0\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\n" + faces));
  expect_tetrahedron(read("OFF4 4 6\n" + plain));
  expect_tetrahedron(read("4 4 6\n" + plain));
  expect_tetrahedron(read("OFF\n4 4\n" + plain));
  const std::string normals =
      "0 0 0 0 0 1 A\n1 0 0 1 0 0 A\n0 1 0 0 1 0 A\n0 0 1 0 0 1 A\n" + faces;
  for (const char* kind : {"OFF+N", "OFF+N+A", "NCOFF", "CNOFF", "STCNOFF"}) {
    const MeshFile file = read(std::string(kind) + "\n4 4 0\n" + normals);
    expect_tetrahedron(file);
    EXPECT_THAT(file.mesh.normals,
                ElementsAre(Vec3f{0, 0, 1}, Vec3f{1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{0, 0, 1}))
        << kind;
  }
}

TEST(StlFile, Ascii) {
  const MeshFile file = decode_mesh(
      "solid a b c\n  facet normal 0 0 1\n    outer loop\n      vertex 0 0 0\n"
      "      vertex 1 0 0\n      vertex 0 1 0\n    endloop\n  endfacet\n"
      "  facet normal 0 0 1\n    outer loop\n      VERTEX 1 0 -0\n      vertex 1 1 0\n"
      "      vertex -0 1 0\n    endloop\n  endfacet\nendsolid a b c\n",
      MeshFormat::stl);
  EXPECT_TRUE(file.welded);
  EXPECT_EQ(file.mesh.vertex_count(), 4u);
  EXPECT_THAT(file.mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}));
}

TEST(StlFile, AsciiInCapitals) {
  const MeshFile file = decode_mesh(
      "SOLID A\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1.0E+00 0 0\nVERTEX 0 1 0\n"
      "ENDLOOP\nENDFACET\nENDSOLID A\n",
      MeshFormat::stl);
  EXPECT_EQ(file.mesh.vertex_count(), 3u);
  EXPECT_THAT(file.mesh.triangles, ElementsAre(Triangle{0, 1, 2}));
}

TEST(StlFile, BinaryThatBeginsWithSolid) {
  std::string bytes = encode_mesh(to_surface_mesh(testing::cube()), MeshFormat::stl).bytes;
  bytes.replace(0, 6, "solid ");
  const MeshFile file = decode_mesh(bytes, MeshFormat::stl);
  EXPECT_EQ(file.mesh.vertex_count(), 8u);
  EXPECT_EQ(file.mesh.triangle_count(), 12u);
  EXPECT_EQ(decode_mesh("xx" + bytes.substr(2) + "tail", MeshFormat::stl).notes.size(), 2u);
}

TEST(StlFile, WeldsManyVertices) {
  const IndexedMesh sphere = testing::icosphere(6);  // past several growths of the table
  const MeshFile file =
      decode_mesh(encode_mesh(to_surface_mesh(sphere), MeshFormat::stl).bytes, MeshFormat::stl);
  EXPECT_EQ(file.mesh.vertex_count(), sphere.vertex_count());
}

struct BadFile {
  const char* name;
  MeshFormat format;
  std::string bytes;
  const char* complaint;
};

std::string ply(const std::string& elements, const std::string& body,
                const char* format = "ascii") {
  return std::string("ply\nformat ") + format + " 1.0\n" + elements + "end_header\n" + body;
}
const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";
const std::string kFace = "element face 1\nproperty list uchar int vertex_indices\n";
const std::string kThree = "element vertex 3\n" + kXyz;

std::string lying_stl() {
  std::string bytes(80, 'x');
  append(bytes, std::uint32_t{0xffffffff});
  return bytes + std::string(1000, '\0');
}

// One vertex, with a list, whose y is not a number.
std::string nan_beside_a_list() {
  std::string body;
  for (const float coordinate : {0.f, std::numeric_limits<float>::quiet_NaN(), 0.f})
    append(body, coordinate);
  body += '\0';  // an empty list
  return ply("element vertex 1\n" + kXyz + "property list uchar int neighbours\n", body,
             "binary_little_endian");
}

std::vector<BadFile> bad_files() {
  const std::string filler(1000, '0');
  return {
      {"ply_empty", MeshFormat::ply, "", "line 1"},
      {"ply_other", MeshFormat::ply, "solid x\n", "line 1"},
      {"ply_no_end", MeshFormat::ply, "ply\nformat ascii 1.0\n", "end_header"},
      {"ply_format", MeshFormat::ply, "ply\nformat morse 1.0\nend_header\n", "line 2: 'morse'"},
      {"ply_no_format", MeshFormat::ply, "ply\nend_header\n", "no format"},
      {"ply_type", MeshFormat::ply, ply("element vertex 1\nproperty quad x\n", ""), "line 4"},
      {"ply_float_count", MeshFormat::ply,
       ply("element face 1\nproperty list float int vertex_indices\n", ""), "whole number"},
      {"ply_negative_count", MeshFormat::ply, ply("element vertex -1\n", ""), "line 3"},
      {"ply_no_vertices", MeshFormat::ply, ply("", ""), "'vertex'"},
      {"ply_two_vertices", MeshFormat::ply,
       ply(kThree + kThree, "0 0 0 1 1 1 2 2 2 3 3 3 4 4 4 5 5 5\n"), "second"},
      {"ply_no_z", MeshFormat::ply,
       ply("element vertex 1\nproperty float x\nproperty float y\n", "0 0\n"), "x, y, z"},
      {"ply_lying", MeshFormat::ply, ply("element vertex 4000000000\n" + kXyz, filler), "promised"},
      {"ply_lying_binary", MeshFormat::ply,
       ply("element vertex 4000000000\n" + kXyz, filler, "binary_little_endian"), "promised"},
      {"ply_lying_faces", MeshFormat::ply,
       ply("element vertex 0\n" + kXyz +
               "element face 18446744073709551615\nproperty list uchar int vertex_indices\n",
           filler, "binary_little_endian"),
       "promised"},
      {"ply_lying_list", MeshFormat::ply,
       ply(kThree + "element face 1\nproperty list uint int vertex_indices\n",
           std::string(36, '\0') + "\xff\xff\xff\xff", "binary_little_endian"),
       "list of 4294967295"},
      {"ply_index", MeshFormat::ply, ply(kThree + kFace, "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
       "vertex 3"},
      {"ply_negative_index", MeshFormat::ply,
       ply(kThree + kFace, "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), "-1 is no vertex"},
      {"ply_nan", MeshFormat::ply, ply(kThree, "0 0 0\n1 nan 0\n0 1 0\n"), "line 9"},
      {"ply_nan_beside_a_list", MeshFormat::ply, nan_beside_a_list(), "vertex 0"},
      {"ply_truncated", MeshFormat::ply, ply(kThree, "0 0 0\n1 0 0\n0 1\n"), "ends"},
      {"ply_strips", MeshFormat::ply,
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
       "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
       "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
       "triangle strips are not read"},
      {"obj_number", MeshFormat::obj, "v 0 0 0\nv 0 zero 0\n", "line 2: 'zero'"},
      {"obj_short", MeshFormat::obj, "v 0 0\n", "line 1"},
      {"obj_zero_index", MeshFormat::obj, "v 0 0 0\nf 0 1 1\n", "line 2: 0 is no index"},
      {"obj_far_index", MeshFormat::obj, "v 0 0 0\nv 0 0 1\nf 1 2 3\n", "line 3"},
      {"obj_back_index", MeshFormat::obj, "v 0 0 0\nf 1 1 -2\n", "line 2: -2"},
      {"obj_infinite", MeshFormat::obj, "v 1e999 0 0\n", "line 1"},
      {"obj_huge_index", MeshFormat::obj, "v 0 0 0\nf 1 1 99999999999\n", "line 2"},
      {"off_other", MeshFormat::off, "COLLADA\n", "line 1"},
      {"off_4d", MeshFormat::off, "4OFF\n1 0 0\n0 0 0 0\n", "'4OFF'"},
      {"off_letters", MeshFormat::off, "OFF+X\n1 0 0\n0 0 0 0\n", "'OFF+X' is a kind"},
      {"off_control", MeshFormat::off, "\x1b[2JOFF\n1 0 0\n0 0 0 0\n", "'?[2JOFF' is a kind"},
      {"off_bytes", MeshFormat::off, "\xe4OFF\n1 0 0\n0 0 0 0\n", "'?OFF' is a kind"},
      {"obj_bytes", MeshFormat::obj, "v 0 \xff\xfe 0\n",
       "'?"
       "?' is no number"},
      {"ply_bytes", MeshFormat::ply,
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty flo\xe4t x\n", "'flo?t' is no PLY type"},
      {"ply_bytes_of_names", MeshFormat::ply,
       ply("element vert\xe4x 4000000000\n" + kXyz, filler, "binary_little_endian"),
       "'vert?x' elements are promised"},
      {"ply_control", MeshFormat::ply, "ply\n\x1b[2J\n", "'?[2J' has no place"},
      {"off_binary", MeshFormat::off, "OFF BINARY\n", "binary"},
      {"off_lying", MeshFormat::off, "OFF\n4000000000 1 0\n" + filler, "promised"},
      {"off_index", MeshFormat::off, "OFF\n1 1 0\n0 0 0\n3 0 0 1\n", "line 4"},
      {"off_truncated", MeshFormat::off, "OFF\n2 0 0\n0 0 0\n", "ends"},
      {"stl_empty", MeshFormat::stl, "", "too short"},
      {"stl_lying", MeshFormat::stl, lying_stl(), "promised"},
      {"stl_outside", MeshFormat::stl, "solid\nvertex 0 0 0\n", "line 2"},
      {"stl_word", MeshFormat::stl, "solid\nfoo\n", "line 2: 'foo'"},
      {"stl_open", MeshFormat::stl, "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n",
       "inside a facet"},
      {"glb_empty", MeshFormat::glb, "", "GLB"},
      {"glb_other", MeshFormat::glb, std::string(100, 'x'), "GLB"},
  };
}

class BadFiles : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadFiles, AreRefusedWithThePlace) {
  const BadFile& bad = GetParam();
  try {
    decode_mesh(bad.bytes, bad.format);
    FAIL() << "accepted";
  } catch (const FileFormatError& error) {
    EXPECT_THAT(error.what(), HasSubstr(bad.complaint));
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "one line";
  }
}

INSTANTIATE_TEST_SUITE_P(All, BadFiles, ::testing::ValuesIn(bad_files()),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace vdwmesh

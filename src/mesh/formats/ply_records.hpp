// The PLY files that this library writes: the text of the header, and the bytes of one vertex and
// one face. All vertices take the same number of bytes and so do all faces, so the place of each
// record in the file follows from its number. Several processes can therefore write one file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "mesh/formats/record_writer.hpp"
#include "mesh/mesh_io.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::formats {

// The largest number of vertices of a file, whose faces name them by numbers of 32 bits. Up to
// kMostIntPlyVertices the header declares these numbers as int, which every reader knows. Beyond,
// it declares them as uint.
inline constexpr std::uint64_t kMostPlyVertices = std::uint64_t{1} << 32;
inline constexpr std::uint64_t kMostIntPlyVertices = std::uint64_t{1} << 31;

// Bytes of a vertex: 3 doubles, 3 floats, 3 bytes and 3 ints.
inline constexpr std::uint64_t kPlyVertexBytes = 24 + 12 + 3 + 12;

// Bytes of a face: a count of one byte, 3 ints or uints, and one int more for its sphere if faces
// have labels.
constexpr std::uint64_t ply_face_bytes(TriangleLabels labels) {
  return 13 + (labels == TriangleLabels::spheres ? 4 : 0);
}

// Whether a file says of which patches the surface is made: two floats more for a vertex, its
// curvatures; and one byte and three ints more for a face, the kind and the atoms of its patch.
enum class PatchLabels : std::uint8_t { none, patches };
inline constexpr std::uint64_t kPlyCurvatureBytes = 8, kPlyPatchBytes = 13;

// The header of a mesh of this size, up to the byte before the first vertex. `scale` is the length
// in the file for 1 Å.
std::string ply_header(const MeshSize& size, TriangleLabels labels,
                       PatchLabels patches = PatchLabels::none,
                       MeshEncoding encoding = MeshEncoding::binary, double scale = 1);

// The number of a sphere in the file. It is an int, so that -1 can stand for kNoSphere. Throws
// LimitExceeded for a number beyond PLY's int.
std::int32_t ply_sphere(SphereId id);

// Writes a vertex. The arguments are arrays or vectors of three elements each: the position,
// the normal, the colour as bytes, and the spheres that the vertex lies on.
template <class Out, class Position, class Normal, class Color>
void write_ply_vertex(Out& out, const Position& position, const Normal& normal, const Color& color,
                      const VertexSpheres& spheres) {
  for (int k = 0; k < 3; ++k) out.raw(static_cast<double>(position[k]));
  for (int k = 0; k < 3; ++k) out.raw(static_cast<float>(normal[k]));
  for (std::size_t k = 0; k < 3; ++k) out.raw(static_cast<std::uint8_t>(color[k]));
  for (const SphereId id : spheres) out.raw(ply_sphere(id));
}

// Writes a face without its sphere.
template <class Out>
void write_ply_face(Out& out, const Triangle& corners) {
  out.raw(std::uint8_t{3});
  for (const std::uint32_t corner : corners) out.raw(corner);
}

}  // namespace vdwmesh::formats

// Reading and writing of mesh files. The extension of the name decides on the format: .ply .obj
// .off .stl or .glb; .msh, .msh2, .msh4, .vtp, .vtu and .3mf are written alone. A file that is
// written appears whole or not at all: it is renamed to its name when it is complete.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/errors.hpp"
#include "mesh/element_color.hpp"
#include "mesh/surface_mesh.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh {

class Monitor;

enum class MeshFormat { ply, obj, off, stl, glb, msh, msh4, vtp, vtu, three_mf };

// How PLY and STL are written; the other formats have one form.
enum class MeshEncoding : std::uint8_t { binary, text };

// The format by the extension of `path`, whose case does not matter. Empty for other extensions.
std::optional<MeshFormat> find_mesh_format(const std::filesystem::path& path);
// The same, but throws InvalidInput that lists the known extensions.
MeshFormat mesh_format(const std::filesystem::path& path);

// Writes a mesh file.
//   PLY: double positions, float normals, uchar colours, int sphere ids; little-endian.
//   OBJ, OFF: text.
//   STL: float32; as text doubles.
//   Numbers in text have the fewest digits from which the same number is read back.
//   GLB: float32 relative to the middle of the mesh, which the translation of the node restores;
//        colours in linear light, which glTF wants, on a material that is no metal.
//   MSH (.msh, .msh2: version 2.2; .msh4: 4.1), VTP, VTU: text, with the atom of each triangle.
//   3MF: text in an archive, in millimetres: 1 Å is `scale` mm.
// Coordinates are multiplied by `scale`, so 0.1 writes nm and 1 Å; all formats but OFF say so where
// it is not 1. It must be finite and above 0.
// Returns warnings for people: coordinates that move by more than 1e-4 Å when they become float32
// (binary STL, GLB), and triangles of which two corners become equal (binary STL).
// A vertex has the colour of its atom, sphere_colors[i] for sphere i, and kPlainColor without an
// atom or if there are no colours. A mesh without normals gets those of its triangles.
// Throws FileFormatError if the file cannot be written (no part of it is left), InvalidInput if the
// arrays do not fit together, a coordinate is not finite or a sphere has no colour, LimitExceeded
// if the format cannot count or number the elements, and Cancelled if `monitor` asks to stop.
std::vector<std::string> write_mesh(const IndexedMesh& mesh, const std::filesystem::path& path,
                                    std::span<const RgbColor> sphere_colors = {},
                                    const Monitor* monitor = nullptr,
                                    MeshEncoding encoding = MeshEncoding::binary, double scale = 1);
// PLY and MSH say which patch each triangle is part of, PLY alone the curvatures of the vertices.
std::vector<std::string> write_mesh(const PatchedMesh& mesh, const std::filesystem::path& path,
                                    std::span<const RgbColor> sphere_colors = {},
                                    const Monitor* monitor = nullptr,
                                    MeshEncoding encoding = MeshEncoding::binary, double scale = 1);

// One of several meshes of a file, such as a pocket, whose triangles belong to parts with names.
struct NamedMesh {
  std::string name;
  IndexedMesh mesh;
  std::vector<std::uint32_t> parts;  // by triangle: an index into the following
  // Part 0 is called as the mesh in GLB, where the others hang on it.
  std::vector<std::string> part_names;
  std::vector<std::array<std::uint8_t, 4>> part_colors;  // sRGB, and how opaque
};

// The kinds of files that can hold several meshes: GLB, OBJ, 3MF.
bool holds_several_meshes(MeshFormat format);

// Writes the meshes as one file, with their names.
//   GLB: a node for each part of each mesh, with a material; flat shades where parts meet, so each
//        part has its own vertices, which are at the same places on both sides.
//   OBJ: an object for each mesh and a group for each part, with underscores for blanks; vertices
//        are shared.
//   3MF: an object for each mesh.
// Returns warnings and throws as write_mesh() does, and InvalidInput for other formats.
std::vector<std::string> write_meshes(std::span<const NamedMesh> meshes,
                                      const std::filesystem::path& path,
                                      const Monitor* monitor = nullptr);

// With the normals and colours that the vertices have. Throws InvalidInput if an element is
// deleted.
std::vector<std::string> write_mesh(const SurfaceMesh& mesh, const std::filesystem::path& path,
                                    const Monitor* monitor = nullptr);

// The content of a mesh file, which any program may have written. The triangles may have a
// boundary, be no manifold or face inwards.
struct MeshFile {
  IndexedMesh mesh;                // normals and spheres are empty unless the file has them
  bool welded = false;             // STL: vertices with three equal coordinates were merged
  std::vector<std::string> notes;  // for people: what was changed or left out
};

// Reads a mesh file: PLY and STL in text or binary form, OBJ, OFF, GLB. Convex and concave polygons
// become triangles. Doubles keep their precision. Throws FileFormatError with the line or byte of
// the error, InvalidInput if the extension is that of no format that is read, and LimitExceeded if
// a GLB file, which may name an array many times, makes a mesh of more than `memory_limit` bytes.
MeshFile read_mesh(const std::filesystem::path& path, std::uint64_t memory_limit = kNoMemoryLimit);

// write_mesh() and read_mesh() with a string instead of a file.
struct EncodedMesh {
  std::string bytes;
  std::vector<std::string> warnings;
};
EncodedMesh encode_mesh(const IndexedMesh& mesh, MeshFormat format,
                        MeshEncoding encoding = MeshEncoding::binary);
EncodedMesh encode_mesh(const SurfaceMesh& mesh, MeshFormat format);
EncodedMesh encode_meshes(std::span<const NamedMesh> meshes, MeshFormat format);
MeshFile decode_mesh(std::string_view bytes, MeshFormat format,
                     std::uint64_t memory_limit = kNoMemoryLimit);

}  // namespace vdwmesh

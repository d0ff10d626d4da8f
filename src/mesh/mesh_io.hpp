// Mesh files, by extension: .ply .obj .off .stl .glb. Files appear whole or not at all (written
// beside their name, then renamed).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/monitor.hpp"
#include "mesh/surface_mesh.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

enum class MeshFormat { ply, obj, off, stl, glb };

// By the extension, in capitals or not; empty where it is none of a mesh file.
std::optional<MeshFormat> find_mesh_format(const std::filesystem::path& path);
// The same. Throws InvalidInput that lists the known extensions.
MeshFormat mesh_format(const std::filesystem::path& path);

// PLY: binary little-endian, double positions, float normals, uchar colours, int atom (and further
// sphere ids). OBJ, OFF: shortest digits that read back the same double. STL: binary, float32.
// GLB: float32 about an offset that the node transform carries. Returns warnings for people (STL,
// GLB: coordinates that lose more than 1e-4 Å; STL: triangles whose corners fall together). Throws
// FileFormatError (the file cannot be written; nothing is left of it), InvalidInput (deleted
// elements not yet collected, coordinates that are not finite), LimitExceeded (more than the format
// can count), Cancelled.
std::vector<std::string> write_mesh(const SurfaceMesh& mesh, const std::filesystem::path& path,
                                    const Monitor* monitor = nullptr);

// What a mesh file of any program holds. Triangles may be open, non-manifold or inside out.
struct MeshFile {
  IndexedMesh mesh;     // normals and spheres empty unless the file has them
  bool welded = false;  // STL soup: vertices merged where all three coordinates are equal
  std::vector<std::string> notes;
};

// PLY (ascii, binary), OBJ, OFF, STL (ascii, binary), GLB; polygons become triangles, also
// concave ones. Doubles are read as doubles. Throws FileFormatError with the line or byte.
MeshFile read_mesh(const std::filesystem::path& path);

// The same, to and from memory.
struct EncodedMesh {
  std::string bytes;
  std::vector<std::string> warnings;
};
EncodedMesh encode_mesh(const SurfaceMesh& mesh, MeshFormat format);
MeshFile decode_mesh(std::string_view bytes, MeshFormat format);

}  // namespace vdwmesh

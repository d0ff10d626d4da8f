// One writer and one reader per mesh format; mesh_io.cpp calls them. Writers may assume that
// coordinates are finite and no element is deleted. Readers throw FileFormatError with the line or
// byte of the error, and mesh_io.cpp adds the name of the file. Readers do not trust the counts in
// a header: before they allocate memory for a count, they check that the bytes that follow could
// hold so many elements.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/element_color.hpp"
#include "mesh/mesh_io.hpp"
#include "mesh/output_file.hpp"

namespace vdwmesh::formats {

// One line each, for people.
using Warnings = std::vector<std::string>;

void write_ply(const SurfaceMesh& mesh, ByteSink& sink);
// The file of the SurfaceMesh of the same mesh, byte for byte. `colors` has one for each sphere
// that the mesh names. Precondition: vertices have normals.
void write_ply(const IndexedMesh& mesh, std::span<const RgbColor> colors, ByteSink& sink);
void write_obj(const SurfaceMesh& mesh, ByteSink& sink);
void write_off(const SurfaceMesh& mesh, ByteSink& sink);
void write_stl(const SurfaceMesh& mesh, ByteSink& sink, Warnings& warnings);
void write_glb(const SurfaceMesh& mesh, ByteSink& sink, Warnings& warnings);

MeshFile read_ply(std::string_view bytes);
MeshFile read_obj(std::string_view bytes);
MeshFile read_off(std::string_view bytes);
MeshFile read_stl(std::string_view bytes);
// The format alone may place its arrays many times: throws LimitExceeded if the mesh would take
// more than `memory_limit` bytes.
MeshFile read_glb(std::string_view bytes, std::uint64_t memory_limit);

}  // namespace vdwmesh::formats

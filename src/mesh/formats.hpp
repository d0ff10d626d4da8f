// One writer and one reader per mesh format, as mesh_io.cpp calls them. Writers may assume finite
// coordinates and no deleted elements. Readers throw FileFormatError with the line or byte, which
// mesh_io.cpp completes with the file's name; what a header promises is believed only as far as
// the bytes that are there can hold it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mesh/mesh_io.hpp"
#include "mesh/output_file.hpp"

namespace vdwmesh::formats {

using Warnings = std::vector<std::string>;

void write_ply(const SurfaceMesh& mesh, ByteSink& sink);
void write_obj(const SurfaceMesh& mesh, ByteSink& sink);
void write_off(const SurfaceMesh& mesh, ByteSink& sink);
void write_stl(const SurfaceMesh& mesh, ByteSink& sink, Warnings& warnings);
void write_glb(const SurfaceMesh& mesh, ByteSink& sink, Warnings& warnings);

MeshFile read_ply(std::string_view bytes);
MeshFile read_obj(std::string_view bytes);
MeshFile read_off(std::string_view bytes);
MeshFile read_stl(std::string_view bytes);
MeshFile read_glb(std::string_view bytes);

}  // namespace vdwmesh::formats

// One writer and one reader per mesh format; mesh_io.cpp calls them. Writers get a MeshView, whose
// arrays fit together and whose coordinates are finite. Readers throw FileFormatError with the line
// or byte of the error, and mesh_io.cpp adds the name of the file. Readers do not trust the counts
// in a header: before they allocate memory for a count, they check that the bytes that follow could
// hold so many elements.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/errors.hpp"
#include "mesh/element_color.hpp"
#include "mesh/formats/output_file.hpp"
#include "mesh/mesh_io.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh::formats {

// One line each, for people.
using Warnings = std::vector<std::string>;

// What the writers of all formats read.
struct MeshView {
  const IndexedMesh& mesh;
  std::span<const Vec3f> normals = {};           // by vertex; empty for formats without normals
  std::span<const RgbColor> vertex_colors = {};  // by vertex; empty: the vertices have their atoms'
  std::span<const RgbColor> sphere_colors = {};  // by sphere; empty: all are kPlainColor
  const PatchedMesh* patches = nullptr;          // null: the mesh knows no patches
  MeshEncoding encoding = MeshEncoding::binary;
  double scale = 1;  // lengths in the file for 1 Å

  // Where the file has vertex v, in its own unit of length.
  Vec3d position(std::size_t v) const { return scale * mesh.positions[v]; }
  RgbColor color(std::size_t v) const {
    if (!vertex_colors.empty()) return vertex_colors[v];
    if (sphere_colors.empty() || mesh.vertex_spheres.empty()) return kPlainColor;
    const SphereId atom = mesh.vertex_spheres.atoms[v];
    return atom == kNoSphere ? kPlainColor : sphere_colors[atom];
  }
};

// What a file says about its lengths.
inline std::string unit_text(double scale) {
  return scale == 1 ? "lengths in angstrom" : fmt::format("lengths: 1 angstrom is {}", scale);
}

void write_ply(const MeshView& view, ByteSink& sink);
void write_obj(const MeshView& view, ByteSink& sink);
void write_off(const MeshView& view, ByteSink& sink);
void write_stl(const MeshView& view, ByteSink& sink, Warnings& warnings);
void write_glb(const MeshView& view, ByteSink& sink, Warnings& warnings);
void write_msh(const MeshView& view, ByteSink& sink);   // version 2.2
void write_msh4(const MeshView& view, ByteSink& sink);  // version 4.1
void write_vtp(const MeshView& view, ByteSink& sink);
void write_vtu(const MeshView& view, ByteSink& sink);
void write_3mf(const MeshView& view, ByteSink& sink);

void write_glb(std::span<const NamedMesh> meshes, ByteSink& sink, Warnings& warnings);
void write_obj(std::span<const NamedMesh> meshes, ByteSink& sink);
void write_3mf(std::span<const NamedMesh> meshes, ByteSink& sink);

MeshFile read_ply(std::string_view bytes);
MeshFile read_obj(std::string_view bytes);
MeshFile read_off(std::string_view bytes);
MeshFile read_stl(std::string_view bytes);
// The format alone may place its arrays many times: throws LimitExceeded if the mesh would take
// more than `memory_limit` bytes.
MeshFile read_glb(std::string_view bytes, std::uint64_t memory_limit);

// Throws LimitExceeded if an IndexedMesh cannot have this many vertices. One index is kept free:
// 2^32 - 1 means "none" in several tables.
inline void check_vertex_limit(std::uint64_t vertices) {
  if (vertices >= kMaxVertices)
    throw LimitExceeded(fmt::format("{} vertices are more than a mesh can hold", vertices));
}

}  // namespace vdwmesh::formats

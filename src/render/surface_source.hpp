// What the renderer draws: a mesh with its paint, which can be framed and written into the
// renderer's buffers.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "render/camera.hpp"
#include "render/color_scale.hpp"
#include "render/surface_vertex.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// What the surface's colour comes from: a colour or a value per vertex, or a value per triangle.
enum class PaintKind : std::uint8_t { vertex_color, vertex_value, triangle_value };

// What a mesh is painted with: one colour; a colour per vertex; a value per vertex, interpolated
// before it becomes a colour; or a value per triangle. NaN is shown grey.
struct VertexColors {
  std::vector<Rgb> colors;
};
struct VertexValues {
  std::vector<float> values;
  ColorScale scale;
};
struct TriangleValues {
  std::vector<float> values;
  ColorScale scale;
};
using Paint = std::variant<Rgb, VertexColors, VertexValues, TriangleValues>;

// A mesh with its paint. The mesh must outlive it. If the mesh has one normal per vertex, these are
// shown; normals that are missing, zero or not finite are taken from vertex_normals().
//
// Throws InvalidInput for a mesh without triangles or without area, for an index out of range, for
// a vertex of a triangle that is not finite, and for a number of colours or values that differs
// from the number of vertices or triangles. The message names the first faulty triangle.
class MeshSource final : public SurfaceExtent {
 public:
  MeshSource(const IndexedMesh& mesh, Paint paint);

  std::vector<double> support(std::span<const Vec3d> directions) const override;
  Moments moments() const override { return moments_; }
  std::uint64_t vertex_count() const { return mesh_.vertex_count(); }
  std::uint64_t triangle_count() const { return mesh_.triangle_count(); }
  PaintKind paint() const;
  // The scale of the values; null if colours are painted.
  const ColorScale* scale() const;
  // Finds out how much of the sky each vertex sees; without it, all see it whole.
  void shade();
  // Write all elements of a buffer. Positions are stored relative to `origin` (Å). Values of
  // triangles are written only if these are painted.
  void write_vertices(std::span<SurfaceVertex> vertices, const Vec3d& origin) const;
  void write_triangles(std::span<Triangle> triangles) const;
  void write_triangle_values(std::span<float> values) const;

 private:
  const IndexedMesh& mesh_;
  Paint paint_;
  Moments moments_;
  const Vec3f* normals() const;

  Buffer<Vec3f> normals_;   // empty: the mesh's own normals serve
  std::vector<float> sky_;  // empty: 1 everywhere
};

// Unit normals at the vertices: the mean of the normals of the triangles around a vertex, weighted
// by their angles there (G. Thürmer and C. A. Wüthrich, "Computing Vertex Normals from Polygonal
// Facets", JGT 3, 1998). The normal is (0, 0, 1) if they cancel or there are none.
Buffer<Vec3f> vertex_normals(const IndexedMesh& mesh);

// The share of the light of an even sky that reaches each vertex past the rest of the mesh: the
// mean over all directions of the half-space outside, weighted by their cosines with the normal
// (ambient occlusion; S. Zhukov, A. Iones and G. Kronin, 1998). What is nearer than about 1/170 of
// the mesh's width throws no shadow. `normals` has one of non-zero length for each vertex; `extent`
// is that of the mesh. Vertices without triangles have 1.
std::vector<float> visible_sky(const IndexedMesh& mesh, std::span<const Vec3f> normals,
                               const SurfaceExtent& extent);

}  // namespace vdwmesh

// What the renderer draws: a surface that can be framed and can fill the renderer's buffers. A
// source writes the buffers in host memory, or fills the OpenGL buffers itself on the device that
// draws (CUDA-OpenGL interoperation).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
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

// The renderer's buffers while a source fills them. The renderer's OpenGL context is then current
// on this thread.
class SurfaceTarget {
 public:
  virtual ~SurfaceTarget() = default;
  // Host memory that becomes the content of the buffers. It may be written only, never read. The
  // first call for a buffer maps it.
  virtual std::span<SurfaceVertex> vertices() = 0;
  virtual std::span<Triangle> triangles() = 0;
  virtual std::span<float> triangle_values() = 0;  // empty unless values of triangles are painted
  // OpenGL names of the same buffers. The buffers are allocated. A buffer is mapped only after the
  // function above that returns its host memory was called.
  virtual unsigned vertex_buffer() const = 0;
  virtual unsigned index_buffer() const = 0;
  virtual unsigned triangle_value_buffer() const = 0;  // 0 unless values of triangles are painted
};

// A surface with its paint.
class SurfaceSource : public SurfaceExtent {
 public:
  virtual std::uint64_t vertex_count() const = 0;
  virtual std::uint64_t triangle_count() const = 0;
  virtual PaintKind paint() const = 0;
  // The scale of the values; null if colours are painted.
  virtual const ColorScale* scale() const = 0;
  // Writes all buffers in full. Positions are stored relative to `origin` (Å).
  virtual void fill(SurfaceTarget& target, const Vec3d& origin) const = 0;
};

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

// A view of a surface and its paint in host memory, for code that copies them to a device.
struct SurfaceArrays {
  VertexArrays vertices;
  std::uint64_t vertex_count = 0;
  std::span<const Triangle> triangles;
  std::span<const float> triangle_values;  // empty unless values of triangles are painted
};

// A mesh in host memory as a source. The mesh must outlive it. If the mesh has one normal per
// vertex, these are shown; normals that are missing, zero or not finite are taken from
// vertex_normals().
//
// Throws InvalidInput for a mesh without triangles or without area, for an index out of range, for
// a vertex of a triangle that is not finite, and for a number of colours or values that differs
// from the number of vertices or triangles. The message names the first faulty triangle.
class MeshSource : public SurfaceSource {
 public:
  MeshSource(const IndexedMesh& mesh, Paint paint);

  std::vector<double> support(std::span<const Vec3d> directions) const override;
  Moments moments() const override { return moments_; }
  std::uint64_t vertex_count() const override { return mesh_.vertex_count(); }
  std::uint64_t triangle_count() const override { return mesh_.triangle_count(); }
  PaintKind paint() const override;
  const ColorScale* scale() const override;
  void fill(SurfaceTarget& target, const Vec3d& origin) const override;
  // The arrays from which fill() copies. Valid as long as the source.
  SurfaceArrays arrays() const;

 private:
  const IndexedMesh& mesh_;
  Paint paint_;
  Moments moments_;
  Buffer<Vec3f> normals_;  // empty: the mesh's own normals serve
};

// Unit normals at the vertices: the mean of the normals of the triangles around a vertex, weighted
// by their angles there (G. Thürmer and C. A. Wüthrich, "Computing Vertex Normals from Polygonal
// Facets", JGT 3, 1998). The normal is (0, 0, 1) if they cancel or there are none.
Buffer<Vec3f> vertex_normals(const IndexedMesh& mesh);

}  // namespace vdwmesh

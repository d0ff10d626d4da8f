// What the renderer draws, and how it gets into its buffers. A source may write from the host, or
// fill the OpenGL buffers itself on the device that draws (CUDA-OpenGL interoperation).
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

// Which of its colours a surface shows.
enum class PaintKind : std::uint8_t { vertex_color, vertex_value, triangle_value };

// The renderer's buffers while they are filled, with its OpenGL context current on this thread.
class SurfaceTarget {
 public:
  virtual ~SurfaceTarget() = default;
  // Host memory that becomes the buffer's content. Write only.
  virtual std::span<SurfaceVertex> vertices() = 0;
  virtual std::span<Triangle> triangles() = 0;
  virtual std::span<float> triangle_values() = 0;  // empty unless they are painted
  // OpenGL names of the same buffers, allocated, and not mapped until the host memory is asked for.
  virtual unsigned vertex_buffer() const = 0;
  virtual unsigned index_buffer() const = 0;
  virtual unsigned triangle_value_buffer() const = 0;  // 0 unless they are painted
};

class SurfaceSource : public SurfaceExtent {
 public:
  virtual std::uint64_t vertex_count() const = 0;
  virtual std::uint64_t triangle_count() const = 0;
  virtual PaintKind paint() const = 0;
  // Of the values; none for colours.
  virtual const ColorScale* scale() const = 0;
  virtual void fill(SurfaceTarget& target, const Vec3d& origin) const = 0;
};

// One colour; a colour per vertex; a value per vertex, interpolated before it becomes a colour; a
// value per triangle. Values that are NaN are shown grey.
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

// A surface and its paint in host memory, for who fills the buffers on a device.
struct SurfaceArrays {
  VertexArrays vertices;
  std::uint64_t vertex_count = 0;
  std::span<const Triangle> triangles;
  std::span<const float> triangle_values;  // empty unless they are painted
};

// A mesh in host memory, which must outlive it. Normals of the mesh where it has one per vertex,
// and for vertices whose normal is missing, zero or not finite those of vertex_normals(). Throws
// InvalidInput, naming the first offender, for a mesh without triangles or without area, an index
// of no vertex, a vertex that is not finite, paint of another size.
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
  // What fill() fills from. Valid as long as the source.
  SurfaceArrays arrays() const;

 private:
  const IndexedMesh& mesh_;
  Paint paint_;
  Moments moments_;
  Buffer<Vec3f> normals_;  // empty: the mesh's own
};

// Unit normals from the triangles around each vertex, weighted by their angle there (G. Thürmer and
// C. A. Wüthrich, "Computing Vertex Normals from Polygonal Facets", JGT 3, 1998); (0, 0, 1) where
// they cancel or there are none.
Buffer<Vec3f> vertex_normals(const IndexedMesh& mesh);

}  // namespace vdwmesh

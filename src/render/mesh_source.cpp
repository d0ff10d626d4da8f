// The surface source of a mesh in host memory.
//
// The constructor checks the mesh, integrates its moments and completes its normals. The moments,
// support() and write_vertices() take all cores, in blocks of fixed size. Partial sums are added in
// the order of the blocks, so results do not depend on the number of threads.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/sum.hpp"
#include "render/surface_source.hpp"
#include "surface/triangle_check.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kPerBlock = std::size_t{1} << 15;  // triangles or vertices per block
constexpr std::uint8_t kWholeSky = 255;                  // as a vertex of the buffer has it

bool is_finite(const Vec3d& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// Throws InvalidInput for the first triangle that names a vertex that does not exist, or for the
// first that has a vertex which is not finite.
void check_drawable(const IndexedMesh& mesh) {
  if (mesh.triangles.empty()) throw InvalidInput("the mesh has no triangles; nothing to draw");
  check_triangles(mesh.triangles, mesh.vertex_count());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (!is_finite(mesh.positions[v])) {
        throw InvalidInput(fmt::format("vertex {} of triangle {} is not finite", v, t));
      }
    }
  }
}

// Throws InvalidInput unless there are as many colours or values as needed.
void check_count(std::string_view what, std::size_t count, std::size_t needed) {
  if (count == needed) return;
  throw InvalidInput(fmt::format("{} {}, but {} are needed", count, what, needed));
}

void check_paint(const IndexedMesh& mesh, const Paint& paint) {
  if (const auto* colors = std::get_if<VertexColors>(&paint)) {
    check_count("colours of vertices", colors->colors.size(), mesh.vertex_count());
  } else if (const auto* values = std::get_if<VertexValues>(&paint)) {
    check_count("values of vertices", values->values.size(), mesh.vertex_count());
    check(values->scale);
  } else if (const auto* flat = std::get_if<TriangleValues>(&paint)) {
    check_count("values of triangles", flat->values.size(), mesh.triangle_count());
    check(flat->scale);
  }
}

// The corners of triangle t, relative to `origin`.
std::array<Vec3d, 3> corners(const IndexedMesh& mesh, std::size_t t, const Vec3d& origin) {
  const auto corner = [&](std::size_t k) { return mesh.positions[mesh.triangles[t][k]] - origin; };
  return {corner(0), corner(1), corner(2)};
}

// Ten integrals over the area of a set of triangles, in this order: the area itself, the first
// moments x y z and the second moments xx xy xz yy yz zz, of positions relative to an origin.
struct AreaMoments {
  std::array<WideSum, 10> sums;

  // Adds a triangle with the corners vᵢ. With its area A and s = Σ vᵢ, the integral of p over it is
  // A/3 s, and the integral of p pᵀ is A/12 (Σ vᵢ vᵢᵀ + s sᵀ).
  void add(const std::array<Vec3d, 3>& v) {
    const double area = norm(cross(v[1] - v[0], v[2] - v[0])) / 2;
    const Vec3d s = v[0] + v[1] + v[2];
    const auto second = [&](int i, int j) {
      const double own = v[0][i] * v[0][j] + v[1][i] * v[1][j] + v[2][i] * v[2][j];
      return area / 12 * (own + s[i] * s[j]);
    };
    const double terms[] = {area,         area / 3 * s.x, area / 3 * s.y, area / 3 * s.z,
                            second(0, 0), second(0, 1),   second(0, 2),   second(1, 1),
                            second(1, 2), second(2, 2)};
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i].add(terms[i]);
  }
  void add(const AreaMoments& other) {
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i].add(other.sums[i]);
  }
};

// The moments of the whole mesh about an origin. Each block has a sum of its own; the sums are
// added in order, so that any number of threads gives the same bits.
AreaMoments integrate(const IndexedMesh& mesh, const Vec3d& origin) {
  std::vector<AreaMoments> parts(block_count(mesh.triangle_count(), kPerBlock));
  for_each_block(mesh.triangle_count(), kPerBlock,
                 [&](std::size_t block, std::size_t first, std::size_t last) {
                   for (std::size_t t = first; t < last; ++t)
                     parts[block].add(corners(mesh, t, origin));
                 });
  AreaMoments total;
  for (const AreaMoments& part : parts) total.add(part);
  return total;
}

// Centroid and covariance of the area. The moments are integrated about a vertex of the mesh,
// because the subtraction of mean · meanᵀ would cancel digits far from the origin.
SurfaceExtent::Moments area_moments(const IndexedMesh& mesh) {
  const Vec3d origin = mesh.positions[mesh.triangles[0][0]];
  const AreaMoments total = integrate(mesh, origin);
  const double area = total.sums[0].value();
  if (!(area > 0) || !std::isfinite(area)) {
    throw InvalidInput("the mesh has no area: all its triangles are degenerate; nothing to draw");
  }
  const auto mean = [&](std::size_t i) { return total.sums[i].value() / area; };
  const Vec3d m{mean(1), mean(2), mean(3)};
  return {m + origin,
          {mean(4) - m.x * m.x, mean(5) - m.x * m.y, mean(6) - m.x * m.z, mean(7) - m.y * m.y,
           mean(8) - m.y * m.z, mean(9) - m.z * m.z}};
}

// Whether the normal has a direction.
bool is_usable(const Vec3f& normal) {
  const float length = norm(normal);
  return std::isfinite(length) && length > 0;
}

// Returns the mesh's normals, with unusable ones replaced by those of vertex_normals(). The result
// is empty if all normals of the mesh are usable; the mesh's own array then serves without a copy.
Buffer<Vec3f> completed_normals(const IndexedMesh& mesh) {
  const bool own = mesh.normals.size() == mesh.vertex_count();
  if (own && std::ranges::all_of(mesh.normals, is_usable)) return {};
  Buffer<Vec3f> normals = vertex_normals(mesh);
  for (std::size_t v = 0; own && v < normals.size(); ++v) {
    if (is_usable(mesh.normals[v])) normals[v] = mesh.normals[v];
  }
  return normals;
}

}  // namespace

Buffer<Vec3f> vertex_normals(const IndexedMesh& mesh) {
  std::vector<Vec3d> sums(mesh.vertex_count(), Vec3d{0, 0, 0});
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const std::array<Vec3d, 3> v = corners(mesh, t, {0, 0, 0});
    const Vec3d normal = cross(v[1] - v[0], v[2] - v[0]);
    const double twice_area = norm(normal);
    if (!(twice_area > 0)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d to_next = v[(k + 1) % 3] - v[k], to_last = v[(k + 2) % 3] - v[k];
      // The angle between the edges from vertex k: the cross product of the two edge vectors has
      // the length twice_area at every corner. `normal` has this length too and is divided by it.
      const double angle = std::atan2(twice_area, dot(to_next, to_last));
      Vec3d& sum = sums[mesh.triangles[t][k]];
      sum = sum + (angle / twice_area) * normal;
    }
  }
  Buffer<Vec3f> normals(sums.size());
  std::ranges::transform(sums, normals.begin(), [](const Vec3d& sum) {
    const double length = norm(sum);
    return length > 0 ? cast<float>((1 / length) * sum) : Vec3f{0, 0, 1};
  });
  return normals;
}

MeshSource::MeshSource(const IndexedMesh& mesh, Paint paint)
    : mesh_(mesh), paint_(std::move(paint)) {
  check_drawable(mesh_);
  check_paint(mesh_, paint_);
  moments_ = area_moments(mesh_);
  normals_ = completed_normals(mesh_);
}

std::vector<double> MeshSource::support(std::span<const Vec3d> directions) const {
  const std::size_t blocks = block_count(mesh_.triangle_count(), kPerBlock), n = directions.size();
  const double lowest = -std::numeric_limits<double>::infinity();
  std::vector<double> parts(blocks * n, lowest);
  for_each_block(mesh_.triangle_count(), kPerBlock,
                 [&](std::size_t block, std::size_t first, std::size_t last) {
                   // The largest values of this block, one per direction.
                   double* reach = parts.data() + block * n;
                   for (std::size_t t = first; t < last; ++t) {
                     for (const std::uint32_t v : mesh_.triangles[t]) {
                       const Vec3d& p = mesh_.positions[v];
                       for (std::size_t i = 0; i < n; ++i)
                         reach[i] = std::max(reach[i], dot(directions[i], p));
                     }
                   }
                 });
  std::vector<double> reach(n, lowest);
  for (std::size_t i = 0; i < parts.size(); ++i) reach[i % n] = std::max(reach[i % n], parts[i]);
  return reach;
}

PaintKind MeshSource::paint() const {
  if (std::holds_alternative<VertexValues>(paint_)) return PaintKind::vertex_value;
  if (std::holds_alternative<TriangleValues>(paint_)) return PaintKind::triangle_value;
  return PaintKind::vertex_color;
}

const ColorScale* MeshSource::scale() const {
  if (const auto* values = std::get_if<VertexValues>(&paint_)) return &values->scale;
  if (const auto* values = std::get_if<TriangleValues>(&paint_)) return &values->scale;
  return nullptr;
}

// The difference of positions is taken in double before it becomes float, which keeps the digits of
// vertices far from the coordinate origin.
void MeshSource::write_vertices(std::span<SurfaceVertex> vertices, const Vec3d& origin) const {
  const Vec3f* normals = this->normals();
  const auto* one = std::get_if<Rgb>(&paint_);
  const auto* colors = std::get_if<VertexColors>(&paint_);
  const auto* values = std::get_if<VertexValues>(&paint_);
  for_each_index(vertices.size(), [&](std::size_t v) {
    const Rgb color = colors ? colors->colors[v] : one ? *one : Rgb{0, 0, 0};
    const std::array<std::uint8_t, 3> bytes = to_bytes(color);
    vertices[v] = {cast<float>(mesh_.positions[v] - origin),
                   normals[v],
                   {bytes[0], bytes[1], bytes[2], sky_.empty() ? kWholeSky : to_byte(sky_[v])},
                   values ? values->values[v] : 0};
  });
}

const Vec3f* MeshSource::normals() const {
  return normals_.empty() ? mesh_.normals.data() : normals_.data();
}

void MeshSource::shade() { sky_ = visible_sky(mesh_, {normals(), mesh_.vertex_count()}, *this); }

void MeshSource::write_triangles(std::span<Triangle> triangles) const {
  std::ranges::copy(mesh_.triangles, triangles.begin());
}

void MeshSource::write_triangle_values(std::span<float> values) const {
  if (const auto* each = std::get_if<TriangleValues>(&paint_)) {
    std::ranges::copy(each->values, values.begin());
  }
}

}  // namespace vdwmesh

// Quantises the positions of a mesh and lays its arrays out for a page.
#include "page/packed_mesh.hpp"

#include <cmath>
#include <cstdint>

namespace vdwmesh::apps {
namespace {

constexpr double kMaxPosition = 65535;  // 16 bits

Box box_around(const IndexedMesh& mesh) {
  Box box = empty_box();
  for (const Vec3d& p : mesh.positions) include(box, p);
  return box;
}

// Sixteen bits of the box are finer than a pixel of the page.
void append_positions(const IndexedMesh& mesh, const Box& box, std::string& bytes) {
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = box.upper[axis] - box.lower[axis];
    const double scale = extent > 0 ? kMaxPosition / extent : 0;
    std::vector<std::uint16_t> values;
    values.reserve(mesh.vertex_count());
    for (const Vec3d& p : mesh.positions) {
      values.push_back(
          static_cast<std::uint16_t>(std::lround((p[axis] - box.lower[axis]) * scale)));
    }
    append_planes(values, bytes);
  }
}

void append_triangles(const IndexedMesh& mesh, std::string& bytes) {
  std::vector<std::uint32_t> corners;
  corners.reserve(3 * mesh.triangle_count());
  for (const Triangle& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  append_planes(corners, bytes);
}

}  // namespace

Box append_mesh(const IndexedMesh& mesh, std::string& bytes) {
  const Box box = box_around(mesh);
  append_positions(mesh, box, bytes);
  append_triangles(mesh, bytes);
  return box;
}

void describe_packed(JsonText& json, const IndexedMesh& mesh, const Box& box) {
  json("vertices", mesh.vertex_count()), json("triangles", mesh.triangle_count());
  json("lower", std::vector{box.lower.x, box.lower.y, box.lower.z});
  json("upper", std::vector{box.upper.x, box.upper.y, box.upper.z});
}

}  // namespace vdwmesh::apps

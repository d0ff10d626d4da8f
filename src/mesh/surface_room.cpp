#include "mesh/surface_room.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>

#include "core/large_pages.hpp"
#include "mesh/surface_handles.hpp"

namespace vdwmesh {
namespace {

using handles::face;
using handles::half_edge;
using handles::vertex;

constexpr std::size_t kFewFaces = 1 << 10;
constexpr std::size_t kTouchedAtOnce = std::size_t{16} << 20;  // bytes

// All arrays of the mesh, between reserve() and resize(): the only time to ask for large pages.
template <class Visit>
void for_each_array(SurfaceMesh& mesh, const ElementCounts& n, Visit&& visit) {
  const OpenMesh::EdgeHandle edge(0);
  visit(&mesh.edge(edge), n.edges);
  visit(&mesh.face(face(0)), n.faces);
  visit(&mesh.vertex(vertex(0)), n.vertices);
  visit(mesh.points(), n.vertices);
  visit(mesh.vertex_normals(), n.vertices);
  visit(mesh.vertex_colors(), n.vertices);
  visit(&mesh.status(vertex(0)), n.vertices);
  visit(&mesh.status(half_edge(0)), 2 * n.edges);
  visit(&mesh.status(edge), n.edges);
  visit(&mesh.status(face(0)), n.faces);
  visit(&mesh.property(vertex_spheres(mesh), vertex(0)), n.vertices);
}

// The pages of an array that is not written yet, on all cores.
template <class T>
void touch(const T* begin, std::size_t count) {
  advise_large_pages(begin, count);
  const PageRange pages = whole_pages(begin, count * sizeof(T), kPage);
  const auto bytes = static_cast<std::size_t>(pages.last - pages.first);
  tbb::parallel_for(std::size_t{0}, (bytes + kTouchedAtOnce - 1) / kTouchedAtOnce,
                    [&](std::size_t piece) {
                      const char* const first = pages.first + piece * kTouchedAtOnce;
                      touch_pages(first, std::min(first + kTouchedAtOnce, pages.last));
                    });
}

// The properties of the mesh, each of which is a single thread's work, side by side.
void resize_properties(SurfaceMesh& mesh, const ElementCounts& counts) {
  tbb::task_group properties;
  const auto resize = [&](auto first, auto last, std::size_t count) {
    for (; first != last; ++first) {
      if (OpenMesh::BaseProperty* const property = *first)
        properties.run([property, count] { property->resize(count); });
    }
  };
  resize(mesh.vprops_begin(), mesh.vprops_end(), counts.vertices);
  resize(mesh.hprops_begin(), mesh.hprops_end(), 2 * counts.edges);
  resize(mesh.eprops_begin(), mesh.eprops_end(), counts.edges);
  resize(mesh.fprops_begin(), mesh.fprops_end(), counts.faces);
  properties.wait();
}

}  // namespace

void make_room(SurfaceMesh& mesh, const ElementCounts& counts) {
  if (mesh.n_faces() == 0 && counts.faces > kFewFaces) {
    mesh.resize(1, 1, 1);
    mesh.reserve(counts.vertices, counts.edges, counts.faces);
    for_each_array(mesh, counts, [](const auto* begin, std::size_t count) { touch(begin, count); });
    resize_properties(mesh, counts);
  }
  mesh.resize(counts.vertices, counts.edges, counts.faces);
}

}  // namespace vdwmesh

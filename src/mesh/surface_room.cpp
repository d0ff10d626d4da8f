// Allocates the arrays of a SurfaceMesh on all cores, in four steps: reserve() allocates address
// space without writing to it; madvise() asks for large pages under every array; all cores touch
// the pages, so that the kernel maps them in parallel; at last the properties are resized, which
// writes their initial values, one task per property. The result equals mesh.resize().
//
// connect() calls make_room() when it knows the number of edges. SurfaceMeshBuilder::prepare()
// calls it earlier, in the background.
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

// Up to this number of faces OpenMesh resizes the arrays: they are so small (about 100 kB in all)
// that large pages and threads gain nothing.
constexpr std::size_t kFewFaces = 1 << 10;
constexpr std::size_t kTouchedAtOnce = std::size_t{16} << 20;  // bytes per task

// Calls visit(first element, number of elements) for every large array of the mesh. It is meant for
// the moment between reserve() and resize(), when the memory is allocated but not yet written:
// later, the kernel has already chosen small pages. The mesh needs at least one vertex, edge and
// face, because the addresses are taken from element 0.
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

// Makes the kernel map the pages of an array, in pieces of kTouchedAtOnce bytes on all cores. This
// writes nothing into the array.
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

// Resizes the properties of the mesh, which in OpenMesh include positions, normals and colours. One
// resize() uses one thread, so each property is a task of its own.
void resize_properties(SurfaceMesh& mesh, const ElementCounts& counts) {
  tbb::task_group properties;
  // OpenMesh keeps a null pointer where a property was removed.
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
    // One element of each kind gives for_each_array() an element 0 whose address it can take.
    mesh.resize(1, 1, 1);
    mesh.reserve(counts.vertices, counts.edges, counts.faces);
    for_each_array(mesh, counts, [](const auto* begin, std::size_t count) { touch(begin, count); });
    resize_properties(mesh, counts);
  }
  // This resizes the arrays of connectivity. Properties that have their size are left as they are.
  mesh.resize(counts.vertices, counts.edges, counts.faces);
}

}  // namespace vdwmesh

// Meshes for Python's pickle: the bytes of all arrays, so that what comes back is the mesh bit for
// bit. Arrays of one machine are read on machines of its byte order alone, as all that vdwmesh runs
// on have.
#include <cstring>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/errors.hpp"
#include "mesh_handle.hpp"

namespace vdwmesh::python {
namespace {

namespace py = pybind11;

template <class List>
py::bytes packed(const List& list) {
  using Element = std::remove_cvref_t<decltype(*list.data())>;
  static_assert(std::is_trivially_copyable_v<Element>);
  return {reinterpret_cast<const char*>(list.data()), list.size() * sizeof(Element)};
}

template <class List>
void unpack(const py::handle& bytes, List& list) {
  using Element = std::remove_cvref_t<decltype(*list.data())>;
  const auto from = bytes.cast<std::string_view>();
  if (from.size() % sizeof(Element) != 0) throw InvalidInput("the pickle of a mesh is damaged");
  list.resize(from.size() / sizeof(Element));
  if (!from.empty()) std::memcpy(list.data(), from.data(), from.size());
}

}  // namespace

py::tuple pickled(const MeshHandle& h) {
  const IndexedMesh& mesh = *h.mesh;
  py::object grid = py::none(), patches = py::none(), of_triangles = py::none();
  py::object of_vertices = py::none();
  if (h.grid) grid = packed(std::vector<GridSpec>{*h.grid});
  if (h.patched) {
    patches = packed(h.patched->patches);
    of_triangles = packed(h.patched->triangle_patch);
    of_vertices = packed(h.patched->vertex_patch);
  }
  return py::make_tuple(packed(mesh.positions), packed(mesh.normals),
                        packed(mesh.vertex_spheres.atoms), packed(mesh.vertex_spheres.others),
                        packed(mesh.triangles), packed(mesh.triangle_spheres),
                        packed(mesh.opposite), grid, patches, of_triangles, of_vertices);
}

MeshHandle unpickled(const py::tuple& parts) {
  if (parts.size() != 11) throw InvalidInput("the pickle of a mesh is of another version");
  PatchedMesh patched;
  IndexedMesh& mesh = patched.mesh;
  unpack(parts[0], mesh.positions);
  unpack(parts[1], mesh.normals);
  unpack(parts[2], mesh.vertex_spheres.atoms);
  unpack(parts[3], mesh.vertex_spheres.others);
  unpack(parts[4], mesh.triangles);
  unpack(parts[5], mesh.triangle_spheres);
  unpack(parts[6], mesh.opposite);
  if (!parts[8].is_none()) {
    unpack(parts[8], patched.patches);
    unpack(parts[9], patched.triangle_patch);
    unpack(parts[10], patched.vertex_patch);
    return handle_of(std::move(patched));
  }
  std::vector<GridSpec> grid;
  if (!parts[7].is_none()) unpack(parts[7], grid);
  return handle_of(std::move(mesh), grid.empty() ? std::nullopt : std::optional(grid.front()));
}

}  // namespace vdwmesh::python

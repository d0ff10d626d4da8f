// Pockets for Python: a dictionary for each, by falling volume. The classes that users see are made
// of them in _pockets.py.
#include "pockets/pockets.hpp"

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "call.hpp"
#include "requests.hpp"
#include "topics.hpp"

namespace vdwmesh::python {
namespace {

using namespace py::literals;

py::tuple place_of(const Vec3d& v) { return py::make_tuple(v.x, v.y, v.z); }

py::tuple mouths_of(const Pocket& pocket) {
  py::list mouths;
  for (const Mouth& m : pocket.mouths) {
    mouths.append(py::dict("area"_a = m.area, "rim"_a = m.rim, "area_sum"_a = m.area_sum,
                           "rim_sum"_a = m.rim_sum, "center"_a = place_of(m.center),
                           "faces"_a = m.faces));
  }
  return py::tuple(mouths);
}

py::dict dict_of(const Pocket& p, double probe) {
  py::list atoms, areas;
  for (const LiningSphere& s : p.lining) {
    atoms.append(s.id);
    areas.append(s.area);
  }
  const auto grown = [&](std::optional<double> clearance) {
    return clearance ? std::optional(*clearance + probe) : std::nullopt;
  };
  return py::dict(
      "kind"_a = std::string(kind_name(p.kind)), "volume"_a = p.volume, "area"_a = p.area,
      "volume_sum"_a = p.volume_sum, "area_sum"_a = p.area_sum, "mouths"_a = mouths_of(p),
      "lining"_a = py::tuple(atoms), "lining_areas"_a = py::tuple(areas), "atoms"_a = p.spheres,
      "tetrahedra"_a = p.tetrahedra, "sinks"_a = p.sinks, "depth_alpha"_a = p.depth_alpha,
      "bottleneck_alpha"_a = p.bottleneck_alpha, "center"_a = place_of(p.clear_place),
      "depth_probe"_a = grown(p.clearance), "bottleneck_radius"_a = grown(p.bottleneck_clearance));
}

// The pockets as dictionaries, and the number of ties.
py::tuple pockets_of(const py::buffer& coords, const py::buffer& radii, double probe,
                     std::optional<int> threads) {
  const Numbers centers(coords, "coords", 2), sizes(radii, "radii", 1);
  const PocketTable table = call(threads, [&](Monitor& monitor) {
    return pockets(spheres_of(centers, sizes, probe), {.monitor = &monitor});
  });
  py::list list;
  for (const Pocket& pocket : table.pockets) list.append(dict_of(pocket, probe));
  return py::make_tuple(list, table.face_ties);
}

}  // namespace

void bind_pockets(py::module_& module) { module.def("pockets", &pockets_of); }

}  // namespace vdwmesh::python

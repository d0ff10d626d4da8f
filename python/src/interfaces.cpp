// Interfaces between groups of atoms for Python. Arrays are views of the library's result, which
// they keep alive together.
#include "interface/interfaces.hpp"

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "call.hpp"
#include "interface/complementarity.hpp"
#include "topics.hpp"

namespace vdwmesh::python {
namespace {

using namespace py::literals;

py::dict dict_of(const std::shared_ptr<const Interfaces>& all, const Interface& pair) {
  const InterfaceAtom* const atoms = pair.atoms.data();
  const AtomContact* const contacts = pair.contacts.data();
  const std::size_t row = sizeof(InterfaceAtom), count = pair.atoms.size();
  const auto column = [&](const auto* first) { return array_of(all, first, count, 0, row); };
  const auto faces = pair.contacts.size();
  return py::dict(
      "a"_a = pair.a, "b"_a = pair.b, "buried_area"_a = pair.buried_area(),
      "buried_a"_a = pair.buried_a, "buried_b"_a = pair.buried_b, "area_a"_a = pair.area_a,
      "area_b"_a = pair.area_b, "contact_area"_a = pair.contact_area,
      "atoms"_a = column(&atoms->sphere), "atom_area"_a = column(&atoms->alone),
      "atom_area_in_pair"_a = column(&atoms->in_pair),
      "contacts"_a = array_of(all, &contacts->a, faces, 2, sizeof(AtomContact)),
      "contact_areas"_a = array_of(all, &contacts->area, faces, 0, sizeof(AtomContact)));
}

py::dict dict_of(const Complementarity& fit) {
  return py::dict("sc"_a = fit.sc, "error"_a = fit.error, "median_a"_a = fit.median_a,
                  "median_b"_a = fit.median_b, "fitted_a"_a = fit.fitted_a,
                  "fitted_b"_a = fit.fitted_b, "buried_a"_a = fit.buried_a,
                  "buried_b"_a = fit.buried_b, "contact_a"_a = fit.contact_a,
                  "contact_b"_a = fit.contact_b);
}

SphereSet balls_of(const SphereSet& atoms, const std::vector<std::int32_t>& sides,
                   std::int32_t side) {
  std::vector<Sphere> balls;
  for (std::size_t i = 0; i < sides.size(); ++i)
    if (sides[i] == side) balls.push_back(atoms[static_cast<SphereId>(i)]);
  return SphereSet(std::move(balls));
}

// The areas of all atoms, alone and in the whole, and the pairs that touch, with their shape
// complementarity if it is wanted. The number of no side
// is the largest of 32 bits.
py::tuple interfaces_of(const py::buffer& coords, const py::buffer& radii, double probe,
                        const py::buffer& sides, bool with_fit, std::optional<int> threads) {
  const Numbers centers(coords, "coords", 2), sizes(radii, "radii", 1);
  std::vector<std::int32_t> side;
  for (const SphereId id : ids_of(sides)) side.push_back(static_cast<std::int32_t>(id));
  std::vector<Complementarity> fits;
  const auto all = std::make_shared<const Interfaces>(call(threads, [&](Monitor& monitor) {
    Interfaces found = interfaces(spheres_of(centers, sizes, probe), side, &monitor);
    if (!with_fit) return found;
    const SphereSet atoms = spheres_of(centers, sizes, 0);
    for (const Interface& pair : found.pairs)
      fits.push_back(complementarity(balls_of(atoms, side, pair.a), balls_of(atoms, side, pair.b),
                                     {.probe = probe, .monitor = &monitor}));
    return found;
  }));
  py::list pairs;
  for (std::size_t i = 0; i < all->pairs.size(); ++i) {
    pairs.append(dict_of(all, all->pairs[i]));
    pairs[i]["complementarity"] = with_fit ? py::object(dict_of(fits[i])) : py::none();
  }
  return py::make_tuple(array_of(all, all->alone.data(), all->alone.size()),
                        array_of(all, all->in_whole.data(), all->in_whole.size()), pairs);
}

}  // namespace

void bind_interfaces(py::module_& module) { module.def("interfaces", &interfaces_of); }

}  // namespace vdwmesh::python

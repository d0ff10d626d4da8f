// Interfaces between groups of atoms for Python. Arrays are views of the library's result, which
// they keep alive together.
#include "interface/interfaces.hpp"

#include "arrays.hpp"
#include "call.hpp"
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

// The areas of all atoms, alone and in the whole, and the pairs that touch. The number of no side
// is the largest of 32 bits.
py::tuple interfaces_of(const py::buffer& coords, const py::buffer& radii, double probe,
                        const py::buffer& sides, std::optional<int> threads) {
  const Numbers centers(coords, "coords", 2), sizes(radii, "radii", 1);
  std::vector<std::int32_t> side;
  for (const SphereId id : ids_of(sides)) side.push_back(static_cast<std::int32_t>(id));
  const auto all = std::make_shared<const Interfaces>(call(threads, [&](Monitor& monitor) {
    return interfaces(spheres_of(centers, sizes, probe), side, &monitor);
  }));
  py::list pairs;
  for (const Interface& pair : all->pairs) pairs.append(dict_of(all, pair));
  return py::make_tuple(array_of(all, all->alone.data(), all->alone.size()),
                        array_of(all, all->in_whole.data(), all->in_whole.size()), pairs);
}

}  // namespace

void bind_interfaces(py::module_& module) { module.def("interfaces", &interfaces_of); }

}  // namespace vdwmesh::python

// Exact measures of the solvent-excluded surface for Python. Arrays of a result are views of the
// ExcludedMeasures, which they keep alive together.
#include <pybind11/stl.h>

#include "arrays.hpp"
#include "call.hpp"
#include "excluded/excluded_measures.hpp"
#include "topics.hpp"

namespace vdwmesh::python {
namespace {

using namespace py::literals;

py::object topology_of(const ExcludedSurface& surface) {
  if (!surface.topology) return py::none();
  py::list shells, components;
  for (const ExcludedShell& s : surface.topology->shells) {
    shells.append(py::make_tuple(s.area, s.volume, s.euler_characteristic, s.genus));
  }
  for (const AccessibleComponent& c : surface.topology->components) {
    components.append(
        py::make_tuple(c.accessible_area, c.accessible_volume, c.is_cavity, c.excluded_area));
  }
  return py::dict("euler_characteristic"_a = surface.topology->euler_characteristic,
                  "cavities"_a = surface.topology->cavities, "shells"_a = shells,
                  "components"_a = components);
}

py::dict dict_of(const ExcludedSurface& s) {
  const ExcludedChecks& c = s.checks;
  return py::dict(
      "area"_a = s.area, "volume"_a = s.volume, "contact_area"_a = s.area_by_kind.contact,
      "saddle_area"_a = s.area_by_kind.saddle, "concave_area"_a = s.area_by_kind.concave,
      "accessible_area"_a = s.accessible_area, "accessible_volume"_a = s.accessible_volume,
      "topology"_a = topology_of(s), "probes"_a = s.counts.probes,
      "low_probes"_a = s.counts.low_probes, "crowded_probes"_a = s.counts.crowded_probes,
      "closure"_a = c.closure, "check_volume"_a = c.check_volume,
      "extended_decisions"_a = c.extended_decisions, "ties"_a = c.ties,
      "uncertified_patches"_a = c.uncertified_patches);
}

// The measures of the complete surface, of the exterior one, and the atoms' shares in the complete
// one: rows of contact, saddle and concave area, and volume.
py::tuple excluded(const py::buffer& coords, const py::buffer& radii, double probe, bool topology,
                   std::optional<int> threads) {
  const Numbers centers(coords, "coords", 2), sizes(radii, "radii", 1);
  const auto found = call(threads, [&](Monitor& monitor) {
    ExcludedOptions options{.probe = probe, .per_atom = true, .exterior = true};
    options.shells = topology;
    options.monitor = &monitor;
    return std::make_shared<const ExcludedMeasures>(
        excluded_measures(spheres_of(centers, sizes, 0), options));
  });
  const auto& atoms = found->complete.per_atom;
  static_assert(sizeof(ExcludedAtom) == 4 * sizeof(double));
  const auto* rows = reinterpret_cast<const double*>(atoms.data());
  return py::make_tuple(dict_of(found->complete), dict_of(found->exterior.value()),
                        array_of(found, rows, atoms.size(), 4));
}

}  // namespace

void bind_excluded(py::module_& module) { module.def("excluded", &excluded); }

}  // namespace vdwmesh::python

// Exact measures of the solvent-excluded surface for Python, on the CPU or a device. Arrays of a
// result are views of the ExcludedMeasures, which they keep alive together.
#include <pybind11/stl.h>

#include "arrays.hpp"
#include "call.hpp"
#include "core/errors.hpp"
#include "cuda/backend.hpp"
#include "excluded/excluded_measurer.hpp"
#include "excluded/excluded_measures.hpp"
#include "requests.hpp"
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
      "topology"_a = topology_of(s), "euler_characteristic"_a = s.euler_characteristic,
      "probes"_a = s.counts.probes, "low_probes"_a = s.counts.low_probes,
      "crowded_probes"_a = s.counts.crowded_probes, "closure"_a = c.closure,
      "check_volume"_a = c.check_volume, "extended_decisions"_a = c.extended_decisions,
      "ties"_a = c.ties, "uncertified_patches"_a = c.uncertified_patches);
}

ExcludedMeasures measure_on_device(const SphereSet& atoms, double probe, Monitor& monitor) {
  ExcludedBatch found =
      make_excluded_measurer(Backend::cuda)->measure(batch_of(atoms), probe, &monitor);
  ExcludedMeasures out{probe, surface_of(found, 0), {}};
  out.complete.per_atom = std::move(found.per_atom);
  check_digits(out.complete, probe);
  return out;
}

// The measures of the complete surface, of the exterior one, which a device leaves out, and the
// atoms' shares in the complete one: rows of contact, saddle and concave area, and volume. If
// wanted its derivatives: rows of eight by atom, those by the probe, and how many probes and atoms
// may have none.
py::tuple excluded(const py::buffer& coords, const py::buffer& radii, std::optional<int> threads,
                   const std::string& device, bool gradient, const py::kwargs& given) {
  const ExactOptions exact = exact_options_of(given);
  const double probe = exact.probe;
  const bool topology = exact.topology == TopologyRequest::full;
  const Numbers centers(coords, "coords", 2), sizes(radii, "radii", 1);
  const bool on_device = backend_of(device) == Backend::cuda;
  if (on_device && gradient) {
    throw BackendUnavailable("device: the CPU alone knows derivatives of the excluded surface");
  }
  if (on_device && topology) {
    throw BackendUnavailable("device: the CPU alone finds the shells of the excluded surface");
  }
  const auto found = call(threads, [&](Monitor& monitor) {
    if (on_device) {
      return std::make_shared<const ExcludedMeasures>(
          measure_on_device(spheres_of(centers, sizes, 0), probe, monitor));
    }
    ExcludedOptions options{.probe = probe, .per_atom = true, .exterior = true};
    options.shells = topology;
    options.gradients = gradient;
    options.monitor = &monitor;
    return std::make_shared<const ExcludedMeasures>(
        excluded_measures(spheres_of(centers, sizes, 0), options));
  });
  for (const std::string& line : doubts(found->complete)) {
    if (PyErr_WarnEx(PyExc_RuntimeWarning, line.c_str(), 1) != 0) throw py::error_already_set();
  }
  const auto& atoms = found->complete.per_atom;
  static_assert(sizeof(ExcludedAtom) == 4 * sizeof(double));
  const auto* rows = reinterpret_cast<const double*>(atoms.data());
  py::object exterior = py::none();
  if (found->exterior) exterior = dict_of(*found->exterior);
  py::object slopes = py::none();
  if (const auto& g = found->complete.gradients) {
    static_assert(sizeof(BallGradient) == 8 * sizeof(double));
    const auto* first = reinterpret_cast<const double*>(g->per_atom.data());
    slopes = py::make_tuple(array_of(found, first, g->per_atom.size(), 8), g->area_probe,
                            g->volume_probe, g->kink_probes, g->kink_atoms);
  }
  return py::make_tuple(dict_of(found->complete), exterior, array_of(found, rows, atoms.size(), 4),
                        slopes);
}

}  // namespace

void bind_excluded(py::module_& module) { module.def("excluded", &excluded); }

}  // namespace vdwmesh::python

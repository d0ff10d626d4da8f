// Keyword arguments are put into the requests of the library, whose rules the program has too. The
// Python layer brings arrays and numbers into form; names and what goes together are checked here.
#include "requests.hpp"

#include "request/read_request.hpp"
#include "topics.hpp"

namespace vdwmesh::python {
namespace {

namespace py = pybind11;
using namespace py::literals;

SurfaceChoice choice_of(const std::string& surface) {
  return value_named<SurfaceChoice>("surface:", surface);
}

Inclusion inclusion_of(bool kept) { return kept ? Inclusion::keep : Inclusion::drop; }

// The same arguments, checked before anything is read.
py::dict settle_measures(const py::kwargs& given) {
  const ExactOptions exact = exact_options_of(given);
  return py::dict("probe"_a = exact.probe, "topology"_a = name_of(exact.topology),
                  "method"_a = name_of(exact.method));
}

}  // namespace

Backend backend_of(const std::string& device) {
  const auto backend = value_named<Backend>("device:", device);
  return backend == Backend::cuda ? resolve(backend) : backend;
}

double probe_of(const std::string& surface, std::optional<double> probe) {
  return vdwmesh::probe_of(choice_of(surface), probe, Door::python);
}

bool is_excluded(const std::string& surface) {
  return surface_of(choice_of(surface)) == ExactSurface::excluded;
}

ReadOptions read_options_of(const py::kwargs& given) {
  ReadOptions options;
  options.format = named<StructureFormat>(given, "format").value_or(StructureFormat::by_extension);
  options.unit = named<LengthUnit>(given, "units").value_or(LengthUnit::by_format);
  options.model = given["model"].cast<std::string>();
  options.assembly = given["assembly"].cast<std::string>();
  options.radii = given["radii"].cast<std::string>();
  options.select = given["select"].cast<std::string>();
  options.altloc = given["altloc"].cast<std::string>();
  options.waters = inclusion_of(given["waters"].cast<bool>());
  options.hydrogens = inclusion_of(given["hydrogens"].cast<bool>());
  options.hetero_atoms = inclusion_of(given["hetatm"].cast<bool>());
  settle(options, Door::python);
  return options;
}

ExactOptions exact_options_of(const py::kwargs& given) {
  MeasureRequest request;
  request.door = Door::python;
  request.surface = named<SurfaceChoice>(given, "surface").value_or(SurfaceChoice::vdw);
  request.probe = value_of<double>(given, "probe");
  request.method = named<UnionMethod>(given, "method");
  request.topology = named<TopologyRequest>(given, "topology");
  request.usual_topology = TopologyRequest::none;
  return settle(request);
}

SurfaceOptions surface_options_of(const py::kwargs& given) {
  MeshRequest request;
  request.door = Door::python;
  request.surface = choice_of(given["surface"].cast<std::string>());
  request.mesher = named<Mesher>(given, "mesher");
  request.edge_length = value_of<double>(given, "edge_length");
  request.density = value_of<double>(given, "density");
  request.max_distance = value_of<double>(given, "max_distance");
  request.min_angle = value_of<double>(given, "min_angle");
  request.spacing = value_of<double>(given, "spacing");
  request.fixed_grid = given["fixed_grid"].cast<bool>();
  request.subdivisions = value_of<int>(given, "subdivide");
  request.crossings = named<Crossings>(given, "crossings");
  if (const auto lengths = value_of<std::vector<double>>(given, "edge_lengths")) {
    request.edge_lengths = *lengths;
  }
  request.field = named<FieldKind>(given, "field").value_or(FieldKind::vdw);
  return settle(request);
}

void bind_requests(py::module_& module) {
  module.def("settle_measures", &settle_measures);
  module.def("is_excluded", &is_excluded);
  module.def("probe_of", py::overload_cast<const std::string&, std::optional<double>>(&probe_of));
}

}  // namespace vdwmesh::python

// Exact measures of unions of balls for Python. Arrays of a result are views of the ExactUnion,
// which they keep alive together.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <limits>
#include <map>

#include "arrangement/exact_union.hpp"
#include "arrays.hpp"
#include "call.hpp"
#include "core/errors.hpp"
#include "core/sum.hpp"
#include "topics.hpp"

namespace vdwmesh::python {
namespace {

using namespace py::literals;

using Ids = std::optional<std::vector<SphereId>>;  // of the atoms that are measured; empty: all

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

const std::map<std::string, UnionMethod, std::less<>> kMethods{{"auto", UnionMethod::automatic},
                                                               {"cgal", UnionMethod::cgal},
                                                               {"arcs", UnionMethod::arcs},
                                                               {"both", UnionMethod::both}};

UnionMethod method_of(const std::string& name) {
  const auto found = kMethods.find(name);
  if (found != kMethods.end()) return found->second;
  throw InvalidInput(fmt::format("method: {}; there are auto, cgal, arcs and both", name));
}

const std::string& name_of(UnionMethod method) {
  for (const auto& [name, value] : kMethods) {
    if (value == method) return name;
  }
  throw InternalError("a method of the exact union without a name");
}

Ids ids_or_all(const std::optional<py::buffer>& atoms) {
  return atoms ? Ids(ids_of(*atoms)) : std::nullopt;
}

std::optional<std::span<const SphereId>> span_of(const Ids& ids) {
  return ids ? std::optional<std::span<const SphereId>>(*ids) : std::nullopt;
}

py::object topology_of(const std::shared_ptr<const ExactUnion>& exact, bool wanted) {
  if (!wanted || !exact->topology) return py::none();
  const UnionTopology& t = *exact->topology;
  static_assert(sizeof(Shell) == 2 * sizeof(double));
  const auto* shells = reinterpret_cast<const double*>(t.shells.data());
  return py::dict(
      "components"_a = t.components, "tunnels"_a = t.tunnels, "voids"_a = t.voids,
      "euler_characteristic"_a = t.euler_characteristic, "point_contacts"_a = t.point_contacts,
      "hidden_atoms"_a = t.hidden_spheres, "shells"_a = array_of(exact, shells, t.shells.size(), 2),
      "outer_area"_a = t.outer_area, "void_area"_a = t.void_area, "void_volume"_a = t.void_volume);
}

py::dict dict_of(ExactUnion&& result, bool with_topology) {
  const auto exact = std::make_shared<const ExactUnion>(std::move(result));
  const auto& atoms = exact->per_sphere;
  const std::size_t row = sizeof(SphereMeasures);
  return py::dict("area"_a = exact->area, "volume"_a = exact->volume,
                  "atom_area"_a = array_of(exact, &atoms.data()->area, atoms.size(), 0, row),
                  "atom_volume"_a = array_of(exact, &atoms.data()->volume, atoms.size(), 0, row),
                  "topology"_a = topology_of(exact, with_topology),
                  "method"_a = name_of(exact->method), "check_area"_a = exact->check_area,
                  "check_volume"_a = exact->check_volume,
                  "fallback_atoms"_a = exact->fallback_spheres);
}

UnionOptions options_of(UnionMethod method, bool topology, const Ids& atoms, Monitor& monitor) {
  UnionOptions options;
  options.method = method;
  options.monitor = &monitor;
  options.topology = topology ? TopologyRequest::full : TopologyRequest::none;
  options.measured = span_of(atoms);
  return options;
}

py::dict exact(const py::buffer& coords, const py::buffer& radii, double probe,
               const std::optional<py::buffer>& atoms, bool topology, const std::string& method,
               std::optional<int> threads) {
  const Numbers centers(coords, "coords", 2), sizes(radii, "radii", 1);
  const Ids ids = ids_or_all(atoms);
  const UnionMethod chosen = method_of(method);
  ExactUnion result = call(threads, [&](Monitor& monitor) {
    return exact_union(spheres_of(centers, sizes, probe),
                       options_of(chosen, topology, ids, monitor));
  });
  return dict_of(std::move(result), topology);
}

// Sums of the atoms' areas by group; NaN for a group of which no atom was measured.
void add_by_group(const std::vector<SphereMeasures>& atoms, const std::vector<SphereId>& group,
                  double* sums, std::size_t groups) {
  std::vector<WideSum> wide(groups);
  std::vector<bool> is_measured(groups);
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    if (std::isnan(atoms[i].area)) continue;
    wide[group[i]].add(atoms[i].area);
    is_measured[group[i]] = true;
  }
  for (std::size_t g = 0; g < groups; ++g) {
    sums[g] = is_measured[g] ? wide[g].value() : kNotMeasured;
  }
}

// The areas of all frames: one number for a frame without groups, else one for each group. Every
// atom has a group below `groups`.
std::vector<double> areas(const Numbers& frames, const Numbers& radii, double probe,
                          const UnionOptions& options, const std::vector<SphereId>& group,
                          std::size_t groups) {
  std::vector<double> found(frames.size(0) * (groups > 0 ? groups : 1));
  std::vector<Vec3d> centers;
  SphereSet spheres;
  ExactUnion exact{};
  for (std::size_t t = 0; t < frames.size(0); ++t) {
    points_of_frame(frames, t, centers);
    if (t == 0) spheres = spheres_of(centers, radii, probe);
    if (t > 0) spheres.move_to(centers);
    exact_union_into(exact, spheres, options);
    if (groups == 0) found[t] = exact.area;
    if (groups > 0) add_by_group(exact.per_sphere, group, &found[t * groups], groups);
  }
  return found;
}

Array sasa(const py::buffer& coords, const py::buffer& radii, double probe,
           const std::optional<py::buffer>& atoms, const std::optional<py::buffer>& group,
           std::size_t groups, const std::string& method, std::optional<int> threads) {
  const Numbers frames(coords, "coords", 3), sizes(radii, "radii", 1);
  const Ids ids = ids_or_all(atoms);
  const UnionMethod chosen = method_of(method);
  const std::vector<SphereId> group_of = group ? ids_of(*group) : std::vector<SphereId>();
  std::vector<double> found = call(threads, [&](Monitor& monitor) {
    Workspace workspace;
    UnionOptions options = options_of(chosen, false, ids, monitor);
    options.workspace = &workspace;
    return areas(frames, sizes, probe, options, group_of, groups);
  });
  return array_of(std::move(found));
}

}  // namespace

void bind_measures(py::module_& module) {
  module.def("exact", &exact);
  module.def("sasa", &sasa);
}

}  // namespace vdwmesh::python

// Exact measures of unions of balls for Python, of one set or of many frames. Arrays of a result
// are views of the ExactUnion, which they keep alive together.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cmath>
#include <limits>

#include "arrays.hpp"
#include "call.hpp"
#include "core/errors.hpp"
#include "core/sum.hpp"
#include "cuda/backend.hpp"
#include "cuda_array.hpp"
#include "measures/frame_measures.hpp"
#include "measures/union_gradients.hpp"
#include "requests.hpp"
#include "topics.hpp"

namespace vdwmesh::python {
namespace {

using namespace py::literals;

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

// What the functions of Python ask for, beside coordinates and radii.
struct MeasureCall {
  explicit MeasureCall(const py::kwargs& given)
      : unit(given["unit"].cast<double>()),
        exact(exact_options_of(given)),
        per_atom(given["per_atom"].cast<bool>()),
        groups(given["group_count"].cast<std::size_t>()),
        threads(given["threads"].cast<std::optional<int>>()),
        backend(backend_of(given["device"].cast<std::string>())),
        balls(given["balls"].cast<std::size_t>()) {
    if (!given["atoms"].is_none()) atoms = ids_of(given["atoms"].cast<py::buffer>());
    if (groups > 0) group = ids_of(given["groups"].cast<py::buffer>());
  }

  double unit;
  ExactOptions exact;
  bool per_atom;
  std::size_t groups;                          // 0: sums by group are not wanted
  std::vector<SphereId> group;                 // of each atom
  std::optional<std::vector<SphereId>> atoms;  // that are measured
  std::optional<int> threads;
  Backend backend;
  std::size_t balls;  // in all frames of this call and of those that belong to it
};

// Whether a device can measure what is asked for.
bool suits_device(const MeasureCall& request) {
  return request.exact.method == UnionMethod::arcs &&
         request.exact.topology == TopologyRequest::none;
}

// The device's measurer, or null where the CPU is to measure. Throws BackendUnavailable if a device
// is asked for what it cannot do.
std::unique_ptr<UnionMeasurer> measurer_for(const MeasureCall& request) {
  if (request.backend == Backend::cuda) {
    if (suits_device(request)) return make_union_measurer(Backend::cuda);
    throw BackendUnavailable(
        "device: a device measures areas and volumes by arcs; topology and the other methods are "
        "computed on the CPU, so leave device to auto");
  }
  const bool pays = suits_device(request) && request.balls >= kBallsWorthADevice;
  if (request.backend == Backend::cpu || !pays) return nullptr;
  if (resolve(Backend::automatic) == Backend::cpu) return nullptr;
  return make_union_measurer(Backend::automatic);
}

FrameOptions options_of(const MeasureCall& request, const UnionMeasurer* measurer,
                        Monitor& monitor) {
  FrameOptions options;
  options.measures.method = request.exact.method;
  options.measures.monitor = &monitor;
  options.measures.topology = request.exact.topology;
  if (request.atoms) options.measures.measured = *request.atoms;
  const bool keep = request.per_atom || request.groups > 0;
  options.per_sphere = keep ? PerSphere::keep : PerSphere::drop;
  options.measurer = measurer;
  return options;
}

FrameCoordinates coordinates_of(const Numbers& frames, double unit) {
  if (frames.size(2) != 3 || frames.size(1) == 0) {
    throw InvalidInput(fmt::format("{}: has shape ({}, {}, {}); (T, N, 3) is needed, N above 0",
                                   frames.name(), frames.size(0), frames.size(1), frames.size(2)));
  }
  return {.first = frames.bytes(),
          .type = frames.is_float32() ? CoordinateType::float32 : CoordinateType::float64,
          .frames = frames.size(0),
          .atoms = frames.size(1),
          .frame_stride = frames.strides()[0],
          .atom_stride = frames.strides()[1],
          .axis_stride = frames.strides()[2],
          .unit = unit};
}

// Sums of the atoms' areas by group; NaN for a group of which no atom was measured.
std::vector<double> areas_by_group(const std::vector<SphereMeasures>& atoms,
                                   const MeasureCall& request) {
  std::vector<WideSum> wide(request.groups);
  std::vector<bool> is_measured(request.groups);
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    if (std::isnan(atoms[i].area)) continue;
    wide[request.group[i]].add(atoms[i].area);
    is_measured[request.group[i]] = true;
  }
  std::vector<double> sums(request.groups);
  for (std::size_t g = 0; g < sums.size(); ++g) {
    sums[g] = is_measured[g] ? wide[g].value() : kNotMeasured;
  }
  return sums;
}

// What the library finds of some frames.
struct Found {
  std::vector<ExactUnion> frames;
  std::vector<std::vector<double>> groups;    // one for each frame, if wanted
  std::optional<InvalidFrame> invalid;        // of the first frame that is not there
  std::shared_ptr<const CudaMeasures> there;  // of the atoms of all frames, if left on a device
};

// Sums by group, and drops what is not wanted.
void finish(Found& found, const MeasureCall& request) {
  for (ExactUnion& frame : found.frames) {
    if (request.groups > 0) found.groups.push_back(areas_by_group(frame.per_sphere, request));
    if (!request.per_atom) frame.per_sphere = {};
  }
}

Found measure_all(const Numbers& coords, const Numbers& sizes, const MeasureCall& request,
                  Monitor& monitor) {
  const std::unique_ptr<UnionMeasurer> measurer = measurer_for(request);
  const std::vector<double> radii = grown_radii(sizes, coords.size(1), request.exact.probe);
  Found found;
  try {
    measure_frames(found.frames, radii, coordinates_of(coords, request.unit),
                   options_of(request, measurer.get(), monitor));
  } catch (const InvalidFrame& error) {
    found.invalid = error;
  }
  finish(found, request);
  return found;
}

Found measure_there(const DeviceFrames& balls, const MeasureCall& request, Monitor& monitor) {
  Found found;
  CudaMeasures there =
      measure_on_device(found.frames, balls, options_of(request, nullptr, monitor));
  found.invalid = balls.invalid();
  finish(found, request);
  if (request.per_atom) found.there = std::make_shared<const CudaMeasures>(std::move(there));
  return found;
}

py::object counts_of(const ExactUnion& exact, TopologyRequest wanted) {
  if (wanted == TopologyRequest::none || !exact.counts) return py::none();
  const UnionCounts& c = *exact.counts;
  return py::dict("components"_a = c.components, "euler_characteristic"_a = c.euler_characteristic,
                  "hidden_atoms"_a = c.hidden_spheres);
}

py::object topology_of(const std::shared_ptr<const ExactUnion>& exact, TopologyRequest wanted) {
  if (wanted != TopologyRequest::full || !exact->topology) return py::none();
  const UnionTopology& t = *exact->topology;
  py::list voids;
  for (const Void& v : t.void_table) {
    voids.append(py::dict("area"_a = v.area, "volume"_a = v.volume,
                          "center"_a = py::make_tuple(v.center.x, v.center.y, v.center.z),
                          "clearance"_a = v.clearance, "lining"_a = v.lining));
  }
  static_assert(sizeof(Shell) == 2 * sizeof(double));
  const auto* shells = reinterpret_cast<const double*>(t.shells.data());
  return py::dict("components"_a = t.components, "tunnels"_a = t.tunnels, "voids"_a = t.voids,
                  "euler_characteristic"_a = t.euler_characteristic,
                  "point_contacts"_a = t.point_contacts, "hidden_atoms"_a = t.hidden_spheres,
                  "shells"_a = array_of(exact, shells, t.shells.size(), 2),
                  "outer_area"_a = t.outer_area, "void_area"_a = t.void_area,
                  "void_volume"_a = t.void_volume, "void_table"_a = voids);
}

py::dict dict_of(ExactUnion&& result, TopologyRequest topology) {
  const auto exact = std::make_shared<const ExactUnion>(std::move(result));
  const auto& atoms = exact->per_sphere;
  py::object areas = py::none(), volumes = py::none();
  if (!atoms.empty()) {
    const std::size_t row = sizeof(SphereMeasures);
    areas = py::cast(array_of(exact, &atoms.data()->area, atoms.size(), 0, row));
    volumes = py::cast(array_of(exact, &atoms.data()->volume, atoms.size(), 0, row));
  }
  return py::dict("area"_a = exact->area, "volume"_a = exact->volume, "atom_area"_a = areas,
                  "atom_volume"_a = volumes, "counts"_a = counts_of(*exact, topology),
                  "topology"_a = topology_of(exact, topology), "method"_a = name_of(exact->method),
                  "check_area"_a = exact->check_area, "check_volume"_a = exact->check_volume,
                  "fallback_atoms"_a = exact->fallback_spheres);
}

py::object tuple_of(const std::optional<InvalidFrame>& invalid) {
  if (!invalid) return py::none();
  return py::make_tuple(invalid->frame(), invalid->atom(), std::string(invalid->what()));
}

py::tuple lists_of(Found&& found, TopologyRequest topology) {
  py::list measured, groups;
  for (ExactUnion& frame : found.frames) measured.append(dict_of(std::move(frame), topology));
  for (std::vector<double>& sums : found.groups) groups.append(array_of(std::move(sums)));
  return py::make_tuple(measured, groups, tuple_of(found.invalid));
}

// The measures of the frames of `coords` (T, N, 3), one dict for each, up to the first that cannot
// be measured; the areas by group; and None, or (frame, atom or None, reason).
py::tuple measure(const py::buffer& coords, const py::buffer& radii, const py::kwargs& given) {
  const Numbers frames(coords, "coords", 3), sizes(radii, "radii", 1);
  const MeasureCall request(given);
  Found found = call(request.threads, [&](Monitor& monitor) {
    return measure_all(frames, sizes, request, monitor);
  });
  return lists_of(std::move(found), request.exact.topology);
}

// The measures of one set and their derivatives in "gradient": rows of eight numbers (N, 8), and
// how many atoms may have none.
py::dict measure_gradient(const py::buffer& coords, const py::buffer& radii,
                          const py::object& area_weights, const py::object& volume_weights,
                          const py::kwargs& given) {
  const Numbers centers(coords, "coords", 2), sizes(radii, "radii", 1);
  const MeasureCall request(given);
  const std::vector<double> areas = numbers_of(area_weights, "weights"),
                            volumes = numbers_of(volume_weights, "weights");
  UnionGradients found = call(request.threads, [&](Monitor& monitor) {
    return union_gradients(spheres_of(centers, sizes, request.exact.probe),
                           {.area_weights = areas, .volume_weights = volumes, .monitor = &monitor});
  });
  ExactUnion measures{};
  measures.method = UnionMethod::arcs;
  measures.area = found.area;
  measures.volume = found.volume;
  measures.per_sphere = std::move(found.per_sphere);
  measures.fallback_spheres = found.fallback_spheres;
  py::dict result = dict_of(std::move(measures), TopologyRequest::none);
  const auto rows = std::make_shared<const std::vector<BallGradient>>(std::move(found.gradients));
  static_assert(sizeof(BallGradient) == 8 * sizeof(double));
  result["gradient"] =
      py::make_tuple(array_of(rows, reinterpret_cast<const double*>(rows->data()), rows->size(), 8),
                     found.kink_spheres);
  return result;
}

// The areas and the volumes of all frames, where they are wanted.
py::object columns_there(const Found& found, std::size_t atoms) {
  if (!found.there) return py::none();
  return measures_there(found.there, {found.frames.size(), atoms});
}

// The same for coordinates in device memory; and the areas and volumes of the atoms there, or None.
py::tuple measure_frames_there(const py::tuple& coords, const py::object& radii,
                               const py::kwargs& given) {
  const MeasureCall request(given);
  if (!suits_device(request)) {
    throw BackendUnavailable(
        "coords: are on a CUDA device, which measures areas and volumes by arcs; for topology and "
        "the other methods copy them to the host");
  }
  const DeviceFrames balls = frames_of(coords, radii, request.unit, request.exact.probe);
  Found found = call(request.threads,
                     [&](Monitor& monitor) { return measure_there(balls, request, monitor); });
  py::object there = columns_there(found, balls.atoms());
  return py::tuple(lists_of(std::move(found), request.exact.topology) + py::make_tuple(there));
}

// The measures of frames in device memory and their derivatives, which are left there: the result
// of measure_on_device, and by centres and radii the derivatives of area and of volume, and how
// many atoms of each frame may have none.
py::tuple gradient_there(const py::tuple& coords, const py::object& radii,
                         const py::object& area_weights, const py::object& volume_weights,
                         const py::kwargs& given) {
  const MeasureCall request(given);
  const DeviceFrames balls = frames_of(coords, radii, request.unit, request.exact.probe);
  const DeviceWeights weights(coords, area_weights, volume_weights, balls.atoms());
  std::vector<std::uint64_t> kinks;
  Found found = call(request.threads, [&](Monitor& monitor) {
    Found some;
    some.there = std::make_shared<const CudaMeasures>(gradients_on_device(
        some.frames, kinks, balls, weights.batch(), options_of(request, nullptr, monitor)));
    some.invalid = balls.invalid();
    return some;
  });
  const std::size_t frames = found.frames.size();
  const py::object there = columns_there(found, balls.atoms());
  py::object slopes = py::none();
  if (frames > 0) {
    slopes = slopes_there(found.there, {frames, balls.atoms()}, std::move(kinks));
  }
  return py::tuple(lists_of(std::move(found), TopologyRequest::none) +
                   py::make_tuple(there, slopes));
}

}  // namespace

void bind_measures(py::module_& module) {
  module.def("measure", &measure);
  module.def("measure_gradient", &measure_gradient);
  module.def("measure_on_device", &measure_frames_there);
  module.def("gradient_on_device", &gradient_there);
}

}  // namespace vdwmesh::python

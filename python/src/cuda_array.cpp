// Describes arrays in device memory to Python and reads descriptions of callers' arrays
// (cuda_array.hpp). A capsule of DLPack owns its array until a consumer has taken it over.
#include "cuda_array.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cmath>
#include <utility>

#include "core/errors.hpp"
#include "dlpack.hpp"
#include "topics.hpp"

namespace vdwmesh::python {
namespace {

using namespace py::literals;

// Formats are those of float, double and std::uint32_t: f, d and I.
bool is_floating(const CudaArray& a) { return a.array.format != "I"; }

std::string type_string(const CudaArray& a) {
  return fmt::format("<{}{}", is_floating(a) ? 'f' : 'u', a.array.item_bytes);
}

std::size_t element_count(const CudaArray& a) {
  std::size_t count = 1;
  for (const py::ssize_t n : a.array.shape) count *= static_cast<std::size_t>(n);
  return count;
}

bool is_without_gaps(const CudaArray& a) {
  py::ssize_t step = a.array.item_bytes;
  for (std::size_t i = a.array.shape.size(); i-- > 0; step *= a.array.shape[i]) {
    if (a.array.strides[i] != step) return false;
  }
  return true;
}

py::dict interface_of(const CudaArray& a) {
  const auto address = element_count(a) > 0 ? reinterpret_cast<std::uintptr_t>(a.array.data) : 0;
  py::object strides = py::none();
  if (!is_without_gaps(a)) strides = py::tuple(py::cast(a.array.strides));
  constexpr bool kReadOnly = false;  // PyTorch takes no read-only arrays
  return py::dict("shape"_a = py::tuple(py::cast(a.array.shape)), "typestr"_a = type_string(a),
                  "data"_a = py::make_tuple(address, kReadOnly), "version"_a = 3,
                  "strides"_a = strides, "stream"_a = py::none());
}

py::tuple device_tuple(const CudaArray& a) { return py::make_tuple(dlpack::kCuda, a.device); }

// A tensor with all that it points to.
struct OwnedTensor {
  explicit OwnedTensor(const CudaArray& a)
      : array(a), shape(a.array.shape.begin(), a.array.shape.end()) {
    for (const py::ssize_t bytes : a.array.strides) strides.push_back(bytes / a.array.item_bytes);
    const std::uint8_t code = is_floating(a) ? dlpack::kFloatingPoint : dlpack::kUnsigned;
    const auto bits = static_cast<std::uint8_t>(8 * a.array.item_bytes);
    managed.tensor = {.data = const_cast<void*>(a.array.data),
                      .device = {dlpack::kCuda, a.device},
                      .dimensions = static_cast<std::int32_t>(shape.size()),
                      .type = {.code = code, .bits = bits, .lanes = 1},
                      .shape = shape.data(),
                      .strides = strides.data(),
                      .byte_offset = 0};
    managed.context = this;
    managed.deleter = [](dlpack::ManagedTensor* t) {
      delete static_cast<OwnedTensor*>(t->context);
    };
  }
  OwnedTensor(const OwnedTensor&) = delete;
  OwnedTensor& operator=(const OwnedTensor&) = delete;

  CudaArray array;
  std::vector<std::int64_t> shape, strides;
  dlpack::ManagedTensor managed{};
};

constexpr const char* kNewCapsule = "dltensor";  // a consumer renames the capsule that it takes

void free_unused(PyObject* capsule) {
  if (PyCapsule_IsValid(capsule, kNewCapsule) == 0) return;
  auto* const managed =
      static_cast<dlpack::ManagedTensor*>(PyCapsule_GetPointer(capsule, kNewCapsule));
  managed->deleter(managed);
}

// The values are there already, whichever stream the consumer names, and every consumer takes a
// capsule without a version (dlpack.hpp).
py::object capsule_of(const CudaArray& a, const py::object& /*stream*/,
                      const py::object& /*max_version*/, const py::object& device,
                      const py::object& copy) {
  if (!device.is_none() && !py::tuple(device).equal(device_tuple(a))) {
    throw py::buffer_error("the array lies on another device than dl_device");
  }
  if (!copy.is_none() && copy.cast<bool>()) throw py::buffer_error("the array is not copied");
  auto owned = std::make_unique<OwnedTensor>(a);
  PyObject* const capsule = PyCapsule_New(&owned->managed, kNewCapsule, &free_unused);
  if (capsule == nullptr) throw py::error_already_set();
  owned.release();
  return py::reinterpret_steal<py::object>(capsule);
}

// Bytes from the first element to the end of the last one.
std::size_t extent_of(const CudaArray& a) {
  if (element_count(a) == 0) return 0;
  py::ssize_t last = 0;
  for (std::size_t i = 0; i < a.array.shape.size(); ++i) {
    last += (a.array.shape[i] - 1) * a.array.strides[i];
  }
  return static_cast<std::size_t>(last + a.array.item_bytes);
}

// A copy on the host with the same strides.
Array downloaded(const CudaArray& a) {
  auto bytes = std::make_shared<std::vector<std::byte>>(extent_of(a));
  {
    const py::gil_scoped_release free;
    copy_to_host(bytes->data(), a.array.data, bytes->size(), a.device);
  }
  Array copy = a.array;
  copy.data = bytes->data();
  copy.owner = std::move(bytes);
  return copy;
}

// Row k of an array of several dimensions, without a copy. Precondition: there is such a row. The
// Python layer asks for rows of frames that were measured only.
CudaArray row_of(const CudaArray& a, std::size_t k) {
  CudaArray row = a;
  const auto step = static_cast<std::ptrdiff_t>(k) * a.array.strides.at(0);
  row.array.data = static_cast<const std::byte*>(a.array.data) + step;
  row.array.shape.erase(row.array.shape.begin());
  row.array.strides.erase(row.array.strides.begin());
  return row;
}

// Numbers of rows that lie `row_bytes` apart, `columns` of each (0: one). No values if a size is 0.
py::object array_there(const std::shared_ptr<const CudaMeasures>& there, const double* first,
                       std::size_t row_bytes, const std::vector<std::size_t>& shape,
                       std::size_t columns = 0) {
  CudaArray found{array_of(there, first, shape.back(), columns, row_bytes), there->device()};
  Array& array = found.array;
  for (std::size_t i = shape.size() - 1; i-- > 0;) {
    const py::ssize_t step = array.strides.front() * array.shape.front();
    array.strides.insert(array.strides.begin(), step);
    array.shape.insert(array.shape.begin(), static_cast<py::ssize_t>(shape[i]));
  }
  return py::cast(std::move(found));
}

void wait_without_gil(int device, std::uintptr_t stream) {
  const py::gil_scoped_release free;
  wait_for_stream(device, stream);
}

FrameCoordinates coordinates_of(const CudaInput& coords, double unit) {
  return {.first = coords.first,
          .type = coords.type,
          .frames = coords.shape.at(0),
          .atoms = coords.shape.at(1),
          .frame_stride = coords.strides.at(0),
          .atom_stride = coords.strides.at(1),
          .axis_stride = coords.strides.at(2),
          .unit = unit};
}

void require_one_each(std::size_t radii, std::size_t atoms) {
  if (radii == atoms) return;
  throw InvalidInput(
      fmt::format("radii: has {} radii for {} atoms; each atom needs one", radii, atoms));
}

DeviceFrames frames_with_device_radii(const CudaInput& coords, const CudaInput& radii, double unit,
                                      double probe) {
  require_one_each(radii.shape.at(0), coords.shape.at(1));
  if (radii.device != coords.device) {
    throw InvalidInput(fmt::format("radii: are on CUDA device {}, coords on device {}",
                                   radii.device, coords.device));
  }
  const py::gil_scoped_release free;
  return DeviceFrames(coords.device, coordinates_of(coords, unit), radii.column(), probe);
}

}  // namespace

// `described` has address, is_float32, shape, strides in bytes, and stream or None.
CudaInput::CudaInput(const py::tuple& described, const char* name)
    : first(reinterpret_cast<const std::byte*>(described[0].cast<std::uintptr_t>())),
      type(described[1].cast<bool>() ? CoordinateType::float32 : CoordinateType::float64),
      shape(described[2].cast<std::vector<std::size_t>>()),
      strides(described[3].cast<std::vector<py::ssize_t>>()),
      device(device_of(first, name)) {
  const auto stream = described[4].cast<std::optional<std::uintptr_t>>();
  if (stream) wait_without_gil(device, *stream);
}

DeviceFrames frames_of(const py::tuple& coords, const py::object& radii, double unit,
                       double probe) {
  if (!std::isfinite(probe)) throw InvalidInput(fmt::format("probe: {} is not finite", probe));
  const CudaInput centers(coords, "coords");
  if (py::isinstance<py::tuple>(radii)) {  // radii on the host are no tuple, but an array
    return frames_with_device_radii(centers, CudaInput(radii, "radii"), unit, probe);
  }
  const std::vector<double> sizes = numbers_of(radii, "radii");
  require_one_each(sizes.size(), centers.shape.at(1));
  const py::gil_scoped_release free;
  return DeviceFrames(centers.device, coordinates_of(centers, unit), sizes, probe);
}

void require_valid(const DeviceFrames& balls) {
  if (!balls.invalid()) return;
  const InvalidFrame& error = *balls.invalid();
  const std::string place = error.atom() ? fmt::format("coords[{}]", *error.atom()) : "coords";
  throw InvalidInput(fmt::format("{}: {}", place, error.what()));
}

DeviceWeights::DeviceWeights(const py::tuple& coords, const py::object& area,
                             const py::object& volume, std::size_t atoms) {
  const int device = CudaInput(coords, "coords").device;
  const auto weights_at = [&](const py::object& given) -> const double* {
    if (given.is_none()) return nullptr;
    const CudaInput weights(given, "weights");
    if (weights.device != device) {
      throw InvalidInput(fmt::format("weights: are on CUDA device {}, coords on device {}",
                                     weights.device, device));
    }
    const bool dense = weights.strides.at(0) == py::ssize_t{sizeof(double)} || atoms == 1;
    if (weights.type != CoordinateType::float64 || !dense) {
      throw InvalidInput("weights: on a device they are float64 without gaps");
    }
    if (weights.shape.at(0) != atoms) {
      throw InvalidInput(fmt::format("weights: has {} numbers for {} atoms of coords",
                                     weights.shape.at(0), atoms));
    }
    return reinterpret_cast<const double*>(weights.first);
  };
  batch_ = {.area = weights_at(area), .volume = weights_at(volume)};
}

py::tuple measures_there(const std::shared_ptr<const CudaMeasures>& there,
                         const std::vector<std::size_t>& shape) {
  const SphereMeasures* const rows = there->rows();
  const auto column = [&](double SphereMeasures::*measure) {
    const double* const first = rows != nullptr ? &(rows->*measure) : nullptr;
    return array_there(there, first, sizeof(SphereMeasures), shape);
  };
  return py::make_tuple(column(&SphereMeasures::area), column(&SphereMeasures::volume));
}

py::tuple slopes_there(const std::shared_ptr<const CudaMeasures>& there,
                       const std::vector<std::size_t>& shape, std::vector<std::uint64_t> kinks) {
  const auto column = [&](const double& first, std::size_t columns) {
    return array_there(there, &first, sizeof(BallGradient), shape, columns);
  };
  const BallGradient& row = *there->gradients();
  return py::make_tuple(column(row.area_center.x, 3), column(row.area_radius, 0),
                        column(row.volume_center.x, 3), column(row.volume_radius, 0),
                        std::move(kinks));
}

void bind_cuda_arrays(py::module_& module) {
  py::class_<CudaArray>(module, "CudaArray")
      .def_property_readonly("__cuda_array_interface__", &interface_of)
      .def("__dlpack__", &capsule_of, py::kw_only(), "stream"_a = py::none(),
           "max_version"_a = py::none(), "dl_device"_a = py::none(), "copy"_a = py::none())
      .def("__dlpack_device__", &device_tuple)
      .def_property_readonly("shape",
                             [](const CudaArray& a) { return py::tuple(py::cast(a.array.shape)); })
      .def("row", &row_of)
      .def("download", &downloaded);
}

}  // namespace vdwmesh::python

// Arrays in the memory of a CUDA device, as Python sees them: both ways by the CUDA Array Interface
// (version 3), and out by DLPack as well. Nothing here calls CUDA.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "arrays.hpp"
#include "cuda/on_device.hpp"

namespace vdwmesh::python {

// An array of the library's in device memory, which it keeps alive. Its values are there: calls
// return when the device is done, so a consumer need not wait for any stream.
struct CudaArray {
  Array array;  // as for host memory; only the address is the device's
  int device = 0;
};

// An array of a caller, from the tuple (address, is_float32, shape, strides in bytes, stream or
// None) that the Python layer has read from the interface and checked. Offers no values.
struct CudaInput {
  // Throws InvalidInput that names the argument for an address that is not of a device, and
  // BackendUnavailable if no device can be used. Waits for the stream, if there is one, without the
  // GIL: on the caller's thread, whose default stream it may be.
  CudaInput(const py::tuple& described, const char* name);

  DeviceNumbers column() const { return {first, type, strides.at(0)}; }

  const std::byte* first = nullptr;
  CoordinateType type = CoordinateType::float64;
  std::vector<std::size_t> shape;
  std::vector<py::ssize_t> strides;
  int device = 0;
};

// The balls of coordinates (T, N, 3), in units of `unit` Å, and radii (N,), which are a CudaInput's
// tuple or an array on the host. Throws InvalidInput as spheres_of() does; InvalidFrame of a frame
// is left to the caller. Needs the GIL, which it frees while the device works.
DeviceFrames frames_of(const py::tuple& coords, const py::object& radii, double unit, double probe);

// Throws InvalidInput that names the atom if the first frame is invalid.
void require_valid(const DeviceFrames& balls);

// Weights of atoms that lie where their coordinates do; None stands for weights of 1.
class DeviceWeights {
 public:
  // Throws InvalidInput for weights on another device, of another type, with gaps, or not one for
  // each atom.
  DeviceWeights(const py::tuple& coords, const py::object& area, const py::object& volume,
                std::size_t atoms);
  const BatchWeights& batch() const { return batch_; }

 private:
  BatchWeights batch_;
};

// Measures of atoms (Å², Å³) and derivatives of their sums, as arrays of this shape, in C order,
// whose memory `there` keeps alive. slopes_there() has those of the area by centres and radii,
// those of the volume, and `kinks` (UnionGradients).
py::tuple measures_there(const std::shared_ptr<const CudaMeasures>& there,
                         const std::vector<std::size_t>& shape);
py::tuple slopes_there(const std::shared_ptr<const CudaMeasures>& there,
                       const std::vector<std::size_t>& shape, std::vector<std::uint64_t> kinks);

}  // namespace vdwmesh::python

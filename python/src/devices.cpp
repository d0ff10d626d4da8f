// Checks the argument `device`; what it means is decided by cuda/backend.hpp, as for the program.
#include "devices.hpp"

#include <fmt/format.h>

#include "core/errors.hpp"
#include "topics.hpp"

namespace vdwmesh::python {

Backend backend_of(const std::string& device) {
  if (device == "auto") return Backend::automatic;
  if (device == "cpu") return Backend::cpu;
  if (device == "cuda") return resolve(Backend::cuda);
  throw InvalidInput(fmt::format("device: {}; there are auto, cpu and cuda", device));
}

void require_cpu(const std::string& device) {
  if (backend_of(device) != Backend::cuda) return;
  throw BackendUnavailable("device: this is computed on the CPU alone; leave device to auto");
}

void bind_devices(pybind11::module_& module) { module.def("require_cpu", &require_cpu); }

}  // namespace vdwmesh::python

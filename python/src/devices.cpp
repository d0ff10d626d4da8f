// Checks the argument `device`; what it means is decided by cuda/backend.hpp, as for the program.
#include "devices.hpp"

#include <fmt/format.h>

#include "core/errors.hpp"

namespace vdwmesh::python {

Backend backend_of(const std::string& device) {
  if (device == "auto") return Backend::automatic;
  if (device == "cpu") return Backend::cpu;
  if (device == "cuda") return resolve(Backend::cuda);
  throw InvalidInput(fmt::format("device: {}; there are auto, cpu and cuda", device));
}

}  // namespace vdwmesh::python

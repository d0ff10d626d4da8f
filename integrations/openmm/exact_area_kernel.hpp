// CalcExactAreaForceKernel: what a platform of OpenMM computes for an ExactAreaForce.
//
// The platforms Reference and CPU have one here, which keeps positions and forces in the host's
// memory. For another platform, such as CUDA, derive from the class and register a
// KernelFactory under its Name() there; gradients_on_device() differentiates balls that lie on a
// device. ExactAreaForce itself needs no change for that.
#pragma once

#include <openmm/KernelImpl.h>
#include <openmm/internal/ContextImpl.h>

#include <string>

#include "exact_area_force.hpp"

namespace vdwmesh {

class CalcExactAreaForceKernel : public OpenMM::KernelImpl {
 public:
  static std::string Name() { return "CalcExactAreaForce"; }
  using KernelImpl::KernelImpl;

  // Takes the parameters of a Force that has been checked; also after they have changed.
  virtual void setParameters(const ExactAreaForce& force) = 0;
  // Adds forces (kJ/mol/nm) to those of the context if asked to. Returns the energy, kJ/mol.
  virtual double execute(OpenMM::ContextImpl& context, bool includeForces) = 0;
};

// Registers the kernel with all platforms that keep positions in the host's memory, unless they
// have it. Platforms may be loaded between calls.
void register_exact_area_kernels();

}  // namespace vdwmesh

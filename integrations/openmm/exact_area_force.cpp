// ExactAreaForce, its part in a Context, and its form in XML. What it computes is in the kernel, of
// which each platform has its own.
#include "exact_area_force.hpp"

#include <openmm/Kernel.h>
#include <openmm/OpenMMException.h>
#include <openmm/Platform.h>
#include <openmm/System.h>
#include <openmm/internal/ForceImpl.h>
#include <openmm/serialization/SerializationNode.h>
#include <openmm/serialization/SerializationProxy.h>

#include <cmath>
#include <memory>
#include <string>

#include "exact_area_kernel.hpp"

namespace vdwmesh {
namespace {

using OpenMM::ContextImpl;
using OpenMM::SerializationNode;

[[noreturn]] void refuse(const std::string& reason) {
  throw OpenMM::OpenMMException("ExactAreaForce: " + reason);
}

class ExactAreaForceImpl final : public OpenMM::ForceImpl {
 public:
  explicit ExactAreaForceImpl(const ExactAreaForce& owner) : owner_(owner) {
    register_exact_area_kernels();
  }

  void initialize(ContextImpl& context) override {
    owner_.check(context.getSystem());
    kernel_ = context.getPlatform().createKernel(CalcExactAreaForceKernel::Name(), context);
    kernel_.getAs<CalcExactAreaForceKernel>().setParameters(owner_);
  }
  const OpenMM::Force& getOwner() const override { return owner_; }
  void updateContextState(ContextImpl&, bool&) override {}
  double calcForcesAndEnergy(ContextImpl& context, bool includeForces, bool includeEnergy,
                             int groups) override {
    if ((groups & (1 << owner_.getForceGroup())) == 0) return 0;
    const double energy = kernel_.getAs<CalcExactAreaForceKernel>().execute(context, includeForces);
    return includeEnergy ? energy : 0;
  }
  std::map<std::string, double> getDefaultParameters() override { return {}; }
  std::vector<std::string> getKernelNames() override { return {CalcExactAreaForceKernel::Name()}; }

  void update(ContextImpl& context) {
    owner_.check(context.getSystem());
    kernel_.getAs<CalcExactAreaForceKernel>().setParameters(owner_);
    context.systemChanged();
  }

 private:
  const ExactAreaForce& owner_;
  OpenMM::Kernel kernel_;
};

class ExactAreaForceProxy final : public OpenMM::SerializationProxy {
 public:
  ExactAreaForceProxy() : SerializationProxy("ExactAreaForce") {
    registerProxy(typeid(ExactAreaForce), this);
  }

  void serialize(const void* object, SerializationNode& node) const override {
    const auto& force = *static_cast<const ExactAreaForce*>(object);
    node.setIntProperty("version", 1);
    node.setIntProperty("forceGroup", force.getForceGroup());
    node.setStringProperty("name", force.getName());
    node.setDoubleProperty("probeRadius", force.getProbeRadius());
    node.setDoubleProperty("pressure", force.getPressure());
    node.setIntProperty("periodicMethod", force.getPeriodicMethod());
    SerializationNode& particles = node.createChildNode("Particles");
    for (int i = 0; i < force.getNumParticles(); ++i) {
      SerializationNode& particle = particles.createChildNode("Particle");
      if (!force.hasBall(i)) continue;
      double radius = 0, tension = 0;
      force.getParticleParameters(i, radius, tension);
      particle.setDoubleProperty("radius", radius).setDoubleProperty("surfaceTension", tension);
    }
  }

  void* deserialize(const SerializationNode& node) const override {
    if (node.getIntProperty("version") != 1) refuse("unknown version of its XML");
    auto force = std::make_unique<ExactAreaForce>();
    force->setForceGroup(node.getIntProperty("forceGroup", 0));
    force->setName(node.getStringProperty("name", force->getName()));
    force->setProbeRadius(node.getDoubleProperty("probeRadius"));
    force->setPressure(node.getDoubleProperty("pressure"));
    const int method = node.getIntProperty("periodicMethod");
    if (method != ExactAreaForce::RefusePeriodic && method != ExactAreaForce::IgnoreImages) {
      refuse("there is no periodicMethod " + std::to_string(method));
    }
    force->setPeriodicMethod(static_cast<ExactAreaForce::PeriodicMethod>(method));
    for (const SerializationNode& particle : node.getChildNode("Particles").getChildren()) {
      if (!particle.hasProperty("radius")) {
        force->addParticleWithoutBall();
        continue;
      }
      force->addParticle(particle.getDoubleProperty("radius"),
                         particle.getDoubleProperty("surfaceTension"));
    }
    return force.release();
  }
};

// Lives as long as OpenMM's list of proxies.
const auto& kProxy = *new ExactAreaForceProxy;

}  // namespace

int ExactAreaForce::addParticle(double radius, double surfaceTension) {
  particles_.push_back({radius, surfaceTension, true});
  return getNumParticles() - 1;
}

int ExactAreaForce::addParticleWithoutBall() {
  particles_.push_back({0, 0, false});
  return getNumParticles() - 1;
}

std::size_t ExactAreaForce::checked(int index) const {
  if (index >= 0 && index < getNumParticles()) return static_cast<std::size_t>(index);
  refuse("there is no particle " + std::to_string(index) + " of " +
         std::to_string(getNumParticles()));
}

void ExactAreaForce::getParticleParameters(int index, double& radius,
                                           double& surfaceTension) const {
  const ParticleBall& ball = particles_[checked(index)];
  radius = ball.radius;
  surfaceTension = ball.surface_tension;
}

void ExactAreaForce::setParticleParameters(int index, double radius, double surfaceTension) {
  particles_[checked(index)] = {radius, surfaceTension, true};
}

void ExactAreaForce::check(const OpenMM::System& system) const {
  if (system.getNumParticles() != getNumParticles()) {
    refuse("has " + std::to_string(getNumParticles()) + " particles, but the System has " +
           std::to_string(system.getNumParticles()));
  }
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const ParticleBall& ball = particles_[i];
    if (!ball.has_ball) continue;
    const std::string which = "particle " + std::to_string(i) + " has ";
    if (!(ball.radius > 0 && std::isfinite(ball.radius))) {
      refuse(which + "the radius " + std::to_string(ball.radius) +
             "; it must be above 0 nm, or the particle added by addParticleWithoutBall()");
    }
    if (!std::isfinite(ball.surface_tension))
      refuse(which + "a surface tension that is not finite");
  }
  if (!(probe_radius_ >= 0 && std::isfinite(probe_radius_))) {
    refuse("the probe has the radius " + std::to_string(probe_radius_) +
           "; it must be 0 nm or more");
  }
  if (!std::isfinite(pressure_)) refuse("the pressure is not finite");
  if (periodic_method_ != IgnoreImages && system.usesPeriodicBoundaryConditions()) {
    refuse(
        "the System is periodic, but images of particles bury nothing; if all molecules are whole, "
        "say so by setPeriodicMethod(IgnoreImages)");
  }
}

void ExactAreaForce::updateParametersInContext(OpenMM::Context& context) {
  dynamic_cast<ExactAreaForceImpl&>(getImplInContext(context)).update(getContextImpl(context));
}

OpenMM::ForceImpl* ExactAreaForce::createImpl() const { return new ExactAreaForceImpl(*this); }

}  // namespace vdwmesh

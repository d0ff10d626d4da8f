// ExactAreaForce: the exact surface area and volume of a union of balls as a Force of OpenMM.
//
//   E = Σ γ_i A_i + P V        A_i: exposed area of the ball of particle i, V: volume of the union
//
// A ball has the radius of its particle plus that of the probe, so with a probe of 0.14 nm A_i is
// the solvent-accessible area. Forces are the exact derivatives of `measures/union_gradients.hpp`,
// without a cutoff, and do not depend on the number of threads. The interface is in OpenMM's style
// and units: nm, kJ/mol, kJ/mol/nm² for γ, and kJ/mol/nm³ for P (1 bar is 0.0602214076 kJ/mol/nm³).
//
// Parameters are checked when a Context is created or updated, the index of a particle at once.
// What is wrong throws an OpenMM::OpenMMException of one line.
#pragma once

#include <openmm/Context.h>
#include <openmm/Force.h>

#include <cstddef>
#include <vector>

namespace vdwmesh {

class ExactAreaForce : public OpenMM::Force {
 public:
  // What happens in a System that other forces make periodic. Images of particles never bury each
  // other here.
  enum PeriodicMethod {
    RefusePeriodic = 0,  // no Context is created
    IgnoreImages = 1,    // balls lie where the coordinates are; molecules must be whole
  };

  // Gives the next particle of the System its ball, of any positive radius (nm). γ, the surface
  // tension (kJ/mol/nm²), may have any sign. Returns the number of the particle.
  int addParticle(double radius, double surfaceTension);
  // The next particle has no ball: it has no area and buries nothing. So it is with solvent, or
  // with hydrogens where radii are those of united atoms. Returns the number of the particle.
  int addParticleWithoutBall();
  int getNumParticles() const { return static_cast<int>(particles_.size()); }
  bool hasBall(int index) const { return particles_[checked(index)].has_ball; }
  // For a particle without a ball both are 0.
  void getParticleParameters(int index, double& radius, double& surfaceTension) const;
  // Also gives a ball to a particle that had none.
  void setParticleParameters(int index, double radius, double surfaceTension);

  // At least 0; 0 by default.
  double getProbeRadius() const { return probe_radius_; }
  void setProbeRadius(double radius) { probe_radius_ = radius; }

  // Of any sign; 0 by default.
  double getPressure() const { return pressure_; }
  void setPressure(double pressure) { pressure_ = pressure; }

  // RefusePeriodic by default.
  PeriodicMethod getPeriodicMethod() const { return periodic_method_; }
  void setPeriodicMethod(PeriodicMethod method) { periodic_method_ = method; }
  // False: the balls have no images.
  bool usesPeriodicBoundaryConditions() const override { return false; }

  // Copies all parameters to a Context that was created with this Force: of particles, of the
  // probe, and the pressure. They are checked as when a Context is created.
  void updateParametersInContext(OpenMM::Context& context);

  // Throws unless a Context of the System can be created with this Force.
  void check(const OpenMM::System& system) const;

 protected:
  OpenMM::ForceImpl* createImpl() const override;

 private:
  struct ParticleBall {
    double radius, surface_tension;  // nm, kJ/mol/nm²
    bool has_ball;
  };

  std::size_t checked(int index) const;

  std::vector<ParticleBall> particles_;
  double probe_radius_ = 0, pressure_ = 0;
  PeriodicMethod periodic_method_ = RefusePeriodic;
};

}  // namespace vdwmesh

// The kernel of the platforms Reference and CPU: union_gradients() with γ as the weights of areas
// and the pressure as that of volumes, between OpenMM's units and Å.
#include "exact_area_kernel.hpp"

#include <openmm/KernelFactory.h>
#include <openmm/OpenMMException.h>
#include <openmm/Platform.h>
#include <openmm/reference/ReferencePlatform.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/errors.hpp"
#include "core/sum.hpp"
#include "core/workspace.hpp"
#include "measures/union_gradients.hpp"

namespace vdwmesh {
namespace {

using OpenMM::ContextImpl;
using OpenMM::Platform;
using OpenMM::ReferencePlatform;
using OpenMM::Vec3;

constexpr double kAngstrom = 0.1;  // nm

// As many threads as the platform's own forces use, of those that there are.
int threads_of(const Platform& platform, ContextImpl& context) {
  if (platform.getName() != "CPU") return 1;
  const int asked = std::stoi(platform.getPropertyValue(context.getOwner(), "Threads"));
  return std::clamp(asked, 1, tbb::info::default_concurrency());
}

class HostExactAreaKernel final : public CalcExactAreaForceKernel {
 public:
  HostExactAreaKernel(const std::string& name, const Platform& platform, ContextImpl& context)
      : CalcExactAreaForceKernel(name, platform), arena_(threads_of(platform, context)) {}

  void setParameters(const ExactAreaForce& force) override {
    particles_.clear();
    balls_.clear();
    tensions_.clear();
    for (int i = 0; i < force.getNumParticles(); ++i) {
      if (!force.hasBall(i)) continue;
      double radius = 0, tension = 0;
      force.getParticleParameters(i, radius, tension);
      particles_.push_back(static_cast<std::size_t>(i));
      balls_.push_back({{}, (radius + force.getProbeRadius()) / kAngstrom});
      tensions_.push_back(tension);
    }
    pressures_.assign(balls_.size(), force.getPressure());
  }

  double execute(ContextImpl& context, bool includeForces) override {
    if (balls_.empty()) return 0;
    auto& data = *static_cast<ReferencePlatform::PlatformData*>(context.getPlatformData());
    place_balls(*data.positions);
    measure();
    if (includeForces) add_forces(*data.forces);
    return energy();
  }

 private:
  void place_balls(const std::vector<Vec3>& positions) {
    for (std::size_t k = 0; k < balls_.size(); ++k) {
      const Vec3 place = positions[particles_[k]] / kAngstrom;
      if (!std::isfinite(place[0]) || !std::isfinite(place[1]) || !std::isfinite(place[2])) {
        throw OpenMM::OpenMMException("ExactAreaForce: particle " + std::to_string(particles_[k]) +
                                      " has a coordinate that is not finite");
      }
      balls_[k].center = {place[0], place[1], place[2]};
    }
  }

  void measure() try {
    const SphereSet spheres = SphereSet::view(balls_);
    arena_.execute([&] {
      union_gradients_into(
          result_, spheres,
          {.area_weights = tensions_, .volume_weights = pressures_, .workspace = &workspace_});
    });
  } catch (const Error& error) {
    throw OpenMM::OpenMMException(std::string("ExactAreaForce: ") + error.what());
  }

  void add_forces(std::vector<Vec3>& forces) const {
    for (std::size_t k = 0; k < balls_.size(); ++k) {
      const BallGradient& g = result_.gradients[k];
      const Vec3d slope = kAngstrom * g.area_center + (kAngstrom * kAngstrom) * g.volume_center;
      forces[particles_[k]] -= Vec3(slope.x, slope.y, slope.z);
    }
  }

  double energy() const {
    WideSum areas;  // kJ/mol/nm² times Å²
    for (std::size_t k = 0; k < balls_.size(); ++k) {
      areas.add(tensions_[k] * result_.per_sphere[k].area);
    }
    const double volumes = pressures_.front() * result_.volume;
    return kAngstrom * kAngstrom * (areas.value() + kAngstrom * volumes);
  }

  tbb::task_arena arena_;
  std::vector<std::size_t> particles_;  // those that have a ball
  std::vector<Sphere> balls_;           // theirs, Å
  std::vector<double> tensions_, pressures_;
  UnionGradients result_{};
  Workspace workspace_;
};

class HostKernelFactory final : public OpenMM::KernelFactory {
 public:
  OpenMM::KernelImpl* createKernelImpl(std::string name, const Platform& platform,
                                       ContextImpl& context) const override {
    return new HostExactAreaKernel(name, platform, context);
  }
};

}  // namespace

void register_exact_area_kernels() {
  static std::mutex one_at_a_time;
  const std::scoped_lock lock(one_at_a_time);
  for (int i = 0; i < Platform::getNumPlatforms(); ++i) {
    Platform& platform = Platform::getPlatform(i);
    const bool has_it = platform.supportsKernels({CalcExactAreaForceKernel::Name()});
    if (has_it || dynamic_cast<ReferencePlatform*>(&platform) == nullptr) continue;
    platform.registerKernelFactory(CalcExactAreaForceKernel::Name(), new HostKernelFactory);
  }
}

}  // namespace vdwmesh

// OpenMM calls these where the library lies in its folder of plugins.
extern "C" void registerPlatforms() {}
extern "C" void registerKernelFactories() { vdwmesh::register_exact_area_kernels(); }

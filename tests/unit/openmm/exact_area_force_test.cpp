// ExactAreaForce on the platforms of OpenMM that run here: closed forms, differences of the energy,
// XML, changed parameters, and what it refuses.
#include "exact_area_force.hpp"

#include <OpenMM.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <sstream>

#include "core/vec3.hpp"
#include "support/dice.hpp"
#include "support/requirements.hpp"

namespace vdwmesh {
namespace {

using OpenMM::Platform;
using OpenMM::Vec3;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kPi = std::numbers::pi;
// Relative, for the dozen roundings of a closed form.
constexpr double kRounding = 1e-13;

// A System of free particles with an ExactAreaForce, and its Context on a platform.
struct Simulation {
  Simulation(ExactAreaForce* area, const std::string& platform,
             const std::map<std::string, std::string>& properties = {})
      : force(area) {
    system.addForce(area);
    for (int i = 0; i < area->getNumParticles(); ++i) system.addParticle(1);
    context = std::make_unique<OpenMM::Context>(system, integrator,
                                                Platform::getPlatformByName(platform), properties);
  }

  OpenMM::State state(const std::vector<Vec3>& positions) {
    context->setPositions(positions);
    return context->getState(OpenMM::State::Energy | OpenMM::State::Forces);
  }

  double energy(const std::vector<Vec3>& positions) {
    context->setPositions(positions);
    return context->getState(OpenMM::State::Energy).getPotentialEnergy();
  }

  OpenMM::System system;
  OpenMM::VerletIntegrator integrator{0.001};
  ExactAreaForce* force;
  std::unique_ptr<OpenMM::Context> context;
};

// Twelve balls in a heap, a third of them with a negative surface tension, one particle without a
// ball.
ExactAreaForce* heap_force() {
  testing::Dice dice(55);
  auto* force = new ExactAreaForce;
  for (int i = 0; i < 12; ++i) {
    force->addParticle(dice.real(0.1, 0.2), i % 3 == 0 ? -dice.real(1, 5) : dice.real(1, 5));
    if (i == 6) force->addParticleWithoutBall();
  }
  force->setProbeRadius(0.05);
  force->setPressure(20);
  return force;
}

std::vector<Vec3> heap_positions() {
  testing::Dice dice(7);
  std::vector<Vec3> positions(13);
  for (Vec3& p : positions) p = Vec3(dice.real(0, 0.5), dice.real(0, 0.5), dice.real(0, 0.5));
  return positions;
}

class ExactAreaForceOn : public ::testing::TestWithParam<const char*> {
 protected:
  static void SetUpTestSuite() {
    Platform::loadPluginsFromDirectory(Platform::getDefaultPluginsDirectory());
  }
  void SetUp() override {
    for (int i = 0; i < Platform::getNumPlatforms(); ++i) {
      if (Platform::getPlatform(i).getName() == GetParam()) return;
    }
    VDWMESH_MISSING("VDWMESH_REQUIRE_PACKAGES", "libopenmm-plugins is not installed");
  }
};

// Two balls of radii r and s: the exposed areas are 2 π r (r + h) and 2 π s (s + d − h), and the
// circle between them, of radius ρ, pushes with P π ρ².
TEST_P(ExactAreaForceOn, TwoBallsFollowTheClosedForm) {
  const double r = 0.3, s = 0.25, d = 0.4, gamma = 3, delta = -2, pressure = 50;
  auto* force = new ExactAreaForce;
  force->addParticle(r - 0.1, gamma);
  force->addParticle(s - 0.1, delta);
  force->setProbeRadius(0.1);
  force->setPressure(pressure);
  Simulation two(force, GetParam());
  const OpenMM::State state = two.state({Vec3(0, 0, 0), Vec3(0, d, 0)});
  const double h = (d * d + r * r - s * s) / (2 * d), rho2 = r * r - h * h;
  const auto cap = [](double radius, double height) {
    return kPi * height * height * (3 * radius - height) / 3;
  };
  const double volume = 4 * kPi / 3 * (r * r * r + s * s * s) - cap(r, r - h) - cap(s, s - (d - h));
  const double energy =
      gamma * 2 * kPi * r * (r + h) + delta * 2 * kPi * s * (s + d - h) + pressure * volume;
  EXPECT_NEAR(state.getPotentialEnergy(), energy, kRounding * std::abs(energy));
  const double slope = 2 * kPi * (gamma * r * (d - h) + delta * s * h) / d + pressure * kPi * rho2;
  EXPECT_NEAR(state.getForces()[1][1], -slope, kRounding * std::abs(slope) * 10);
  EXPECT_NEAR(state.getForces()[0][1], slope, kRounding * std::abs(slope) * 10);
  EXPECT_NEAR(state.getForces()[1][0], 0, 1e-12);
}

// Differences of the fourth order, whose error is far below the tolerance.
TEST_P(ExactAreaForceOn, ForcesAreDifferencesOfTheEnergy) {
  constexpr double kStep = 2e-5, kTolerance = 1e-7;  // nm; relative to 1 + the force
  Simulation heap(heap_force(), GetParam());
  std::vector<Vec3> positions = heap_positions();
  const std::vector<Vec3> forces = heap.state(positions).getForces();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const double place = positions[i][axis];
      const auto energy_at = [&](double steps) {
        positions[i][axis] = place + steps * kStep;
        return heap.energy(positions);
      };
      const double slope =
          (8 * (energy_at(1) - energy_at(-1)) - (energy_at(2) - energy_at(-2))) / (12 * kStep);
      positions[i][axis] = place;
      EXPECT_NEAR(forces[i][axis], -slope, kTolerance * (1 + std::abs(slope))) << i << " " << axis;
    }
  }
  EXPECT_EQ(forces[7], Vec3());
}

TEST_P(ExactAreaForceOn, AChangeOfParametersReachesTheContext) {
  auto* force = new ExactAreaForce;
  force->addParticle(0.2, 1);
  Simulation one(force, GetParam());
  const double unit = 4 * kPi;
  EXPECT_NEAR(one.energy({Vec3()}), unit * 0.04, kRounding);
  force->setParticleParameters(0, 0.3, -2);
  force->setProbeRadius(0.1);
  force->setPressure(3);
  EXPECT_NEAR(one.energy({Vec3()}), unit * 0.04, kRounding);
  force->updateParametersInContext(*one.context);
  EXPECT_NEAR(one.energy({Vec3()}), unit * (-2 * 0.16 + 0.064), kRounding);
  force->setParticleParameters(0, -0.3, 1);
  EXPECT_THROW(force->updateParametersInContext(*one.context), OpenMM::OpenMMException);
}

TEST_P(ExactAreaForceOn, IsLeftOutOfOtherForceGroups) {
  auto* force = new ExactAreaForce;
  force->addParticle(0.2, 1);
  force->setForceGroup(3);
  Simulation one(force, GetParam());
  one.context->setPositions({Vec3()});
  const auto in_groups = [&](int groups) {
    return one.context->getState(OpenMM::State::Energy, false, groups).getPotentialEnergy();
  };
  EXPECT_EQ(in_groups(1 << 2), 0);
  EXPECT_GT(in_groups(1 << 3), 0);
}

TEST_P(ExactAreaForceOn, OfParticlesWithoutBallsIsNothing) {
  auto* force = new ExactAreaForce;
  force->addParticleWithoutBall();
  Simulation none(force, GetParam());
  EXPECT_EQ(none.energy({Vec3(1, 2, 3)}), 0);
  force->setParticleParameters(0, 0.5, 1);
  force->updateParametersInContext(*none.context);
  EXPECT_NEAR(none.energy({Vec3(1, 2, 3)}), kPi, 10 * kRounding);
}

TEST_P(ExactAreaForceOn, NamesTheParticleThatLiesNowhere) {
  Simulation heap(heap_force(), GetParam());
  std::vector<Vec3> positions = heap_positions();
  positions[9][1] = HUGE_VAL;  // OpenMM itself names NaN on the platform CPU
  try {
    heap.energy(positions);
    FAIL() << "no exception";
  } catch (const OpenMM::OpenMMException& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("ExactAreaForce: particle 9 "), Not(HasSubstr("\n"))));
  }
}

INSTANTIATE_TEST_SUITE_P(Platforms, ExactAreaForceOn, ::testing::Values("Reference", "CPU"),
                         [](const auto& info) { return std::string(info.param); });

class ExactAreaForceOnThreads : public ExactAreaForceOn {};

// A thousand balls, so that there is work for all; the same bits.
TEST_P(ExactAreaForceOnThreads, GivesTheSameBits) {
  const auto energy_and_forces = [](const char* threads) {
    testing::Dice dice(3);
    auto* force = new ExactAreaForce;
    std::vector<Vec3> positions;
    for (int i = 0; i < 1000; ++i) {
      force->addParticle(dice.real(0.1, 0.2), dice.real(-1, 1));
      positions.emplace_back(dice.real(0, 2), dice.real(0, 2), dice.real(0, 2));
    }
    Simulation many(force, "CPU", {{"Threads", threads}});
    return many.state(positions);
  };
  const OpenMM::State one = energy_and_forces("1"), four = energy_and_forces("4");
  EXPECT_EQ(one.getPotentialEnergy(), four.getPotentialEnergy());
  EXPECT_EQ(one.getForces(), four.getForces());
}

INSTANTIATE_TEST_SUITE_P(Platforms, ExactAreaForceOnThreads, ::testing::Values("CPU"),
                         [](const auto& info) { return std::string(info.param); });

TEST(ExactAreaForce, SurvivesXml) {
  const std::unique_ptr<ExactAreaForce> force(heap_force());
  force->setForceGroup(4);
  force->setName("burial");
  force->setPeriodicMethod(ExactAreaForce::IgnoreImages);
  std::stringstream xml;
  OpenMM::XmlSerializer::serialize<OpenMM::Force>(force.get(), "Force", xml);
  const std::unique_ptr<OpenMM::Force> read(OpenMM::XmlSerializer::deserialize<OpenMM::Force>(xml));
  const auto& copy = dynamic_cast<ExactAreaForce&>(*read);
  EXPECT_EQ(copy.getForceGroup(), 4);
  EXPECT_EQ(copy.getName(), "burial");
  EXPECT_EQ(copy.getPeriodicMethod(), ExactAreaForce::IgnoreImages);
  EXPECT_EQ(copy.getProbeRadius(), 0.05);
  EXPECT_EQ(copy.getPressure(), 20);
  ASSERT_EQ(copy.getNumParticles(), 13);
  for (int i = 0; i < 13; ++i) {
    double radius = 0, tension = 0, expected_radius = 0, expected_tension = 0;
    copy.getParticleParameters(i, radius, tension);
    force->getParticleParameters(i, expected_radius, expected_tension);
    EXPECT_EQ(copy.hasBall(i), i != 7);
    EXPECT_EQ(radius, expected_radius);
    EXPECT_EQ(tension, expected_tension);
  }
}

// What the exception says, which is one line.
std::string refusal(const ExactAreaForce& force, const OpenMM::System& system) {
  try {
    force.check(system);
  } catch (const OpenMM::OpenMMException& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("ExactAreaForce: "), Not(HasSubstr("\n"))));
    return error.what();
  }
  return "none";
}

TEST(ExactAreaForce, RefusesWhatIsNoBall) {
  OpenMM::System system;
  system.addParticle(1);
  ExactAreaForce force;
  EXPECT_THAT(refusal(force, system), HasSubstr("has 0 particles, but the System has 1"));
  force.addParticle(0.1, 1);
  EXPECT_EQ(refusal(force, system), "none");
  for (const double radius : {0.0, -1.0, kNaN, HUGE_VAL}) {
    force.setParticleParameters(0, radius, 1);
    EXPECT_THAT(refusal(force, system), HasSubstr("particle 0 has the radius")) << radius;
  }
  force.setParticleParameters(0, 0.1, kNaN);
  EXPECT_THAT(refusal(force, system), HasSubstr("particle 0 has a surface tension"));
  force.setParticleParameters(0, 0.1, -1);
  for (const double probe : {-0.1, kNaN}) {
    force.setProbeRadius(probe);
    EXPECT_THAT(refusal(force, system), HasSubstr("the probe has the radius"));
  }
  force.setProbeRadius(0);
  force.setPressure(kNaN);
  EXPECT_THAT(refusal(force, system), HasSubstr("pressure"));
  EXPECT_THROW(force.hasBall(1), OpenMM::OpenMMException);
  EXPECT_THROW(force.setParticleParameters(-1, 1, 1), OpenMM::OpenMMException);
}

TEST(ExactAreaForce, RefusesImagesUnlessToldToIgnoreThem) {
  OpenMM::System system;
  system.addParticle(1);
  auto* others = new OpenMM::NonbondedForce;
  others->addParticle(0, 0.1, 0);
  others->setNonbondedMethod(OpenMM::NonbondedForce::CutoffPeriodic);
  system.addForce(others);
  ExactAreaForce force;
  force.addParticle(0.1, 1);
  EXPECT_FALSE(force.usesPeriodicBoundaryConditions());
  EXPECT_THAT(refusal(force, system), HasSubstr("the System is periodic"));
  force.setPeriodicMethod(ExactAreaForce::IgnoreImages);
  EXPECT_EQ(refusal(force, system), "none");
}

}  // namespace
}  // namespace vdwmesh

// Measures of the same balls in many frames: closed forms, single calls of exact_union() as the
// reference to the last digit, coordinates of all layouts, and frames that cannot be measured.
#include "measures/frame_measures.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <vector>

#include "contract/extractor_contract.hpp"
#include "core/errors.hpp"
#include "measures/exact_union.hpp"
#include "support/dice.hpp"

namespace vdwmesh::testing {
namespace {

constexpr double kPi = std::numbers::pi;

// Share of the whole sphere's area by which a backend may differ from the closed form
// (UnionMeasurer::measure_into).
constexpr double kRounding = 1e-12;

template <class Number>
struct Frames {
  std::size_t count, atoms;
  std::vector<Number> numbers;  // frame by frame, atom by atom, x y z

  Number& at(std::size_t frame, std::size_t atom, std::size_t axis) {
    return numbers[3 * (frame * atoms + atom) + axis];
  }
  FrameCoordinates view(std::size_t first, std::size_t end) const {
    constexpr auto item = static_cast<std::ptrdiff_t>(sizeof(Number));
    const auto width = static_cast<std::ptrdiff_t>(3 * atoms);
    return {.first = reinterpret_cast<const std::byte*>(numbers.data() + 3 * atoms * first),
            .type = sizeof(Number) == 4 ? CoordinateType::float32 : CoordinateType::float64,
            .frames = end - first,
            .atoms = atoms,
            .frame_stride = width * item,
            .atom_stride = 3 * item,
            .axis_stride = item};
  }
  FrameCoordinates view() const { return view(0, count); }
};

// Balls about as crowded as atoms, which move by about 0.3 Å from frame to frame.
template <class Number>
Frames<Number> jittered(std::size_t count, std::size_t atoms, unsigned seed) {
  Dice dice(seed);
  const double half = 0.5 * std::cbrt(20.0 * static_cast<double>(atoms));
  std::vector<double> start;
  for (std::size_t i = 0; i < 3 * atoms; ++i) start.push_back(dice.real(-half, half));
  Frames<Number> frames{count, atoms, {}};
  for (std::size_t t = 0; t < count; ++t) {
    for (const double x : start) {
      frames.numbers.push_back(static_cast<Number>(x + dice.real(-0.3, 0.3)));
    }
  }
  return frames;
}

std::vector<double> radii_of(std::size_t atoms, double probe) {
  Dice dice(17);
  std::vector<double> radii;
  for (std::size_t i = 0; i < atoms; ++i) radii.push_back(dice.real(1.2, 1.9) + probe);
  return radii;
}

template <class Number>
SphereSet set_of(Frames<Number>& frames, std::size_t t, const std::vector<double>& radii,
                 double unit = 1) {
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const auto at = [&](std::size_t axis) {
      return unit * static_cast<double>(frames.at(t, i, axis));
    };
    spheres.push_back({{at(0), at(1), at(2)}, radii[i]});
  }
  return SphereSet(std::move(spheres));
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

void expect_same(const ExactUnion& found, const ExactUnion& expected) {
  EXPECT_EQ(found.method, expected.method);
  EXPECT_EQ(found.area, expected.area);
  EXPECT_EQ(found.volume, expected.volume);
  EXPECT_TRUE(same_bits(found.per_sphere, expected.per_sphere));
  EXPECT_EQ(found.check_area, expected.check_area);
  EXPECT_EQ(found.fallback_spheres, expected.fallback_spheres);
  ASSERT_EQ(found.counts.has_value(), expected.counts.has_value());
  if (found.counts) {
    EXPECT_EQ(found.counts->components, expected.counts->components);
    EXPECT_EQ(found.counts->euler_characteristic, expected.counts->euler_characteristic);
    EXPECT_EQ(found.counts->hidden_spheres, expected.counts->hidden_spheres);
  }
  ASSERT_EQ(found.topology.has_value(), expected.topology.has_value());
  if (found.topology) {
    EXPECT_EQ(found.topology->tunnels, expected.topology->tunnels);
    EXPECT_TRUE(same_bits(found.topology->shells, expected.topology->shells));
  }
}

TEST(FrameMeasures, AreThoseOfSingleCallsForAnyThreadsAndParts) {
  constexpr std::size_t kFrames = 7, kAtoms = 90;
  auto frames = jittered<float>(kFrames, kAtoms, 3);
  const std::vector<double> radii = radii_of(kAtoms, 0);
  const std::vector<SphereId> some{3, 80, 41, 3};
  for (const UnionOptions& measures : std::vector<UnionOptions>{
           {.topology = TopologyRequest::none},
           {.topology = TopologyRequest::counts},
           {.topology = TopologyRequest::full},
           {.topology = TopologyRequest::none, .measured = some},
           {.method = UnionMethod::both, .topology = TopologyRequest::full, .measured = some}}) {
    std::vector<ExactUnion> expected;
    for (std::size_t t = 0; t < kFrames; ++t) {
      expected.push_back(exact_union(set_of(frames, t, radii), measures));
    }
    for (const std::size_t threads : {1u, 2u, 5u}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      for (const std::size_t part : {std::size_t{1}, std::size_t{3}, kFrames}) {
        SCOPED_TRACE(::testing::Message() << threads << " threads, " << part << " frames a call");
        std::vector<ExactUnion> found;
        for (std::size_t t = 0; t < kFrames; t += part) {
          const std::size_t end = std::min(kFrames, t + part);
          measure_frames(found, radii, frames.view(t, end), {measures, PerSphere::keep});
          ASSERT_EQ(found.size(), end - t);
          for (std::size_t i = t; i < end; ++i) expect_same(found[i - t], expected[i]);
        }
      }
    }
  }
}

TEST(FrameMeasures, LeaveMeasuresOfSpheresAwayUnlessTheyAreKept) {
  auto frames = jittered<double>(3, 40, 1);
  const std::vector<double> radii = radii_of(40, 1.4);
  std::vector<ExactUnion> kept, dropped;
  measure_frames(kept, radii, frames.view(), {.per_sphere = PerSphere::keep});
  dropped = kept;  // what it had is gone afterwards
  measure_frames(dropped, radii, frames.view(), {});
  for (std::size_t t = 0; t < 3; ++t) {
    EXPECT_EQ(kept[t].per_sphere.size(), 40u);
    EXPECT_TRUE(dropped[t].per_sphere.empty());
    EXPECT_EQ(dropped[t].area, kept[t].area);
  }
}

// Axis by axis, as some readers hand them out; frames backwards; not aligned; in nm.
TEST(FrameMeasures, CoordinatesMayLieInAnyOrder) {
  constexpr std::size_t kFrames = 4, kAtoms = 30;
  auto frames = jittered<float>(kFrames, kAtoms, 8);
  for (float& number : frames.numbers) number *= 0.1f;
  const std::vector<double> radii = radii_of(kAtoms, 0);
  std::vector<std::byte> bytes(1 + frames.numbers.size() * sizeof(float));
  const auto place = [&](std::size_t t, std::size_t i, std::size_t axis) {
    return 1 + sizeof(float) * (((kFrames - 1 - t) * 3 + axis) * kAtoms + i);
  };
  for (std::size_t t = 0; t < kFrames; ++t) {
    for (std::size_t i = 0; i < kAtoms; ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        std::memcpy(&bytes[place(t, i, axis)], &frames.at(t, i, axis), sizeof(float));
      }
    }
  }
  constexpr auto item = static_cast<std::ptrdiff_t>(sizeof(float));
  constexpr auto atoms = static_cast<std::ptrdiff_t>(kAtoms);
  std::vector<ExactUnion> found;
  measure_frames(found, radii,
                 {.first = &bytes[place(0, 0, 0)],
                  .type = CoordinateType::float32,
                  .frames = kFrames,
                  .atoms = kAtoms,
                  .frame_stride = -3 * atoms * item,
                  .atom_stride = item,
                  .axis_stride = atoms * item,
                  .unit = 10},
                 {.per_sphere = PerSphere::keep});
  ASSERT_EQ(found.size(), kFrames);
  for (std::size_t t = 0; t < kFrames; ++t) {
    expect_same(found[t],
                exact_union(set_of(frames, t, radii, 10), {.topology = TopologyRequest::none}));
  }
}

// Eight balls at the corners of a cube of side √2 and radius 1: the circles of four of them meet in
// the middle of a face, which the arcs alone do not decide. In the second frame they are displaced.
TEST(FrameMeasures, CountsThatTheArcsLeaveOpenComeFromTheTriangulation) {
  Frames<double> frames{2, 8, {}};
  Dice dice(2);
  for (const double disorder : {0.0, 0.1}) {
    for (int corner = 0; corner < 8; ++corner) {
      for (int axis = 0; axis < 3; ++axis) {
        const double place = (corner >> axis & 1) != 0 ? std::sqrt(2.0) : 0;
        frames.numbers.push_back(place + dice.real(0, disorder));
      }
    }
  }
  const std::vector<double> radii(8, 1.0);
  const UnionOptions counts{.topology = TopologyRequest::counts};
  ASSERT_FALSE(exact_union(set_of(frames, 0, radii), counts).counts);
  ASSERT_TRUE(exact_union(set_of(frames, 1, radii), counts).counts);
  std::vector<ExactUnion> found;
  measure_frames(found, radii, frames.view(), {.measures = counts});
  for (std::size_t t = 0; t < 2; ++t) {
    const ExactUnion whole = exact_union(set_of(frames, t, radii));
    ASSERT_TRUE(found[t].counts);
    EXPECT_EQ(found[t].counts->components, whole.topology->components);
    EXPECT_EQ(found[t].counts->euler_characteristic, whole.topology->euler_characteristic);
    EXPECT_EQ(found[t].counts->hidden_spheres, whole.topology->hidden_spheres);
  }
}

class FrameMeasuresContract : public BackendTest, public ::testing::WithParamInterface<Backend> {
 protected:
  void SetUp() override { need(GetParam()); }
  FrameOptions options(PerSphere per_sphere) {
    if (GetParam() == Backend::cuda && !measurer_) measurer_ = make_union_measurer(Backend::cuda);
    FrameOptions options;
    options.per_sphere = per_sphere;
    options.measurer = measurer_.get();
    return options;
  }

 private:
  std::unique_ptr<UnionMeasurer> measurer_;
};
VDWMESH_INSTANTIATE_BACKENDS(FrameMeasuresContract);

// Each of two equal balls loses a cap of area 2 π r h, h = r - d / 2.
TEST_P(FrameMeasuresContract, TwoBallsThatPart) {
  constexpr std::size_t kFrames = 9;
  Frames<float> frames{kFrames, 2, std::vector<float>(6 * kFrames)};
  for (std::size_t t = 0; t < kFrames; ++t) {
    frames.at(t, 1, 2) = 0.25f * static_cast<float>(t + 1);
  }
  const double r = 1.5, whole = 4 * kPi * r * r;
  std::vector<ExactUnion> found;
  const std::vector<SphereId> second{1};
  FrameOptions wanted = options(PerSphere::keep);
  for (const bool one : {false, true}) {
    if (one) wanted.measures.measured = second;
    measure_frames(found, std::vector<double>{r, r}, frames.view(), wanted);
    ASSERT_EQ(found.size(), kFrames);
    for (std::size_t t = 0; t < kFrames; ++t) {
      const double h = r - 0.125 * static_cast<double>(t + 1), ball = whole - 2 * kPi * r * h;
      EXPECT_NEAR(found[t].area, one ? ball : 2 * ball, 2 * kRounding * whole) << t;
      EXPECT_NEAR(found[t].per_sphere[1].area, ball, kRounding * whole) << t;
      EXPECT_EQ(std::isnan(found[t].per_sphere[0].area), one);
    }
  }
}

// The frames before the first bad one are measured, whatever stands behind it.
TEST_P(FrameMeasuresContract, ABadFrameIsNamed) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  auto frames = jittered<double>(12, 25, 5);
  const std::vector<double> radii = radii_of(25, 0);
  std::vector<ExactUnion> whole, found;
  measure_frames(whole, radii, frames.view(), options(PerSphere::keep));
  frames.at(11, 0, 0) = frames.at(7, 20, 1) = frames.at(7, 19, 2) = kNan;
  for (const std::size_t bad : {7u, 4u, 0u}) {
    if (bad < 7) frames.at(bad, 19, 2) = bad == 4 ? 2e30 : -std::numeric_limits<double>::infinity();
    try {
      measure_frames(found, radii, frames.view(), options(PerSphere::keep));
      FAIL() << "accepted";
    } catch (const InvalidFrame& error) {
      EXPECT_EQ(error.frame(), bad);
      EXPECT_EQ(error.atom(), bad == 4 ? std::nullopt : std::optional<std::size_t>(19));
      EXPECT_NE(std::string(error.what()).find(bad == 4 ? "sphere 19" : "is not finite"),
                std::string::npos)
          << error.what();
    }
    ASSERT_EQ(found.size(), bad);
    for (std::size_t t = 0; t < bad; ++t) {
      EXPECT_TRUE(same_bits(found[t].per_sphere, whole[t].per_sphere));
      EXPECT_EQ(found[t].volume, whole[t].volume);
    }
  }
}

TEST_P(FrameMeasuresContract, RefusesWhatAreNoFrames) {
  auto frames = jittered<double>(2, 3, 1);
  std::vector<ExactUnion> found;
  const auto measure = [&](const std::vector<double>& radii, const FrameCoordinates& places) {
    measure_frames(found, radii, places, options(PerSphere::drop));
  };
  EXPECT_THROW(measure({1, 1}, frames.view()), InvalidInput);
  EXPECT_THROW(measure({}, FrameCoordinates{.frames = 2}), InvalidInput);
  EXPECT_THROW(measure({1, 0, 1}, frames.view()), InvalidInput);
  EXPECT_NO_THROW(measure({1, 1, 1}, frames.view(0, 0)));
  EXPECT_TRUE(found.empty());
}

TEST(FrameMeasures, ABatchRefusesWhatItCannotGive) {
  auto frames = jittered<double>(2, 3, 1);
  const auto measurer = make_cpu_union_measurer();
  std::vector<ExactUnion> found;
  for (const UnionOptions& wanted :
       std::vector<UnionOptions>{{.topology = TopologyRequest::full},
                                 {.topology = TopologyRequest::counts},
                                 {.method = UnionMethod::both, .topology = TopologyRequest::none},
                                 {.topology = TopologyRequest::none, .certify = true}}) {
    EXPECT_THROW(measure_frames(found, std::vector<double>{1, 1, 1}, frames.view(),
                                {.measures = wanted, .measurer = measurer.get()}),
                 InvalidInput);
  }
}

// The measurer of the CPU computes by the same arcs, so a batch has the digits of single calls.
TEST(FrameMeasures, ABatchHasTheDigitsOfItsMeasurer) {
  auto frames = jittered<float>(5, 60, 4);
  const std::vector<double> radii = radii_of(60, 1.4);
  const std::vector<SphereId> some{7, 8, 59};
  const auto measurer = make_cpu_union_measurer();
  for (const auto& measured :
       {std::optional<std::span<const SphereId>>(), std::optional(std::span(some))}) {
    const UnionOptions measures{.topology = TopologyRequest::none, .measured = measured};
    std::vector<ExactUnion> found;
    measure_frames(found, radii, frames.view(), {measures, PerSphere::keep, measurer.get()});
    for (std::size_t t = 0; t < 5; ++t) {
      ExactUnion expected = exact_union(set_of(frames, t, radii), measures);
      found[t].fallback_spheres = expected.fallback_spheres;
      expect_same(found[t], expected);
    }
  }
}

// Notes the largest batch that it was given.
class NotingMeasurer : public UnionMeasurer {
 public:
  void measure_into(BatchMeasures& result, const SphereBatch& batch,
                    Monitor* monitor) const override {
    largest = std::max(largest, batch.size);
    measurer_->measure_into(result, batch, monitor);
  }
  void gradients_into(BatchGradients& result, const SphereBatch& batch, const BatchWeights& weights,
                      Monitor* monitor) const override {
    measurer_->gradients_into(result, batch, weights, monitor);
  }
  mutable std::size_t largest = 0;

 private:
  std::unique_ptr<UnionMeasurer> measurer_ = make_cpu_union_measurer();
};

TEST(FrameMeasures, BatchesAreNoLargerThanAsked) {
  auto frames = jittered<float>(7, 20, 4);
  const std::vector<double> radii = radii_of(20, 1.4);
  std::vector<ExactUnion> whole;
  measure_frames(whole, radii, frames.view(), {.per_sphere = PerSphere::keep});
  for (const std::size_t most : {1u, 3u * 20, 7u * 20}) {
    const NotingMeasurer measurer;
    std::vector<ExactUnion> found;
    measure_frames(found, radii, frames.view(),
                   {.per_sphere = PerSphere::keep, .measurer = &measurer, .balls_at_once = most});
    EXPECT_EQ(measurer.largest, std::max<std::size_t>(most, 20));
    ASSERT_EQ(found.size(), 7u);
    for (std::size_t t = 0; t < 7; ++t) {
      EXPECT_TRUE(same_bits(found[t].per_sphere, whole[t].per_sphere)) << t;
    }
    frames.at(5, 3, 1) = std::numeric_limits<float>::infinity();
    EXPECT_THROW(
        measure_frames(found, radii, frames.view(), {.measurer = &measurer, .balls_at_once = most}),
        InvalidFrame);
    EXPECT_EQ(found.size(), 5u);
    frames.at(5, 3, 1) = 0;
    measure_frames(whole, radii, frames.view(), {.per_sphere = PerSphere::keep});
  }
}

}  // namespace
}  // namespace vdwmesh::testing

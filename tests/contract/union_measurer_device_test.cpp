// Spheres that stand in memory of a CUDA device are measured there, with the bits of a copy on the
// host; and a sphere is measured alike in every set that has the spheres overlapping it.
#include <cuda_runtime.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "contract/extractor_contract.hpp"
#include "core/errors.hpp"
#include "measures/arcs/arcs.hpp"
#include "measures/union_measurer.hpp"

namespace vdwmesh::testing {
namespace {

class SpheresOnTheDevice : public BackendTest {
 protected:
  void SetUp() override { need(Backend::cuda); }
  void TearDown() override {
    cudaFree(spheres_);
    spheres_ = nullptr;
  }
  // One row stands before the spheres, so that they are not aligned to more than a row.
  SphereBatch to_device(const std::vector<Sphere>& spheres) {
    void* memory = nullptr;
    EXPECT_EQ(cudaMalloc(&memory, (spheres.size() + 1) * sizeof(Sphere)), cudaSuccess);
    spheres_ = static_cast<Sphere*>(memory);
    EXPECT_EQ(cudaMemcpy(spheres_ + 1, spheres.data(), spheres.size() * sizeof(Sphere),
                         cudaMemcpyHostToDevice),
              cudaSuccess);
    return {.spheres = spheres_ + 1, .size = spheres.size(), .memory = MemorySpace::device};
  }

 private:
  Sphere* spheres_ = nullptr;
};

// A lattice, most of whose balls are left to the host, and balls in general position.
std::vector<Sphere> two_sets() {
  std::vector<Sphere> spheres;
  for (int i = 0; i < 64; ++i) {
    spheres.push_back({{1.0 * (i % 4), 1.0 * (i / 4 % 4), 1.0 * (i / 16)}, 0.75});
  }
  for (int i = 0; i < 36; ++i) spheres.push_back({{0.37 * i, 0.011 * i * i, 0.3 * (i % 7)}, 1.5});
  return spheres;
}

TEST_F(SpheresOnTheDevice, HaveTheMeasuresOfACopyOnTheHost) {
  const std::vector<Sphere> spheres = two_sets();
  const std::vector<std::size_t> offsets{0, 64, 100};
  for (const Backend backend : {Backend::cuda, Backend::automatic}) {
    const auto measurer = make_union_measurer(backend);
    SphereBatch batch{.spheres = spheres.data(), .size = spheres.size(), .offsets = offsets};
    const BatchMeasures host = measurer->measure(batch);
    batch = to_device(spheres);
    batch.offsets = offsets;
    const BatchMeasures device = measurer->measure(batch);
    ASSERT_EQ(device.per_sphere.size(), spheres.size());
    EXPECT_EQ(std::memcmp(host.per_sphere.data(), device.per_sphere.data(),
                          spheres.size() * sizeof(SphereMeasures)),
              0);
    EXPECT_EQ(device.fallback_spheres, host.fallback_spheres);
    EXPECT_GT(device.fallback_spheres, 0u);
    TearDown();
  }
}

// So many equal sets that a copy on the host is measured in several parts.
struct ManySets {
  std::vector<Sphere> one, all;
  std::vector<std::size_t> offsets{0};

  ManySets() {
    constexpr std::size_t kSets = 9000;
    const std::vector<Sphere> two = two_sets();
    one.assign(two.begin() + 64, two.end());
    for (std::size_t set = 0; set < kSets; ++set) {
      all.insert(all.end(), one.begin(), one.end());
      offsets.push_back(all.size());
    }
  }
  SphereBatch on_host() const {
    return {.spheres = all.data(), .size = all.size(), .offsets = offsets};
  }
};

TEST_F(SpheresOnTheDevice, PartsOfABatchHaveTheMeasuresOfTheWhole) {
  const ManySets sets;
  const auto measurer = make_union_measurer(Backend::cuda);
  const BatchMeasures alone =
      measurer->measure({.spheres = sets.one.data(), .size = sets.one.size()});
  const BatchMeasures host = measurer->measure(sets.on_host());
  SphereBatch batch = to_device(sets.all);
  batch.offsets = sets.offsets;
  const BatchMeasures device = measurer->measure(batch);
  const std::size_t size = sets.one.size(), bytes = size * sizeof(SphereMeasures);
  for (const BatchMeasures* measured : {&host, &device}) {
    ASSERT_EQ(measured->per_sphere.size(), sets.all.size());
    for (std::size_t first = 0; first < sets.all.size(); first += size) {
      ASSERT_EQ(std::memcmp(&measured->per_sphere[first], alone.per_sphere.data(), bytes), 0)
          << first;
    }
    EXPECT_EQ(measured->totals.back().volume, alone.totals[0].volume);
  }
  EXPECT_EQ(host.fallback_spheres, device.fallback_spheres);
}

TEST_F(SpheresOnTheDevice, PartsOfABatchNameABadSphereByItsPlaceInTheWhole) {
  ManySets sets;
  sets.all[320000].radius = -1;
  try {
    make_union_measurer(Backend::cuda)->measure(sets.on_host());
    FAIL() << "accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("sphere 320000"), std::string::npos) << error.what();
  }
}

TEST_F(SpheresOnTheDevice, AreCheckedThere) {
  std::vector<Sphere> spheres = two_sets();
  spheres[70].center.y = std::numeric_limits<double>::quiet_NaN();
  try {
    make_union_measurer(Backend::cuda)->measure(to_device(spheres));
    FAIL() << "accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("sphere 70"), std::string::npos) << error.what();
  }
}

// Nearly the atoms of a crystal: many neighbours are at nearly the same distance, so that the order
// in which the planes of a power cell are cut is a matter of the last digits.
std::vector<Sphere> nearly_a_crystal(double radius) {
  std::vector<Sphere> spheres;
  auto shift = [n = 0u]() mutable { return 1e-6 * (1664525u * ++n % 1009) / 1009; };
  for (int x = 0; x < 30; ++x) {
    for (int y = 0; y < 6; ++y) {
      for (int z = 0; z < 5; ++z) {
        for (const double half : {0.0, 0.55}) {
          spheres.push_back(
              {{1.1 * x + half + shift(), 1.1 * y + half + shift(), 1.1 * z + half + shift()},
               half == 0 ? radius : 0.9 * radius});
        }
      }
    }
  }
  return spheres;
}

class ArcsOnTheDevice : public BackendTest {
 protected:
  void SetUp() override { need(Backend::cuda); }
};

// Measures the spheres around a place, and compares those that have all that overlap them with what
// the whole set gave. Returns how many had no doubt.
std::size_t expect_bits_of_whole(const std::vector<Sphere>& all, const DeviceArcs& whole,
                                 const Vec3d& place, double radius) {
  const auto within = [&](const Sphere& s, double reach) {
    const Vec3d to = s.center - place;
    return std::max({std::abs(to.x), std::abs(to.y), std::abs(to.z)}) < reach;
  };
  // Cells are as wide as the largest ball, and of the 1,000 Å to this one there are few.
  std::vector<Sphere> some{{{1e3, 0, 0}, 1.7 * radius}};
  std::vector<std::size_t> ids{all.size()};
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!within(all[i], 4)) continue;
    some.push_back(all[i]);
    ids.push_back(i);
  }
  const DeviceArcs part = measure_arcs_on_device(SphereSet::view(some));
  std::size_t good = 0;
  for (std::size_t i = 1; i < some.size(); ++i) {
    if (!within(some[i], 2)) continue;
    const auto here = static_cast<SphereId>(i), there = static_cast<SphereId>(ids[i]);
    const bool doubt = std::ranges::binary_search(part.suspect, here);
    EXPECT_EQ(doubt, std::ranges::binary_search(whole.suspect, there));
    if (doubt) continue;
    ++good;
    EXPECT_EQ(std::memcmp(&part.per_sphere[i], &whole.per_sphere[ids[i]], sizeof(SphereMeasures)),
              0)
        << i;
  }
  return good;
}

TEST_F(ArcsOnTheDevice, SpheresHaveTheSameBitsInEverySetWithTheirNeighbours) {
  for (const double radius : {0.6, 0.8, 1.0}) {
    std::vector<Sphere> all = nearly_a_crystal(radius);
    // Spheres of a cell stand in the order of the set, so wider cells give neighbours another
    // order.
    std::ranges::shuffle(all, std::mt19937_64(5));
    const DeviceArcs whole = measure_arcs_on_device(SphereSet::view(all));
    std::size_t good = 0;
    for (int part = 0; part < 30; ++part) {
      good += expect_bits_of_whole(all, whole, {1.07 * part, 0.2 * part, 0.17 * part}, radius);
    }
    EXPECT_GT(good, 1000u) << radius;
  }
}

TEST_F(ArcsOnTheDevice, AgreeWithTheCpuAndLeaveTheLatticeToTheHost) {
  for (const std::vector<Sphere>& spheres : {nearly_a_crystal(0.8), two_sets()}) {
    const SphereSet set = SphereSet::view(spheres);
    const DeviceArcs device = measure_arcs_on_device(set);
    ASSERT_EQ(device.per_sphere.size(), spheres.size());
    EXPECT_TRUE(std::ranges::is_sorted(device.suspect));
    const ArcMeasures host = arc_measures(set);
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      const auto id = static_cast<SphereId>(i);
      if (std::ranges::binary_search(device.suspect, id)) continue;
      if (std::ranges::binary_search(host.suspect, id)) continue;
      EXPECT_NEAR(device.per_sphere[i].area, host.per_sphere[i].area, 1e-11);
      EXPECT_NEAR(device.per_sphere[i].volume, host.per_sphere[i].volume, 1e-11);
    }
  }
  EXPECT_GT(measure_arcs_on_device(SphereSet(two_sets())).suspect.size(), 8u);
}

}  // namespace
}  // namespace vdwmesh::testing

// How the CUDA backend chooses devices, and what it does where the runtime fails: on a runtime of
// make-believe, with or without a GPU.
#include "cuda/memory/device.cuh"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "cuda/backend.hpp"
#include "cuda/extract/bricks/brick_mesher.cuh"
#include "cuda/fake_runtime.hpp"
#include "cuda/memory/device_memory.cuh"
#include "cuda/memory/transfer.cuh"
#include "support/sampled_spheres.hpp"

namespace vdwmesh {
namespace {

using ::testing::ElementsAre;
using testing::fake_runtime;
using testing::FakeDevice;
using ::testing::HasSubstr;

// Below and above what any build of this decade has code for.
constexpr int kTooOld = 10, kNewEnough = 990;

class Devices : public ::testing::Test {
 protected:
  void SetUp() override { fake_runtime() = {}; }
  void TearDown() override {
    EXPECT_EQ(fake_runtime().events, 0);
    EXPECT_EQ(fake_runtime().allocated, 0);
    EXPECT_EQ(fake_runtime().last_error, cudaSuccess) << "left for the next launch to find";
  }
};

std::vector<std::string> names(const DeviceList& list) {
  std::vector<std::string> all;
  for (const DeviceInfo& device : list.devices) all.push_back(device.name);
  return all;
}

TEST_F(Devices, WithoutCodeOrPoolsAreLeftOut) {
  fake_runtime().devices = {
      {"old", kTooOld}, {"poolless", kNewEnough, false}, {"a", kNewEnough}, {"b", kNewEnough}};
  EXPECT_THAT(names(cuda_devices()), ElementsAre("a", "b"));
  EXPECT_THAT(usable_devices(), ElementsAre(2, 3));
  EXPECT_EQ(resolve(Backend::automatic), Backend::cuda);
}

// A build of machine code alone, on a device of a later major version.
TEST_F(Devices, NewerThanAllCodeIsLeftOut) {
  fake_runtime().devices = {{"new", kNewEnough, true, false}, {"a", kNewEnough}};
  fake_runtime().current = 1;
  EXPECT_THAT(usable_devices(), ElementsAre(1));
  EXPECT_EQ(fake_runtime().current, 1);
  fake_runtime().devices.pop_back();
  fake_runtime().current = 0;
  EXPECT_THAT(cuda_devices().reason,
              HasSubstr("new: compute capability 99.0, for which this build has no code"));
}

TEST_F(Devices, NoneThatCanBeUsedIsNone) {
  fake_runtime().devices = {{"old", kTooOld}};
  const DeviceList list = cuda_devices();
  EXPECT_TRUE(list.devices.empty());
  EXPECT_THAT(list.reason, HasSubstr("old: compute capability 1.0"));
  EXPECT_EQ(resolve(Backend::automatic), Backend::cpu);
  EXPECT_THROW(resolve(Backend::cuda), BackendUnavailable);
  EXPECT_THROW(DeviceScope(), BackendUnavailable);
}

TEST_F(Devices, ReasonsNameWhatIsMissing) {
  EXPECT_THAT(cuda_devices().reason, HasSubstr(cudaGetErrorString(cudaErrorNoDevice)));
  fake_runtime().driver = 0;
  EXPECT_THAT(cuda_devices().reason, HasSubstr("no NVIDIA driver"));
  fake_runtime() = {};
  fake_runtime().devices = {{"poolless", kNewEnough, false}};
  EXPECT_THAT(cuda_devices().reason, HasSubstr("poolless: no memory pools"));
}

TEST_F(Devices, ScopeTakesAUsableOneAndGivesBackTheFormer) {
  fake_runtime().devices = {{"old", kTooOld}, {"a", kNewEnough}, {"b", kNewEnough}};
  for (const auto& [before, within] : {std::pair{0, 1}, {1, 1}, {2, 2}}) {
    fake_runtime().current = before;
    {
      const DeviceScope scope;
      EXPECT_EQ(fake_runtime().current, within);
    }
    EXPECT_EQ(fake_runtime().current, before);
  }
}

TEST_F(Devices, ProcessesTakeThemInTurn) {
  fake_runtime().devices = {{"old", kTooOld}, {"a", kNewEnough}, {"b", kNewEnough}};
  for (const auto& [process, device] : {std::pair{0u, 1}, {1u, 2}, {2u, 1}, {7u, 2}}) {
    share_devices(process);
    EXPECT_EQ(fake_runtime().current, device) << process;
    const DeviceScope scope;
    EXPECT_EQ(fake_runtime().current, device) << process;
  }
  fake_runtime().devices = {{"old", kTooOld}};
  fake_runtime().current = 0;
  share_devices(3);
  EXPECT_EQ(fake_runtime().current, 0);
}

TEST_F(Devices, WhoseModeForbidsUseAreLeftOut) {
  fake_runtime().devices = {{"a", kNewEnough}};
  fake_runtime().devices[0].mode = cudaComputeModeProhibited;
  EXPECT_THAT(cuda_devices().reason, HasSubstr("a: its compute mode lets no program use it"));
  EXPECT_EQ(resolve(Backend::automatic), Backend::cpu);
}

// A device in exclusive mode that another process has is usable until it is opened.
TEST_F(Devices, TheNextIsTakenWhereOneDoesNotOpen) {
  fake_runtime().devices = {{"a", kNewEnough}, {"b", kNewEnough}};
  fake_runtime().devices[0].opens = cudaErrorDevicesUnavailable;
  {
    const DeviceScope scope;
    EXPECT_EQ(fake_runtime().current, 1);
  }
  EXPECT_EQ(fake_runtime().current, 0);
  EXPECT_THROW(DeviceScope(0), BackendUnavailable);
  share_devices(0);  // says nothing: the calls that need a device do
}

TEST_F(Devices, AutomaticBackendsLeaveEverythingToTheCpuWhereNoneOpens) {
  const SphereSet spheres({{{0, 0, 0}, 1.5}, {{2, 0, 0}, 1.7}});
  const ExtractOptions options;
  for (const cudaError_t error : {cudaErrorDevicesUnavailable, cudaErrorMemoryAllocation}) {
    fake_runtime().devices = {{"taken", kNewEnough}};
    fake_runtime().devices[0].opens = error;
    EXPECT_THROW(make_extractor(Backend::cuda)->extract(spheres, options), BackendUnavailable);
    const ExtractResult extracted = make_extractor(Backend::automatic)->extract(spheres, options);
    EXPECT_EQ(hash(extracted.mesh), hash(make_cpu_extractor()->extract(spheres, options).mesh));
    EXPECT_THAT(extracted.fallback,
                HasSubstr(std::string("on the CPU: no CUDA device (taken does not open: ") +
                          cudaGetErrorString(error)));
  }
}

// An error of our own, such as that of a kernel that has failed before, is no reason to fall back.
TEST_F(Devices, OtherErrorsOfOpeningAreErrors) {
  fake_runtime().devices = {{"a", kNewEnough}};
  fake_runtime().devices[0].opens = cudaErrorIllegalAddress;
  EXPECT_THROW(DeviceScope(), CudaError);
  fake_runtime().last_error = cudaSuccess;
}

TEST_F(Devices, UploadsAreWaitedForWhereTheDeviceReadsTheHostsMemory) {
  for (const bool reads : {false, true}) {
    fake_runtime() = {};
    fake_runtime().devices = {{"a", kNewEnough}};
    fake_runtime().devices[0].reads_pageable_memory = reads;
    const std::vector<int> host = {1, 2, 3};
    const DeviceArray<int> there = upload(host.data(), host.size(), nullptr);
    EXPECT_EQ(fake_runtime().stream_waits, reads ? 1 : 0);
  }
}

// Each thread of a transfer has two locked buffers, which are kept: no more threads than the
// caller's loops may have, and no more than 16. Device numbers of their own.
TEST_F(Devices, TransfersTakeNoMoreThreadsThanTheCallerMay) {
  constexpr int kChunks = 60;  // of 2 MiB, three for each thread
  const std::vector<std::byte> host(std::size_t{kChunks} << 21, std::byte{7});
  int device = 4;
  for (const auto& [allowed, taken] : {std::pair{1, 1}, {3, 3}, {24, 16}}) {
    fake_runtime() = {};
    fake_runtime().devices.assign(16, FakeDevice{"d", kNewEnough});
    use_device(device++);
    std::vector<std::byte> there(host.size());
    tbb::task_arena(allowed).execute([&, most = taken] {
      const Stream stream;
      upload_parts({{there.data(), host.data(), host.size()}}, stream);
      EXPECT_EQ(fake_runtime().locked, 2 * most);
    });
    EXPECT_EQ(there, host);
    fake_runtime().events = 0;  // those of the lanes are kept
  }
}

// A surface that finds nothing, of which only the bytes of its bricks count.
class EmptySource final : public BrickSource {
 public:
  using BrickSource::BrickSource;
  LabelWidth label_width() const override { return LabelWidth::one; }
  KeyList candidates(const KeyRange&, std::uint64_t) const override { return {}; }
  void count(const std::uint64_t*, std::uint64_t, ActiveBrick*, void*,
             const BrickCounts&) const override {
    throw InternalError("counted");
  }
  void emit_vertices(const BrickList&, std::uint32_t, const void*, const DeviceMeshView&,
                     unsigned long long*) const override {}
};

// What the options allow is for all workers of a device together.
TEST_F(Devices, WorkersShareTheMemoryThatTheOptionsAllow) {
  fake_runtime().devices = {{"a", kNewEnough}};
  constexpr std::uint64_t kBricks = 1'000'000;
  ExtractOptions options;
  options.device_memory = 1'000'000'000;
  const auto refusal = [&](std::size_t sharers) -> std::string {
    const Stream stream;
    const EmptySource source(stream);
    DeviceBrickMesher mesher(source, options, sharers);
    KeyList candidates;
    candidates.count = kBricks;
    try {
      mesher.count(std::move(candidates));
    } catch (const DeviceMemoryExceeded& error) {
      return error.what();
    } catch (const InternalError&) {
    }
    return "";
  };
  EXPECT_EQ(refusal(1), "");
  EXPECT_THAT(refusal(1000), HasSubstr(" 1000000 are available"));
}

// Device numbers of their own: a process makes a pool once.
TEST_F(Devices, PoolsKeepTheirMemoryUntilItIsReleased) {
  fake_runtime().devices.assign(12, FakeDevice{"d", kNewEnough});
  fake_runtime().current = 9;
  for (int i = 0; i < 2; ++i) {
    const DeviceScope scope;
    EXPECT_EQ(fake_runtime().devices[9].keeps, std::numeric_limits<std::uint64_t>::max());
    EXPECT_EQ(fake_runtime().devices[9].thresholds_set, 1);
  }
  EXPECT_EQ(fake_runtime().devices[9].trims, 0);
  release_device_memory();
  EXPECT_EQ(fake_runtime().devices[9].trims, 1);
  EXPECT_EQ(fake_runtime().devices[10].trims, 0) << "a device that was never used";
  EXPECT_EQ(fake_runtime().current, 9);
}

// As a worker on another device leaves it.
TEST_F(Devices, AScopeGivesBackTheFormerDeviceWhateverWasMadeCurrent) {
  fake_runtime().devices = {{"a", kNewEnough}, {"b", kNewEnough}};
  {
    const DeviceScope scope;
    use_device(1);
  }
  EXPECT_EQ(fake_runtime().current, 0);
}

TEST_F(Devices, ReleasingThatFailsLeavesTheDeviceCurrent) {
  fake_runtime().devices.assign(14, FakeDevice{"d", kNewEnough});
  fake_runtime().current = 13;
  { const DeviceScope scope; }
  fake_runtime().current = 2;
  fake_runtime().failures["cudaMemPoolTrimTo"] = {};
  EXPECT_THROW(release_device_memory(), CudaError);
  EXPECT_EQ(fake_runtime().current, 2);
}

TEST_F(Devices, MemoryIsAskedForAgainOnceThePoolIsEmptied) {
  fake_runtime().devices = {{"a", kNewEnough}};
  fake_runtime().failures["cudaMallocFromPoolAsync"] = {0, 1, cudaErrorMemoryAllocation};
  const DeviceArray<int> array(10, nullptr);
  EXPECT_NE(array.data(), nullptr);
  EXPECT_EQ(fake_runtime().devices[0].trims, 1);
}

TEST_F(Devices, MemoryThatCannotBeHadIsTheDevices) {
  fake_runtime().devices = {{"a", kNewEnough}};
  fake_runtime().failures["cudaMallocFromPoolAsync"] = {0, 1000, cudaErrorMemoryAllocation};
  EXPECT_THROW(DeviceArray<int>(10, nullptr), DeviceMemoryExceeded);
}

// The CPU's results, which say what was lacking.
TEST_F(Devices, AutomaticBackendsLeaveToTheCpuWhatDoesNotFit) {
  fake_runtime().devices = {{"a", kNewEnough}};
  fake_runtime().failures["cudaMallocFromPoolAsync"] = {0, 1000, cudaErrorMemoryAllocation};
  const SphereSet spheres({{{0, 0, 0}, 1.5}, {{2, 0, 0}, 1.7}});
  ExtractOptions options;
  options.field.kind = FieldKind::blinn;
  EXPECT_THROW(make_extractor(Backend::cuda)->extract(spheres, options), DeviceMemoryExceeded);
  const ExtractResult extracted = make_extractor(Backend::automatic)->extract(spheres, options);
  EXPECT_EQ(hash(extracted.mesh), hash(make_cpu_extractor()->extract(spheres, options).mesh));
  const auto mesher = make_field_mesher(Backend::automatic);
  const testing::SampledField field = testing::sampled_spheres(spheres, options);
  const ExtractResult meshed = mesher->mesh(field, options);
  EXPECT_EQ(hash(meshed.mesh), hash(make_cpu_field_mesher()->mesh(field, options).mesh));
  RefineOptions refine;
  refine.field = options.field;
  refine.projection = Projection::field;
  std::vector<std::string> fallbacks = {extracted.fallback, meshed.fallback};
  for (refine.subdivisions = 0; refine.subdivisions < 2; ++refine.subdivisions) {
    const PipelineResult result = make_pipeline(Backend::automatic)->run(spheres, options, refine);
    EXPECT_EQ(hash(result.mesh),
              hash(make_pipeline(Backend::cpu)->run(spheres, options, refine).mesh));
    fallbacks.push_back(result.fallback);
  }
  EXPECT_THAT(fallbacks, ::testing::Each(HasSubstr("on the CPU: device memory: ")));
}

// A launch is checked by the runtime's last error, which would be that of an earlier call.
TEST_F(Devices, ErrorsAreNotLeftForTheNextLaunch) {
  for (const cudaError_t error : {cudaErrorInvalidValue, cudaErrorMemoryAllocation}) {
    fake_runtime().failures["cudaEventRecord"] = {0, 1, error};
    EXPECT_ANY_THROW(StageClock(nullptr));
    EXPECT_NO_THROW(check_launch("the next kernel"));
  }
}

TEST_F(Devices, EventsOfConstructorsThatThrowAreDestroyed) {
  for (const char* function : {"cudaEventCreateWithFlags", "cudaEventRecord"}) {
    for (const int succeeding : {0, 1}) {
      fake_runtime().failures = {{function, {succeeding, 1, cudaErrorInvalidValue}}};
      EXPECT_THROW(
          {
            StageClock(nullptr).restart();
            StageMarks(nullptr).mark();
          },
          CudaError)
          << function << " after " << succeeding;
      EXPECT_EQ(fake_runtime().events, 0) << function << " after " << succeeding;
    }
  }
}

TEST_F(Devices, StagingBuffersDoWithoutLockedPages) {
  {
    const StagingBuffer locked(64);
    EXPECT_EQ(fake_runtime().locked, 1);
  }
  EXPECT_EQ(fake_runtime().locked, 0);
  fake_runtime().failures["cudaHostAlloc"] = {0, 1, cudaErrorMemoryAllocation};
  const StagingBuffer ordinary(64);
  ASSERT_NE(ordinary.data(), nullptr);
  std::memset(ordinary.data(), 7, 64);
  EXPECT_EQ(fake_runtime().locked, 0);
  fake_runtime().failures["cudaHostAlloc"] = {0, 1, cudaErrorUnknown};
  EXPECT_THROW(StagingBuffer(64), CudaError);
}

}  // namespace
}  // namespace vdwmesh

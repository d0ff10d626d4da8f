// Several threads of the host take batches in turn, each with a stream of its own: while one batch
// is gathered and packed on all cores, others travel, are looked at, or are unpacked.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

#include "core/fixed_blocks.hpp"
#include "creases/share/boundary_look.hpp"
#include "creases/share/look_batch.hpp"
#include "cuda/memory/device.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/run_on_threads.hpp"
#include "cuda/memory/transfer.cuh"
#include "cuda/memory/waits.cuh"
#include "cuda/mesher/batch_rooms.cuh"
#include "cuda/mesher/boundary_looks.cuh"

namespace vdwmesh::mesher {
namespace {

constexpr unsigned kThreads = 64;
// Boundaries of a batch, threads of the host, and boundaries for a warp.
constexpr std::size_t kBatch = 8192, kHostThreads = 3;
constexpr unsigned kPerWarp = 2;

// Looks at one boundary per thread, on the first kPerWarp lanes of each warp, for the reason that
// patches_per_warp() gives; 2 warps per thread block. The threads write their requests one after
// another into one list, in no particular order; first_split of an outcome says where.
__global__ void __launch_bounds__(kThreads)
    look_at_bounded(const BoundedLook* looks, std::uint32_t count, LookMemory memory,
                    PatchOutcome* outcomes, PieceSplit* requests, std::uint32_t* request_count) {
  const unsigned lane = threadIdx.x % 32;
  if (lane >= kPerWarp) return;
  const std::uint64_t i = thread_index() / 32 * kPerWarp + lane;
  if (i >= count) return;
  PatchOutcome outcome = look_at_boundary(looks[i], memory);
  if (outcome.failure == PatchFailure::none && outcome.splits > 0) {
    PieceSplit* const to = requests + atomicAdd(request_count, outcome.splits);
    for (std::uint32_t k = 0; k < outcome.splits; ++k) to[k] = outcome.first_split[k];
    outcome.first_split = to;
  }
  outcomes[i] = outcome;
}

struct LookRoom {
  KeptRoom<std::byte> input, states;
  KeptRoom<PatchOutcome> outcomes;
  KeptRoom<PieceSplit> requests;
};

// Looks at the boundaries `first` to `end` of the order.
void look_at_batch(const LookOrder& order, std::size_t first, std::size_t end,
                   std::uint64_t most_bytes, LookRoom& room, const Stream& stream) {
  std::vector<LookJob> jobs(end - first);
  tbb::parallel_for(std::size_t{0}, jobs.size(),
                    [&](std::size_t i) { jobs[i] = order.begin(first + i); });
  const LookBatch batch(jobs, most_bytes);
  const auto count = static_cast<std::uint32_t>(batch.looks().size());
  if (count == 0) return;
  std::byte* const input = room.input.take(batch.input_bytes());
  batch.pack(input);
  const DeviceArray<std::byte> device_input(batch.input_bytes(), stream),
      device_states(batch.state_bytes(), stream), work(batch.work_bytes(), stream);
  const DeviceArray<BoundedLook> looks(count, stream);
  const DeviceArray<PatchOutcome> device_outcomes(count, stream);
  const DeviceArray<PieceSplit> device_requests(batch.most_requests(), stream);
  const DeviceArray<std::uint32_t> request_count(1, stream);
  clear(request_count, stream);
  upload_parts({{device_input.data(), input, device_input.bytes()},
                {looks.data(), batch.looks().data(), looks.bytes()}},
               stream);
  launch("look_at_bounded", look_at_bounded,
         over(32 * std::uint64_t{blocks_for(count, kPerWarp)}, kThreads), stream, looks.data(),
         count, LookMemory{device_input.data(), device_states.data(), work.data()},
         device_outcomes.data(), device_requests.data(), request_count.data());
  // Waits before the transfer, not within it, as in mesh_batch().
  wait_asleep(stream);
  const std::uint32_t found = fetch(request_count.data(), stream);
  PatchOutcome* const outcomes = room.outcomes.take(count);
  std::byte* const states = room.states.take(batch.state_bytes());
  PieceSplit* const requests = room.requests.take(found);
  download_parts({{outcomes, device_outcomes.data(), device_outcomes.bytes()},
                  {states, device_states.data(), device_states.bytes()},
                  {requests, device_requests.data(), found * sizeof(PieceSplit)}},
                 stream);
  tbb::parallel_for(std::size_t{0}, std::size_t{count}, [&](std::size_t i) {
    const PatchOutcome& o = outcomes[i];
    if (o.failure != PatchFailure::none) return;
    const auto split = o.splits > 0 ? o.first_split - device_requests.data() : 0;
    order.end(first + batch.job(i), batch.finish(i, states, {requests + split, o.splits}));
  });
}

}  // namespace

void look_at_boundaries(const LookOrder& order, std::uint64_t most_bytes) {
  int device = 0;
  check_cuda(cudaGetDevice(&device), "device");
  const std::size_t batches = block_count(order.count, kBatch),
                    threads = std::min(kHostThreads, batches);
  std::atomic<std::size_t> next = 0;
  run_on_threads(threads, [&](std::size_t) {
    check_cuda(cudaSetDevice(device), "device");
    const Stream stream;
    LookRoom room;
    for (std::size_t b = next++; b < batches; b = next++) {
      look_at_batch(order, b * kBatch, std::min(order.count, (b + 1) * kBatch),
                    most_bytes / threads, room, stream);
    }
  });
}

}  // namespace vdwmesh::mesher

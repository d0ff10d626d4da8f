// Parts are cut into chunks of up to 2 MiB. Several threads take one chunk after another from a
// common counter. Each thread has a "lane": a stream and two page-locked buffers. The device fills
// or reads one buffer while the thread copies between the other and the caller's memory. The lanes
// are kept for later transfers, because locking their pages takes as long as a small transfer.
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>

#include "core/copy_past_caches.hpp"
#include "cuda/memory/run_on_threads.hpp"
#include "cuda/memory/transfer.cuh"

namespace vdwmesh {
namespace {

constexpr std::size_t kChunk = std::size_t{2} << 20;
constexpr std::size_t kChunksPerThread = 3;  // a thread with fewer chunks does not pay
constexpr int kMostThreads = 16;

// A transfer of so many bytes is more than caches hold, 300 MB in all on the largest hosts
// measured. A download then stores past them: where two devices download at once, the memory of the
// host is what bounds them (docs/scale.md).
constexpr std::size_t kBeyondCaches = std::size_t{512} << 20;

void* at_offset(void* memory, std::size_t bytes) { return static_cast<std::byte*>(memory) + bytes; }
const void* at_offset(const void* memory, std::size_t bytes) {
  return static_cast<const std::byte*>(memory) + bytes;
}

// Cuts the parts into chunks where the address of the caller's memory is a multiple of kChunk, the
// size of a large page. So no large page is written for the first time by two threads at once.
template <class Part>
std::vector<Part> cut(const std::vector<Part>& parts) {
  std::vector<Part> chunks;
  for (const Part& part : parts) {
    const auto address = reinterpret_cast<std::uintptr_t>(part.host);
    for (std::size_t at = 0; at < part.bytes;) {
      const std::size_t bytes = std::min(kChunk - (address + at) % kChunk, part.bytes - at);
      Part chunk = part;
      chunk.host = at_offset(part.host, at);
      chunk.device = at_offset(part.device, at);
      chunk.bytes = bytes;
      chunks.push_back(chunk);
      at += bytes;
    }
  }
  return chunks;
}

// A stream and two page-locked buffers, for one thread.
class StagingLane {
 public:
  // Both functions copy chunks until none is left. `next` is the index of the next chunk that no
  // thread has taken; all threads share it. The stream first waits for `ready`, after which the
  // device memory may be used. Uploads fill buffers, by usual stores.

  // `filling` is the chunk on its way from the device to buffers_[side].
  void work(const std::vector<DownloadPart>& chunks, std::atomic<std::size_t>& next,
            cudaEvent_t ready, Stores stores) {
    check_cuda(cudaStreamWaitEvent(stream_.get(), ready), "download");
    std::size_t filling = next++;
    int side = 0;
    if (filling < chunks.size()) fill(chunks[filling], side);
    while (filling < chunks.size()) {
      stream_.wait();
      const DownloadPart& filled = chunks[filling];
      filling = next++;
      if (filling < chunks.size()) fill(chunks[filling], 1 - side);
      copy_bytes(filled.host, buffers_[side].data(), filled.bytes, stores);
      side = 1 - side;
    }
  }

  // sent_[side] has passed when the device has read buffers_[side].
  void work(const std::vector<UploadPart>& chunks, std::atomic<std::size_t>& next,
            cudaEvent_t ready, Stores) {
    check_cuda(cudaStreamWaitEvent(stream_.get(), ready), "upload");
    int side = 0;
    for (std::size_t i = next++; i < chunks.size(); i = next++) {
      sent_[side].wait();
      std::memcpy(buffers_[side].data(), chunks[i].host, chunks[i].bytes);
      check_cuda(cudaMemcpyAsync(chunks[i].device, buffers_[side].data(), chunks[i].bytes,
                                 cudaMemcpyHostToDevice, stream_.get()),
                 "upload");
      sent_[side].record(stream_.get());
      side = 1 - side;
    }
    stream_.wait();
  }

 private:
  void fill(const DownloadPart& chunk, int side) {
    check_cuda(cudaMemcpyAsync(buffers_[side].data(), chunk.device, chunk.bytes,
                               cudaMemcpyDeviceToHost, stream_.get()),
               "download");
  }

  Stream stream_;
  StagingBuffer buffers_[2] = {StagingBuffer(kChunk), StagingBuffer(kChunk)};
  Event sent_[2] = {Event(cudaEventDisableTiming), Event(cudaEventDisableTiming)};
};

// The lanes of a device. One transfer at a time uses them; others wait for the mutex.
class Staging {
 public:
  template <class Part>
  void copy(int device, const std::vector<Part>& chunks, cudaEvent_t ready) {
    const std::lock_guard lock(mutex_);
    // More threads than the caller's loops may have would not copy faster, or not as asked.
    const auto cores = static_cast<std::size_t>(
        std::clamp(tbb::this_task_arena::max_concurrency(), 1, kMostThreads));
    const std::size_t threads = std::clamp<std::size_t>(chunks.size() / kChunksPerThread, 1, cores);
    while (lanes_.size() < threads) lanes_.push_back(std::make_unique<StagingLane>());
    std::size_t bytes = 0;
    for (const Part& chunk : chunks) bytes += chunk.bytes;
    const Stores stores = stores_for(bytes, kBeyondCaches);
    std::atomic<std::size_t> next{0};
    run_on_threads(threads, [&](std::size_t i) {
      check_cuda(cudaSetDevice(device), "device");
      lanes_[i]->work(chunks, next, ready, stores);
    });
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<StagingLane>> lanes_;
};

// The staging of a device, made by the first call. Never destroyed: at the end of the process the
// driver may be gone already.
Staging& staging_of(int device) {
  static std::mutex* const mutex = new std::mutex;
  static auto* const all = new std::map<int, Staging>;
  const std::lock_guard lock(*mutex);
  return (*all)[device];
}

template <class Part>
void transfer(const std::vector<Part>& parts, const Stream& stream) {
  const std::vector<Part> chunks = cut(parts);
  // All parts are empty. The caller expects the stream to be done all the same.
  if (chunks.empty()) return stream.wait();
  int device = 0;
  check_cuda(cudaGetDevice(&device), "device");
  const Event ready(cudaEventDisableTiming);
  ready.record(stream.get());
  staging_of(device).copy(device, chunks, ready.get());
}

}  // namespace

void download_parts(const std::vector<DownloadPart>& parts, const Stream& stream) {
  transfer(parts, stream);
}

void upload_parts(const std::vector<UploadPart>& parts, const Stream& stream) {
  transfer(parts, stream);
}

}  // namespace vdwmesh

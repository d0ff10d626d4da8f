// A WorkBeside takes its stream from a list of free ones, one list for each device, and puts it
// back there. Events order the two streams: the second waits for the first at the beginning, the
// first for the second in the end.
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "cuda/memory/work_beside.cuh"

namespace vdwmesh {
namespace {

// The free streams, by device. Never destroyed: at the end of the process the driver may be gone
// already.
struct FreeStreams {
  std::mutex mutex;
  std::map<int, std::vector<std::unique_ptr<Stream>>> streams;
};
FreeStreams& free_streams() {
  static auto* const all = new FreeStreams;
  return *all;
}

std::unique_ptr<Stream> take_stream(int device) {
  FreeStreams& all = free_streams();
  const std::lock_guard lock(all.mutex);
  std::vector<std::unique_ptr<Stream>>& own = all.streams[device];
  if (own.empty()) return std::make_unique<Stream>();
  std::unique_ptr<Stream> stream = std::move(own.back());
  own.pop_back();
  return stream;
}

void give_back(int device, std::unique_ptr<Stream> stream) {
  FreeStreams& all = free_streams();
  const std::lock_guard lock(all.mutex);
  all.streams[device].push_back(std::move(stream));
}

}  // namespace

WorkBeside::WorkBeside(cudaStream_t stream) : stream_(stream) {
  check_cuda(cudaGetDevice(&device_), "device");
  beside_ = take_stream(device_);
  event_.record(stream_);
  check_cuda(cudaStreamWaitEvent(beside_->get(), event_.get()), "stream");
}

void WorkBeside::join() {
  joined_ = true;
  event_.record(beside_->get());
  check_cuda(cudaStreamWaitEvent(stream_, event_.get()), "stream");
}

WorkBeside::~WorkBeside() {
  if (!joined_ && cudaEventRecord(event_.get(), beside_->get()) == cudaSuccess) {
    cudaStreamWaitEvent(stream_, event_.get());
  }
  give_back(device_, std::move(beside_));
}

}  // namespace vdwmesh

// Work on a second stream, beside that of a first one.
#pragma once

#include <memory>

#include "cuda/memory/device_memory.cuh"

namespace vdwmesh {

// Work beside a stream. The constructor begins it after the work of the stream so far; join() makes
// the stream go on after both, and so does the destructor if join() was not reached. The second
// stream comes from a list of the device's and goes back there, because making one takes as long as
// a small kernel.
class WorkBeside {
 public:
  explicit WorkBeside(cudaStream_t stream);
  ~WorkBeside();
  WorkBeside(const WorkBeside&) = delete;
  WorkBeside& operator=(const WorkBeside&) = delete;

  const Stream& stream() const { return *beside_; }
  void join();

 private:
  cudaStream_t stream_;
  int device_ = 0;
  std::unique_ptr<Stream> beside_;
  Event event_{cudaEventDisableTiming};
  bool joined_ = false;
};

}  // namespace vdwmesh

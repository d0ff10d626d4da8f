// How much memory a run may take unless told otherwise.
#pragma once

#include <cstdint>
#include <optional>

namespace vdwmesh::apps {

// 80 % of the least of the available memory and what the cgroups of this process leave, in bytes,
// divided among `processes` like this one. Without either figure there is no limit.
std::uint64_t default_memory_limit(std::uint64_t processes = 1);

// Makes freed memory stay with the process, for the stages that follow. By default glibc returns
// large blocks to the kernel, which clears every page that it gives out again: that was more than
// half of the time of `vdwmesh mesh`. To be called once, before anything large is allocated.
void keep_freed_memory();

// The largest resident size of this process since the object was made or assigned anew, in bytes;
// memory that was freed before does not count. Empty where the kernel does not let a process reset
// that mark. One object at a time.
class PeakMemory {
 public:
  PeakMemory();
  std::optional<std::uint64_t> bytes() const;

 private:
  bool reset_;
};

}  // namespace vdwmesh::apps

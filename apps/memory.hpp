// Memory of this process: what it keeps, and how much it used at most.
#pragma once

#include <cstdint>
#include <optional>

namespace vdwmesh::apps {

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

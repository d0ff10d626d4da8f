// A driver that has no more device memory.
#pragma once

namespace vdwmesh::testing {

// While it lives every allocation of device memory from a pool is refused, in a program that links
// refused_memory.cpp.
class RefusedMemory {
 public:
  RefusedMemory();
  ~RefusedMemory();
  RefusedMemory(const RefusedMemory&) = delete;
  RefusedMemory& operator=(const RefusedMemory&) = delete;
};

}  // namespace vdwmesh::testing

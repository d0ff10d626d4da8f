// Work in a process of its own, so that its processor seconds and its memory are its own.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace vdwmesh::anchors {

struct Cost {
  double cpu = 0, wall = 0;  // s, the kernel's share included
  double kernel = 0;         // s, of cpu: first touches of pages, for the most part
  std::uint64_t memory = 0;  // bytes at the peak, beyond what the process began with
  std::uint64_t items = 0;   // what the work returned
};

// Calls `work` in a child and returns what it cost. The caller must have no threads running.
// Throws std::runtime_error naming `name` when the child fails.
Cost run_apart(const std::string& name, const std::function<std::uint64_t()>& work);

// The lesser seconds and memory of both.
Cost least(const Cost& a, const Cost& b);

}  // namespace vdwmesh::anchors

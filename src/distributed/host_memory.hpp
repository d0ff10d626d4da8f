// Arrays that all ranks read, kept once on every host.
#pragma once

#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

#include "distributed/ranks.hpp"

namespace vdwmesh {

// Bytes that the ranks of a host have in common. Where the system does not let them, each rank has
// a copy of its own.
class HostMemory {
 public:
  HostMemory() = default;
  // Takes what the first rank has, and nothing of the other ranks. Collective.
  HostMemory(const Ranks& ranks, std::span<const std::byte> contents);
  ~HostMemory();
  HostMemory(HostMemory&& other) noexcept { swap(other); }
  HostMemory& operator=(HostMemory other) noexcept {
    swap(other);
    return *this;
  }

  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  void swap(HostMemory& other) noexcept;

  std::span<const std::byte> bytes_;  // all of own_, or of the mapping
  std::vector<std::byte> own_;
  void* mapping_ = nullptr;
};

// The same for an array. Its elements are aligned as pages or new memory are.
template <class T>
class HostArray {
  static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= __STDCPP_DEFAULT_NEW_ALIGNMENT__);

 public:
  HostArray() = default;
  HostArray(const Ranks& ranks, std::span<const T> contents)
      : memory_(ranks, std::as_bytes(contents)) {}

  std::span<const T> span() const {
    return {reinterpret_cast<const T*>(memory_.bytes().data()), memory_.bytes().size() / sizeof(T)};
  }

 private:
  HostMemory memory_;
};

}  // namespace vdwmesh

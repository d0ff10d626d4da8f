// Arrays that all ranks read, kept once on every host.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <type_traits>
#include <vector>

#include "distributed/ranks.hpp"

namespace vdwmesh {

// Which share of a whole array a rank makes: share `number` of `count`. Who fills it says how it is
// divided, mostly by begin_of_part().
struct ShareOfArray {
  std::uint64_t number, count;
};

// Bytes that the ranks of a host have in common. Where the system does not let them, each rank has
// a copy of its own.
class HostMemory {
 public:
  HostMemory() = default;
  // Takes what the first rank has, and nothing of the other ranks. Collective.
  HostMemory(const Ranks& ranks, std::span<const std::byte> contents);
  // Takes what the ranks of each host make: every rank calls fill(share, bytes), which writes its
  // share to its place among all `size` bytes. So nothing of it is sent. `size` must be the same
  // for all ranks. Throws, on all ranks, what the function throws. Collective.
  using Fill = std::function<void(const ShareOfArray& share, std::span<std::byte> bytes)>;
  HostMemory(const Ranks& ranks, std::uint64_t size, const Fill& fill);
  ~HostMemory();
  HostMemory(HostMemory&& other) noexcept { swap(other); }
  HostMemory& operator=(HostMemory other) noexcept {
    swap(other);
    return *this;
  }

  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::span<std::byte> make_room(const Ranks& ranks, std::uint64_t size);
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
  // An array that the ranks of each host make: fill(share, array) writes the elements of a share.
  template <class Fill>
  HostArray(const Ranks& ranks, std::uint64_t size, const Fill& fill)
      : memory_(ranks, size * sizeof(T),
                [&](const ShareOfArray& share, std::span<std::byte> bytes) {
                  fill(share, std::span(reinterpret_cast<T*>(bytes.data()), size));
                }) {}

  std::span<const T> span() const {
    return {reinterpret_cast<const T*>(memory_.bytes().data()), memory_.bytes().size() / sizeof(T)};
  }

 private:
  HostMemory memory_;
};

}  // namespace vdwmesh

// Buffer<T>: a std::vector<T> whose resize() leaves elements of trivial types uninitialised.
//
// std::vector::resize() writes zeros into new elements. For a large array that is written in full
// right afterwards this costs a second pass through memory. The allocator below makes resize()
// default-initialise new elements instead, and default-initialisation of a trivial type does
// nothing. Such elements have indeterminate values until the caller writes them.
#pragma once

#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace vdwmesh {

template <class T>
struct DefaultInitAllocator : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = DefaultInitAllocator<U>;
  };
  using std::allocator<T>::allocator;

  // resize(n) calls this overload: default-initialisation, without the value-initialising "()".
  template <class U>
  void construct(U* p) noexcept(std::is_nothrow_default_constructible_v<U>) {
    ::new (static_cast<void*>(p)) U;
  }
  // resize(n, value), push_back() and all others construct from arguments as std::allocator does.
  template <class U, class... Args>
  void construct(U* p, Args&&... args) {
    ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
  }
};

template <class T>
using Buffer = std::vector<T, DefaultInitAllocator<T>>;

}  // namespace vdwmesh

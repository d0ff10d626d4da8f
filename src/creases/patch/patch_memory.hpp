// Where the triangulation of one patch keeps its arrays, and who decides what double precision does
// not. The steps of the triangulation are templates of one of these two classes, so the host and
// the device run the same operations in the same order and make the same bits.
//
// - GrowingMemory: arrays grow, and exact arithmetic decides. It fails at nothing. For the host.
// - BoundedMemory: arrays have a fixed capacity, and nothing decides. What does not fit, is not
//   decided or has a small angle is noted as a failure, and somebody else must mesh the patch. For
//   the device.
//
// After a failure the result is worthless, but each step still ends, and reads and writes stay
// inside the arrays: elements that do not fit are left out, and points are not inserted without
// room for all that belongs to them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/host_device.hpp"
#include "creases/arcs/patch_vector.hpp"
#include "creases/plane/plane_predicates.hpp"

namespace vdwmesh {

class GrowingMemory {
 public:
  template <class T>
  using Array = PatchVector<T>;
  static constexpr bool kIsBounded = false;

  bool has_failed() const { return false; }
  void leave_small_angle() const {}
  template <class T>
  bool has_room(const Array<T>&, std::size_t) const {
    return true;
  }
  int undecided_orientation(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) const {
    return exact_orientation(a, b, c);
  }
  int undecided_in_circle(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c,
                          const PlanePoint& d) const {
    return exact_in_circle(a, b, c, d);
  }
};

// What the size of an array depends on. Bounded arrays get their capacity by it (patch_work.hpp).
enum class PatchArray : std::uint8_t {
  circle_rows,     // points of the boundary
  circle_entries,  // pieces
  caps,            // caps
  points,          // points
  plane_points,    // points and corners of the frame
  star_rows,       // points
  triangles,       // triangles
  star_entries,    // three for each triangle
  queue,
  lists,       // as a rule less than triangles
  requests,    // pieces
  insertions,  // only where pieces are inserted
};

// Not simple: the pieces of the boundary meet elsewhere than at their ends, at the first look.
// Small angle: a triangle has one below kFloorOfAngles, which may be below its floor
// (angle_floors.hpp).
enum class PatchFailure : std::uint32_t { none, no_room, undecided, not_simple, small_angle };

// An array in memory of somebody else, with the part of std::vector's interface that the steps use.
template <class T>
class BoundedArray {
 public:
  using value_type = T;
  BoundedArray() = default;
  VDWMESH_HD BoundedArray(T* data, std::uint32_t capacity, PatchFailure* failure)
      : data_(data), failure_(failure), capacity_(capacity) {}

  VDWMESH_HD std::size_t size() const { return size_; }
  VDWMESH_HD std::size_t capacity() const { return capacity_; }
  VDWMESH_HD bool empty() const { return size_ == 0; }
  VDWMESH_HD T* data() { return data_; }
  VDWMESH_HD const T* data() const { return data_; }
  VDWMESH_HD T* begin() { return data_; }
  VDWMESH_HD T* end() { return data_ + size_; }
  VDWMESH_HD const T* begin() const { return data_; }
  VDWMESH_HD const T* end() const { return data_ + size_; }
  VDWMESH_HD T& operator[](std::size_t i) { return data_[i]; }
  VDWMESH_HD const T& operator[](std::size_t i) const { return data_[i]; }
  VDWMESH_HD T& back() { return data_[size_ - 1]; }
  VDWMESH_HD const T& back() const { return data_[size_ - 1]; }

  VDWMESH_HD void clear() { size_ = 0; }
  VDWMESH_HD void pop_back() { --size_; }
  VDWMESH_HD void push_back(const T& value) {
    if (size_ == capacity_) {
      *failure_ = PatchFailure::no_room;
    } else {
      data_[size_++] = value;
    }
  }
  VDWMESH_HD void resize(std::size_t size, const T& value = T{}) {
    while (size_ < size && size_ < capacity_) data_[size_++] = value;
    if (size_ < size) *failure_ = PatchFailure::no_room;
    if (size < size_) size_ = static_cast<std::uint32_t>(size);
  }
  VDWMESH_HD void assign(std::size_t size, const T& value) {
    clear();
    resize(size, value);
  }
  // Replaces the elements by `size` elements of another array.
  VDWMESH_HD void assign(const T* first, const T* last) {
    clear();
    while (first != last) push_back(*first++);
  }

 private:
  T* data_ = nullptr;
  PatchFailure* failure_ = nullptr;
  std::uint32_t size_ = 0, capacity_ = 0;
};

class BoundedMemory {
 public:
  template <class T>
  using Array = BoundedArray<T>;
  static constexpr bool kIsBounded = true;

  BoundedMemory() = default;
  VDWMESH_HD explicit BoundedMemory(PatchFailure* failure) : failure_(failure) {}

  VDWMESH_HD bool has_failed() const { return *failure_ != PatchFailure::none; }
  VDWMESH_HD void leave_small_angle() const { *failure_ = PatchFailure::small_angle; }
  // Whether `count` more elements fit. If not, that is a failure.
  template <class T>
  VDWMESH_HD bool has_room(const Array<T>& array, std::size_t count) const {
    if (array.size() + count <= array.capacity()) return true;
    *failure_ = PatchFailure::no_room;
    return false;
  }
  VDWMESH_HD int undecided_orientation(const PlanePoint&, const PlanePoint&,
                                       const PlanePoint&) const {
    *failure_ = PatchFailure::undecided;
    return 0;
  }
  VDWMESH_HD int undecided_in_circle(const PlanePoint&, const PlanePoint&, const PlanePoint&,
                                     const PlanePoint&) const {
    *failure_ = PatchFailure::undecided;
    return 0;
  }

 private:
  PatchFailure* failure_ = nullptr;
};

// Whether test(i) holds for any i below `count`. Patches ask it of all caps around a point. A
// thread of a device tests all of them: threads that end their loops at different caps would wait
// for each other, and each for its memory, cap after cap.
template <class Memory, class Test>
VDWMESH_HD bool holds_for_any(std::size_t count, const Test& test) {
  bool any = false;
  for (std::size_t i = 0; i < count && (Memory::kIsBounded || !any); ++i) any |= test(i);
  return any;
}

}  // namespace vdwmesh

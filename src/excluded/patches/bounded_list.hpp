// Lists for code that runs on the host with as much memory as it needs, and on a CUDA device in
// memory of fixed size. For the library's own use.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/host_device.hpp"

namespace vdwmesh::excluded {

// A list of at most kMost items. An item beyond that is left out, which is_cut_off() tells.
template <class Item, int kMost>
class BoundedList {
 public:
  VDWMESH_HD void push_back(const Item& item) {
    if (size_ == kMost) {
      is_cut_off_ = true;
    } else {
      items_[size_++] = item;
    }
  }
  VDWMESH_HD void clear() { size_ = 0; }
  // Items that are added have any value.
  VDWMESH_HD void resize(std::size_t size) {
    is_cut_off_ = is_cut_off_ || size > kMost;
    size_ = size > kMost ? kMost : static_cast<int>(size);
  }
  VDWMESH_HD bool is_cut_off() const { return is_cut_off_; }
  VDWMESH_HD bool empty() const { return size_ == 0; }
  VDWMESH_HD std::size_t size() const { return static_cast<std::size_t>(size_); }
  VDWMESH_HD Item& operator[](std::size_t i) { return items_[i]; }
  VDWMESH_HD const Item& operator[](std::size_t i) const { return items_[i]; }
  VDWMESH_HD Item* begin() { return items_; }
  VDWMESH_HD Item* end() { return items_ + size_; }
  VDWMESH_HD const Item* begin() const { return items_; }
  VDWMESH_HD const Item* end() const { return items_ + size_; }

 private:
  Item items_[kMost];
  int size_ = 0;
  bool is_cut_off_ = false;
};

struct HeapLists {
  template <class Item, int>
  using List = std::vector<Item>;

  template <class Item, class Less>
  static void sort(std::vector<Item>& list, const Less& less) {
    std::sort(list.begin(), list.end(), less);
  }
};

struct BoundedLists {
  template <class Item, int kMost>
  using List = BoundedList<Item, kMost>;

  template <class Item, int kMost, class Less>
  VDWMESH_HD static void sort(BoundedList<Item, kMost>& list, const Less& less) {
    Item* const items = list.begin();
    const std::size_t size = list.size();
    for (std::size_t i = 1; i < size; ++i) {
      const Item item = items[i];
      std::size_t place = i;
      for (; place > 0 && less(item, items[place - 1]); --place) items[place] = items[place - 1];
      items[place] = item;
    }
  }
};

}  // namespace vdwmesh::excluded

// Numbers out of bytes, for targets whose input is no text; zeros where the bytes are used up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace vdwmesh::fuzz {

class ByteSource {
 public:
  ByteSource(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  bool empty() const { return rest_.empty(); }
  // low ... high, from one byte.
  int whole(int low, int high) {
    return low + static_cast<int>(next() % static_cast<unsigned>(high - low + 1));
  }
  // In [low, high), one of 2^16 values.
  double real(double low, double high) {
    const unsigned first = next(), second = next();
    return low + (high - low) * (static_cast<double>(256 * first + second) / 65536);
  }
  bool one_in(int n) { return whole(1, n) == n; }

 private:
  unsigned next() {
    if (rest_.empty()) return 0;
    const unsigned byte = rest_.front();
    rest_ = rest_.subspan(1);
    return byte;
  }

  std::span<const std::uint8_t> rest_;
};

}  // namespace vdwmesh::fuzz

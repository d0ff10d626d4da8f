// The encodings of BinaryCIF that make integers of integers, decoded some values at a time, so that
// no array of all values is needed. Internal header of this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace vdwmesh {

// Integers in their order. Anything that does not fit together is a FileFormatError whose message
// begins with `where` (file, table and column).
class IntegerStream {
 public:
  IntegerStream(std::size_t size, std::string where) : size_(size), where_(std::move(where)) {}
  virtual ~IntegerStream() = default;

  std::size_t size() const { return size_; }  // of all values
  // Writes the next `count` values. All calls together take at most size() values.
  virtual void take(std::int32_t* to, std::size_t count) = 0;
  // Call once, when all values have been taken: throws if there is more that does not fit.
  virtual void finish() {}

 protected:
  [[noreturn]] void fail(const std::string& what) const;
  // Throws if the value has more than 32 bits.
  std::int32_t narrow(std::int64_t value) const;

 private:
  std::size_t size_;
  std::string where_;
};
using IntegerSource = std::unique_ptr<IntegerStream>;

// Integers as they stand in the file: elements of a ByteArray of type 1 to 6.
struct Elements {
  std::string_view bytes;
  std::int64_t type;
};
IntegerSource stream_of(const Elements& elements, const std::string& where);

// What IntegerPacking says of its elements, and of the values that they make.
struct Packing {
  std::size_t values;
  bool is_byte, is_unsigned;
};
// Elements of the type that they are said to have, as in all files that are sound, are unpacked
// where they stand; others are taken from the second kind of source.
IntegerSource unpacked(const Packing& packing, const Elements& elements, const std::string& where);
IntegerSource unpacked(const Packing& packing, IntegerSource elements, const std::string& where);

// `pairs` of a value and the number of times it is repeated become `values` values.
IntegerSource repeated(std::size_t values, IntegerSource pairs, const std::string& where);

// The sums of `origin` and all differences so far, of elements of that type. Elements without a
// sign go round: what is above the largest begins again at 0, and below 0 at the largest.
IntegerSource summed(std::int64_t origin, std::int64_t type, IntegerSource differences,
                     const std::string& where);

}  // namespace vdwmesh

// Each stream asks the one behind it for as many elements as it needs: Delta for as many as it is
// asked for, RunLength for some hundred pairs. IntegerPacking reads the bytes of the file itself,
// in blocks without a branch on the elements.
#include "structure/binary_streams.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <optional>
#include <type_traits>

#include "core/buffer.hpp"
#include "core/errors.hpp"

namespace vdwmesh {
namespace {

template <class T>
T element_at(std::string_view bytes, std::size_t index) {
  T element;
  std::memcpy(&element, bytes.data() + index * sizeof(T), sizeof(T));
  return element;
}

template <class T>
class ElementStream : public IntegerStream {
 public:
  ElementStream(std::string_view bytes, const std::string& where)
      : IntegerStream(bytes.size() / sizeof(T), where), bytes_(bytes) {}

  void take(std::int32_t* to, std::size_t count) override {
    for (std::size_t i = 0; i < count; ++i) {
      const T element = element_at<T>(bytes_, next_ + i);
      // Of integers without a sign those above 2^31 - 1 are refused.
      to[i] =
          std::is_same_v<T, std::uint32_t> ? narrow(element) : static_cast<std::int32_t>(element);
    }
    next_ += count;
  }

 private:
  std::string_view bytes_;
  std::size_t next_ = 0;
};

// The elements of IntegerPacking become values: each is the sum of the elements up to the first
// that is not at a limit of its type. Elements are of type T.
template <class T>
class Unpacking {
 public:
  static constexpr std::size_t kBlock = 32;

  Unpacking(std::int32_t lower, std::int32_t upper) : lower_(lower), upper_(upper) {}

  // Takes a block of elements, and writes at most kBlock values to `next`, whose end it returns.
  // Returns null, and has taken none, if a sum has more than 32 bits.
  std::int32_t* take_block(const T* block, std::int32_t* next) {
    if (!is_open_ && !any_at_limit(block)) return std::copy_n(block, kBlock, next);
    // Without branches on what is at a limit: the processor could not foresee them.
    std::int64_t sum = is_open_ ? sum_ : 0, wide = 0;
    bool is_open = is_open_;
    for (std::size_t i = 0; i < kBlock; ++i) {
      sum += block[i];
      const auto value = static_cast<std::int32_t>(sum);
      wide |= sum - value;
      *next = value;
      is_open = is_limit(block[i]);
      next += !is_open;
      sum &= -static_cast<std::int64_t>(is_open);
    }
    if (wide != 0) return nullptr;
    sum_ = sum;
    is_open_ = is_open;
    return next;
  }

  // Takes one element and returns the sum so far, which is a value unless is_open().
  std::int64_t take(std::int32_t element) {
    sum_ = element + (is_open_ ? sum_ : 0);
    is_open_ = is_limit(element);
    return sum_;
  }
  // Whether the last element was at a limit.
  bool is_open() const { return is_open_; }

 private:
  bool is_limit(std::int32_t element) const { return (element == upper_) | (element == lower_); }
  // As wide as the elements, of which the processor compares several at a time.
  bool any_at_limit(const T* block) const {
    T any = 0;
    for (std::size_t i = 0; i < kBlock; ++i)
      any |= static_cast<T>((block[i] == static_cast<T>(upper_)) | is_lower(block[i]));
    return any != 0;
  }
  bool is_lower(T element) const {
    if constexpr (std::is_unsigned_v<T>) return false;
    return element == static_cast<T>(lower_);
  }

  std::int32_t lower_, upper_;
  std::int64_t sum_ = 0;  // of the elements since the last value
  bool is_open_ = false;
};

std::int32_t upper_limit(const Packing& packing) {
  if (packing.is_unsigned) return packing.is_byte ? 0xFF : 0xFFFF;
  return packing.is_byte ? 0x7F : 0x7FFF;
}

// The bytes are elements of type T.
template <class T>
class PackedStream : public IntegerStream {
 public:
  PackedStream(const Packing& packing, std::string_view bytes, const std::string& where)
      : IntegerStream(packing.values, where),
        bytes_(bytes),
        count_(bytes.size() / sizeof(T)),
        // -1: not the limit of any value
        unpacking_(packing.is_unsigned ? -1 : -upper_limit(packing) - 1, upper_limit(packing)) {}

  void take(std::int32_t* to, std::size_t count) override {
    std::int32_t* const end = to + count;
    std::array<T, Unpacking<T>::kBlock> block;  // the bytes stand anywhere in memory
    while (std::min(count_ - next_, static_cast<std::size_t>(end - to)) >= block.size()) {
      std::memcpy(block.data(), bytes_.data() + next_ * sizeof(T), sizeof block);
      std::int32_t* const filled = unpacking_.take_block(block.data(), to);
      if (!filled) break;  // the next loop finds the element
      to = filled;
      next_ += block.size();
    }
    while (to != end) {
      if (next_ == count_) fail_at_end();
      const std::int32_t value = take_element();
      if (!unpacking_.is_open()) *to++ = value;
    }
  }

  // Values behind the last are ignored, but there may be no half one.
  void finish() override {
    while (next_ < count_) {
      take_element();
      if (!unpacking_.is_open()) return;
    }
    if (unpacking_.is_open()) fail_at_end();
  }

 private:
  std::int32_t take_element() {
    return narrow(unpacking_.take(static_cast<std::int32_t>(element_at<T>(bytes_, next_++))));
  }
  [[noreturn]] void fail_at_end() const {
    fail(fmt::format("IntegerPacking gives not the {} values that it should", size()));
  }

  std::string_view bytes_;
  std::size_t count_, next_ = 0;  // elements
  Unpacking<T> unpacking_;
};

// Elements that do not stand in the file as they are.
class DetachedPackedStream : public IntegerStream {
 public:
  DetachedPackedStream(const Packing& packing, IntegerStream& elements, const std::string& where)
      : IntegerStream(packing.values, where), elements_(elements.size()) {
    elements.take(elements_.data(), elements_.size());
    elements.finish();
    const auto* const bytes = reinterpret_cast<const char*>(elements_.data());
    const std::size_t size = elements_.size() * sizeof(std::int32_t);
    packed_.emplace(packing, std::string_view(bytes, size), where);
  }
  void take(std::int32_t* to, std::size_t count) override { packed_->take(to, count); }
  void finish() override { packed_->finish(); }

 private:
  Buffer<std::int32_t> elements_;
  std::optional<PackedStream<std::int32_t>> packed_;
};

class RepeatedStream : public IntegerStream {
 public:
  RepeatedStream(std::size_t values, IntegerSource pairs, const std::string& where)
      : IntegerStream(values, where), pairs_(std::move(pairs)), behind_(pairs_->size()) {
    if (behind_ % 2 != 0) fail("RunLength has a value without its count");
  }

  void take(std::int32_t* to, std::size_t count) override {
    while (count > 0) {
      if (left_ == 0 && !open_run())
        fail(fmt::format("RunLength gives {} values of {}", announced_, size()));
      const std::size_t run = std::min(left_, count);
      // In columns of names nearly all counts are 1.
      if (run == 1)
        *to = value_;
      else
        std::fill_n(to, run, value_);
      to += run;
      count -= run;
      left_ -= run;
    }
  }

  void finish() override {
    open_run();  // of which there is none: counts above those of all values are refused
    pairs_->finish();
  }

 private:
  // Takes pairs up to the next that has values. False if there is none.
  bool open_run() {
    while (left_ == 0) {
      if (next_ == end_ && !refill()) return false;
      value_ = some_[next_];
      const std::int32_t count = some_[next_ + 1];
      next_ += 2;
      if (count < 0 || static_cast<std::size_t>(count) > size() - announced_)
        fail(fmt::format("the counts of RunLength are not those of {} values", size()));
      left_ = static_cast<std::size_t>(count);
      announced_ += left_;
    }
    return true;
  }

  bool refill() {
    end_ = std::min(some_.size(), behind_);
    behind_ -= end_;
    next_ = 0;
    pairs_->take(some_.data(), end_);
    return end_ > 0;
  }

  IntegerSource pairs_;
  std::array<std::int32_t, 512> some_;  // elements of pairs
  std::size_t next_ = 0, end_ = 0;      // of those in some_
  std::size_t behind_;                  // elements that have not been taken yet
  std::int32_t value_ = 0;              // of the current run
  std::size_t left_ = 0;                // values of the current run
  std::size_t announced_ = 0;           // values of all runs so far
};

class SummedStream : public IntegerStream {
 public:
  SummedStream(std::int64_t origin, std::int64_t type, IntegerSource differences,
               const std::string& where)
      : IntegerStream(differences->size(), where),
        sum_(origin),
        kept_(type == 4   ? 0xFF
              : type == 5 ? 0xFFFF
              : type == 6 ? std::int64_t{0xFFFFFFFF}
                          : std::int64_t{-1}),
        differences_(std::move(differences)) {}

  void take(std::int32_t* to, std::size_t count) override {
    differences_->take(to, count);
    std::int64_t sum = sum_;
    for (std::size_t i = 0; i < count; ++i) {
      sum = (sum + to[i]) & kept_;
      to[i] = static_cast<std::int32_t>(sum);
      if (to[i] != sum) narrow(sum);  // which fails
    }
    sum_ = sum;
  }
  void finish() override { differences_->finish(); }

 private:
  std::int64_t sum_;
  const std::int64_t kept_;  // the bits of a sum that its type has
  IntegerSource differences_;
};

}  // namespace

void IntegerStream::fail(const std::string& what) const {
  throw FileFormatError(fmt::format("{}: {}", where_, what));
}

std::int32_t IntegerStream::narrow(std::int64_t value) const {
  using Limits = std::numeric_limits<std::int32_t>;
  if (value < Limits::min() || value > Limits::max())
    fail(fmt::format("the integer {} has more than 32 bits", value));
  return static_cast<std::int32_t>(value);
}

IntegerSource stream_of(const Elements& elements, const std::string& where) {
  switch (elements.type) {
    case 1:
      return std::make_unique<ElementStream<std::int8_t>>(elements.bytes, where);
    case 2:
      return std::make_unique<ElementStream<std::int16_t>>(elements.bytes, where);
    case 3:
      return std::make_unique<ElementStream<std::int32_t>>(elements.bytes, where);
    case 4:
      return std::make_unique<ElementStream<std::uint8_t>>(elements.bytes, where);
    case 5:
      return std::make_unique<ElementStream<std::uint16_t>>(elements.bytes, where);
    default:
      return std::make_unique<ElementStream<std::uint32_t>>(elements.bytes, where);
  }
}

IntegerSource unpacked(const Packing& packing, const Elements& elements, const std::string& where) {
  const std::int64_t type = (packing.is_byte ? 1 : 2) + (packing.is_unsigned ? 3 : 0);
  if (elements.type != type) return unpacked(packing, stream_of(elements, where), where);
  switch (type) {
    case 1:
      return std::make_unique<PackedStream<std::int8_t>>(packing, elements.bytes, where);
    case 2:
      return std::make_unique<PackedStream<std::int16_t>>(packing, elements.bytes, where);
    case 4:
      return std::make_unique<PackedStream<std::uint8_t>>(packing, elements.bytes, where);
    default:
      return std::make_unique<PackedStream<std::uint16_t>>(packing, elements.bytes, where);
  }
}

IntegerSource unpacked(const Packing& packing, IntegerSource elements, const std::string& where) {
  return std::make_unique<DetachedPackedStream>(packing, *elements, where);
}

IntegerSource repeated(std::size_t values, IntegerSource pairs, const std::string& where) {
  return std::make_unique<RepeatedStream>(values, std::move(pairs), where);
}

IntegerSource summed(std::int64_t origin, std::int64_t type, IntegerSource differences,
                     const std::string& where) {
  return std::make_unique<SummedStream>(origin, type, std::move(differences), where);
}

}  // namespace vdwmesh

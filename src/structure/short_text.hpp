// A text that is nearly always short, such as the name of an atom, in 8 bytes.
//
// Up to seven characters stand in the object itself; a longer text is a std::string of its own, to
// which the object points. Both are told apart by the lowest bit: it is 0 in a pointer, and 1 in
// the byte before the characters, which holds their number. A molecule of millions of atoms with
// four texts each thus needs no memory beside its atoms, and copies them without a call.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace vdwmesh {

// Reads as a std::string_view, which lasts as long as the ShortText and its value; compares with
// texts of all kinds, and can be joined to them by +.
class ShortText {
  template <class T>
  using IfOther = std::enable_if_t<std::is_convertible_v<const T&, std::string_view> &&
                                   !std::is_same_v<T, ShortText>>;

 public:
  static constexpr std::size_t kMostInPlace = 7;  // characters

  ShortText() noexcept = default;
  template <class T, class = IfOther<T>>
  ShortText(const T& text) : word_(word_of(text)) {}
  ShortText(const ShortText& other)
      : word_(other.is_in_place() ? other.word_ : word_of(other.view())) {}
  ShortText(ShortText&& other) noexcept : word_(std::exchange(other.word_, kEmpty)) {}
  ShortText& operator=(ShortText other) noexcept {
    std::swap(word_, other.word_);
    return *this;
  }
  ~ShortText() {
    if (!is_in_place()) delete elsewhere();
  }

  std::string_view view() const {
    if (!is_in_place()) return *elsewhere();
    return {reinterpret_cast<const char*>(&word_) + 1, (word_ & 0xFF) >> 1};
  }
  std::string str() const { return std::string(view()); }
  operator std::string_view() const { return view(); }
  operator std::string() const { return str(); }

  bool empty() const { return word_ == kEmpty; }
  std::size_t size() const { return view().size(); }
  const char* begin() const { return view().data(); }
  const char* end() const { return view().data() + size(); }

  // The unused bytes of short texts are 0, so equal ones have equal words.
  friend bool operator==(const ShortText& a, const ShortText& b) {
    return a.word_ == b.word_ || (!a.is_in_place() && a.view() == b.view());
  }
  friend bool operator!=(const ShortText& a, const ShortText& b) { return !(a == b); }
  friend bool operator<(const ShortText& a, const ShortText& b) { return a.view() < b.view(); }
  template <class T, class = IfOther<T>>
  friend bool operator==(const ShortText& a, const T& b) {
    return a.view() == std::string_view(b);
  }
  template <class T, class = IfOther<T>>
  friend bool operator==(const T& a, const ShortText& b) {
    return b == a;
  }
  template <class T, class = IfOther<T>>
  friend bool operator!=(const ShortText& a, const T& b) {
    return !(a == b);
  }
  template <class T, class = IfOther<T>>
  friend bool operator!=(const T& a, const ShortText& b) {
    return !(b == a);
  }
  friend std::string operator+(const ShortText& a, const ShortText& b) {
    return a.str().append(b.view());
  }
  template <class T, class = IfOther<T>>
  friend std::string operator+(const ShortText& a, const T& b) {
    return a.str().append(std::string_view(b));
  }
  template <class T, class = IfOther<T>>
  friend std::string operator+(const T& a, const ShortText& b) {
    return std::string(std::string_view(a)).append(b.view());
  }
  template <class Stream>  // so that <ostream> is not needed here
  friend auto operator<<(Stream& out, const ShortText& text)
      -> decltype(out << std::string_view()) {
    return out << text.view();
  }

 private:
  static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the lowest byte is the first one");
  static_assert(alignof(std::string) > 1, "the lowest bit of a pointer to a std::string is 0");
  static constexpr std::uint64_t kEmpty = 1;

  static std::uint64_t word_of(std::string_view text) {
    if (text.size() > kMostInPlace) return reinterpret_cast<std::uintptr_t>(new std::string(text));
    return letters_of(text.data(), text.size()) << 8 | text.size() << 1 | 1;
  }

  // At most seven characters as bytes of a number, the first in the lowest. From 1 to 3 are the
  // first, middle and last one, from 4 on the first and last four: where they overlap, they agree.
  static std::uint64_t letters_of(const char* text, std::size_t size) {
    const auto letter = [text](std::size_t i) {
      return std::uint64_t{static_cast<unsigned char>(text[i])} << (8 * i);
    };
    if (size == 0) return 0;
    if (size < 4) return letter(0) | letter(size / 2) | letter(size - 1);
    std::uint32_t first = 0, last = 0;
    std::memcpy(&first, text, 4);
    std::memcpy(&last, text + size - 4, 4);
    return first | std::uint64_t{last} << (8 * (size - 4));
  }

  bool is_in_place() const { return (word_ & 1) != 0; }
  std::string* elsewhere() const {
    return reinterpret_cast<std::string*>(static_cast<std::uintptr_t>(word_));
  }

  std::uint64_t word_ = kEmpty;
};

}  // namespace vdwmesh

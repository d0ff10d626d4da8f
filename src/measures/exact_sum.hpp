// A sum of doubles without any rounding: a fixed-point number wide enough for every finite double.
//
// Since addition is exact, the sum does not depend on the order of its terms, nor on how they are
// divided between several sums that are added later. Only the conversion to a double rounds, in the
// direction that the caller chooses. The idea is the long accumulator of U. Kulisch.
//
// An addition costs one to two nanoseconds, of many terms at once half a nanosecond each, and an
// ExactSum takes about 600 bytes. WideSum (core/sum.hpp) is smaller, but its last bits depend on
// the order.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace vdwmesh {

class ExactSum {
 public:
  // A term that is not finite makes every result NaN.
  void add(double term);
  void add(const ExactSum& other);
  // The same as to add the terms one by one, in a third of the instructions. Precondition: the
  // processor rounds to nearest.
  void add(std::span<const double> terms);

  // Appends some doubles whose sum is this one, without rounding: as many as the 32-bit pieces that
  // are not 0, and NaN if a term was not finite. They are far shorter than an ExactSum.
  // Precondition: the size of the sum is below 2^1023.
  void append_terms(std::vector<double>& terms) const;

  // The largest double <= the sum, the smallest double >= the sum, and the double nearest to it
  // (ties to even). They do not depend on the rounding mode of the processor. A sum beyond the
  // range of double has infinity in the direction in which it overflows, unless it rounds towards
  // 0.
  double down() const;
  double up() const;
  double nearest() const;

 private:
  // The sum is limbs_[k] 2^(32 k - 1074) added over all k. Limbs are signed and may overlap: a term
  // changes a limb by less than 2^32, so kMostTerms of them fit 64 bits before carries are
  // propagated. The bits of doubles end at 2^1024, which is bit 2098 here; there is room for more
  // terms of this size than can ever be added.
  static constexpr int kLimbBits = 32, kLowestExponent = -1074;
  static constexpr std::size_t kLimbs = 68;
  static constexpr std::int64_t kMostTerms = std::int64_t{1} << 30;
  enum class Direction { down, up, nearest };

  static constexpr int kKeptBits = 54;  // those of a double and one more

  void propagate_carries();
  bool make_positive();
  double rounded(Direction direction) const;
  int bit_count() const;
  bool bit(int place) const;
  std::uint64_t bits_from(int place) const;  // kKeptBits of them
  bool any_bit_below(int place) const;

  std::array<std::int64_t, kLimbs> limbs_{};
  std::int64_t terms_ = 0;  // since carries were propagated
  bool finite_ = true;
};

// A double is m 2^(e - 1074) with m < 2^53 and e >= 0, for subnormal numbers too. So bit 0 of m has
// the place e among the bits of the sum.
inline void ExactSum::add(double term) {
  constexpr int kMantissaBits = 52, kExponentMask = 0x7ff;
  constexpr std::uint64_t kMantissaMask = (std::uint64_t{1} << kMantissaBits) - 1;
  const auto bits = std::bit_cast<std::uint64_t>(term);
  const auto field = static_cast<int>(bits >> kMantissaBits) & kExponentMask;
  if (field == kExponentMask) {
    finite_ = false;
    return;
  }
  const std::uint64_t hidden = field > 0 ? kMantissaMask + 1 : 0;
  const std::uint64_t mantissa = (bits & kMantissaMask) | hidden;
  const int place = field > 0 ? field - 1 : 0, shift = place % kLimbBits;
  const auto limb = static_cast<std::size_t>(place / kLimbBits);
  constexpr std::uint64_t kLow = 0xffffffffu;
  // The shifted mantissa has up to 84 bits: the low 32 of them, and the others.
  const auto low = static_cast<std::int64_t>((mantissa << shift) & kLow);
  const std::uint64_t rest = mantissa >> (kLimbBits - shift);
  const auto middle = static_cast<std::int64_t>(rest & kLow);
  const auto high = static_cast<std::int64_t>(rest >> kLimbBits);
  const std::int64_t sign = std::signbit(term) ? -1 : 1;
  limbs_[limb] += sign * low;
  limbs_[limb + 1] += sign * middle;
  limbs_[limb + 2] += sign * high;
  if (++terms_ == kMostTerms) propagate_carries();
}

}  // namespace vdwmesh

// ExactSum: decomposes doubles into 32-bit pieces and adds these as integers. It rounds once, when
// the sum is asked for.
#include "arrangement/exact_sum.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace vdwmesh {
namespace {

constexpr int kMantissaBits = 52, kExponentMask = 0x7ff;
constexpr std::uint64_t kMantissaMask = (std::uint64_t{1} << kMantissaBits) - 1;

}  // namespace

// A double is m 2^(e - 1074) with m < 2^53 and e >= 0, for subnormal numbers too. So bit 0 of m has
// the place e among the bits of the sum.
void ExactSum::add(double term) {
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

void ExactSum::add(const ExactSum& other) {
  ExactSum carried = other;
  carried.propagate_carries();
  propagate_carries();
  for (std::size_t k = 0; k < kLimbs; ++k) limbs_[k] += carried.limbs_[k];
  finite_ = finite_ && other.finite_;
  ++terms_;
}

// Afterwards all limbs but the last are in [0, 2^32), and the last has the sign of the sum. The
// right shift of a negative number rounds down, as the carry of a remainder >= 0 must.
void ExactSum::propagate_carries() {
  constexpr std::int64_t kLow = 0xffffffff;
  for (std::size_t k = 0; k + 1 < kLimbs; ++k) {
    limbs_[k + 1] += limbs_[k] >> kLimbBits;
    limbs_[k] &= kLow;
  }
  terms_ = 1;
}

// Makes the sum positive, takes its highest 54 bits and whether any lower bit is set, and rounds
// them to 53 bits. A sum of fewer bits is a double already.
double ExactSum::rounded(Direction direction) const {
  if (!finite_) return std::numeric_limits<double>::quiet_NaN();
  ExactSum sum = *this;
  sum.propagate_carries();
  const bool negative = sum.limbs_.back() < 0;
  if (negative) {
    for (std::int64_t& limb : sum.limbs_) limb = -limb;
    sum.propagate_carries();
  }
  const int cut = std::max(0, sum.bit_count() - kKeptBits);
  std::uint64_t kept = sum.bits_from(cut);
  int exponent = cut + kLowestExponent;
  const bool towards_infinity = (direction == Direction::up) != negative;
  if (kept >> (kKeptBits - 1) != 0) {
    const bool half = (kept & 1) != 0, odd = (kept & 2) != 0, lost = sum.any_bit_below(cut);
    const bool away = direction == Direction::nearest ? half && (lost || odd)
                                                      : (half || lost) && towards_infinity;
    kept = (kept >> 1) + (away ? 1 : 0);
    ++exponent;
  }
  double size = std::ldexp(static_cast<double>(kept), exponent);
  if (std::isinf(size) && direction != Direction::nearest && !towards_infinity) {
    size = std::numeric_limits<double>::max();
  }
  return negative ? -size : size;
}

// The number of bits of a sum >= 0 without carries.
int ExactSum::bit_count() const {
  for (std::size_t k = kLimbs; k-- > 0;) {
    if (limbs_[k] == 0) continue;
    const auto highest = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(limbs_[k])));
    return kLimbBits * static_cast<int>(k) + highest;
  }
  return 0;
}

bool ExactSum::bit(int place) const {
  const auto limb = std::min(static_cast<std::size_t>(place / kLimbBits), kLimbs - 1);
  return ((limbs_[limb] >> (place - kLimbBits * static_cast<int>(limb))) & 1) != 0;
}

std::uint64_t ExactSum::bits_from(int place) const {
  std::uint64_t bits = 0;
  for (int k = 0; k < kKeptBits; ++k) bits |= std::uint64_t{bit(place + k)} << k;
  return bits;
}

bool ExactSum::any_bit_below(int place) const {
  const auto whole = static_cast<std::size_t>(place / kLimbBits);
  for (std::size_t k = 0; k < whole; ++k) {
    if (limbs_[k] != 0) return true;
  }
  return (limbs_[whole] & ((std::int64_t{1} << (place % kLimbBits)) - 1)) != 0;
}

double ExactSum::down() const { return rounded(Direction::down); }
double ExactSum::up() const { return rounded(Direction::up); }
double ExactSum::nearest() const { return rounded(Direction::nearest); }

}  // namespace vdwmesh

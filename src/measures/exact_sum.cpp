// ExactSum: decomposes doubles into 32-bit pieces and adds these as integers. It rounds once, when
// the sum is asked for. Many terms are first added up a chunk at a time, without rounding either,
// to three doubles (ExtractVector of S. M. Rump, T. Ogita and S. Oishi, "Accurate floating-point
// summation I", SIAM J. Sci. Comput. 31 (2008) 189).
#include "measures/exact_sum.hpp"

#include <algorithm>
#include <limits>

#include "core/lanes/lanes.hpp"
#include "core/lanes/multiversion.hpp"

namespace vdwmesh {
namespace {

// Terms of a chunk: fewer than 2^kChunkBits - 2.
constexpr std::size_t kChunk = 512;
constexpr int kChunkBits = 10;
// The largest term of a chunk is in this range, so that nothing overflows or underflows.
constexpr double kLeastMost = 0x1p-700, kMostMost = 0x1p900;

struct ThreeParts {
  double sums[3];
  bool is_all;  // whether they add up to the terms; if not, they mean nothing
};

// With sigma a power of two of at least 2^kChunkBits times the largest |x|, (sigma + x) - sigma is
// the part of x above the last bit of sigma. The parts of all terms are multiples of this bit and
// add up exactly; what is left of each x is exact too, and at most sigma 2^-53. So three steps take
// all bits from the largest term's down to 100 places below, and hardly ever leave anything.
VDWMESH_MULTIVERSION ThreeParts add_chunk(std::span<const double> terms) {
  double padded[kChunk];
  std::copy(terms.begin(), terms.end(), padded);
  const std::size_t count = (terms.size() + kLanes - 1) / kLanes * kLanes;
  std::fill(padded + terms.size(), padded + count, 0.0);
  Lanes most{};
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Lanes x = lanes_at(padded + i), size = x < 0 ? -x : x;
    most = size > most ? size : most;
  }
  const double largest = largest_of(most);
  if (!(largest >= kLeastMost && largest <= kMostMost)) return {{}, false};
  const double sigma = std::ldexp(1.0, std::ilogb(largest) + 1 + kChunkBits);
  const Lanes high = all_lanes(sigma), middle = all_lanes(sigma * 0x1p-43),
              low = all_lanes(sigma * 0x1p-86);  // 43 = 53 - kChunkBits
  Lanes sums[3]{}, left{};
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Lanes x = lanes_at(padded + i);
    const Lanes a = (high + x) - high, after_a = x - a;
    const Lanes b = (middle + after_a) - middle, after_b = after_a - b;
    const Lanes c = (low + after_b) - low, after_c = after_b - c;
    sums[0] += a;
    sums[1] += b;
    sums[2] += c;
    left += after_c < 0 ? -after_c : after_c;
  }
  ThreeParts parts{};
  double not_added = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    for (std::size_t k = 0; k < 3; ++k) parts.sums[k] += sums[k][lane];
    not_added += left[lane];
  }
  parts.is_all = not_added == 0;  // not so if a term is NaN
  return parts;
}

}  // namespace

void ExactSum::add(std::span<const double> terms) {
  constexpr std::size_t kFew = 16;
  while (!terms.empty()) {
    const std::span<const double> chunk = terms.first(std::min(kChunk, terms.size()));
    terms = terms.subspan(chunk.size());
    const ThreeParts parts = chunk.size() > kFew ? add_chunk(chunk) : ThreeParts{{}, false};
    for (const double term : parts.is_all ? std::span<const double>(parts.sums) : chunk) add(term);
  }
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

// A limb of 32 bits at its place is a double.
void ExactSum::append_terms(std::vector<double>& terms) const {
  if (!finite_) {
    terms.push_back(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  ExactSum sum = *this;
  const double sign = sum.make_positive() ? -1 : 1;
  for (std::size_t k = 0; k < kLimbs; ++k) {
    if (sum.limbs_[k] == 0) continue;
    terms.push_back(std::ldexp(sign * static_cast<double>(sum.limbs_[k]),
                               kLimbBits * static_cast<int>(k) + kLowestExponent));
  }
}

// Returns whether the sum was negative. Afterwards there are no carries.
bool ExactSum::make_positive() {
  propagate_carries();
  if (limbs_.back() >= 0) return false;
  for (std::int64_t& limb : limbs_) limb = -limb;
  propagate_carries();
  return true;
}

// Makes the sum positive, takes its highest 54 bits and whether any lower bit is set, and rounds
// them to 53 bits. A sum of fewer bits is a double already.
double ExactSum::rounded(Direction direction) const {
  if (!finite_) return std::numeric_limits<double>::quiet_NaN();
  ExactSum sum = *this;
  const bool negative = sum.make_positive();
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

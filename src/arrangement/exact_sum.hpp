// A sum of doubles without any rounding: a fixed-point number wide enough for every finite double.
//
// Since addition is exact, the sum does not depend on the order of its terms, nor on how they are
// divided between several sums that are added later. Only the conversion to a double rounds, in the
// direction that the caller chooses. The idea is the long accumulator of U. Kulisch.
//
// An addition costs some nanoseconds, and an ExactSum takes about 600 bytes. WideSum (core/sum.hpp)
// is smaller and faster, but its last bits depend on the order.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace vdwmesh {

class ExactSum {
 public:
  // A term that is not finite makes every result NaN.
  void add(double term);
  void add(const ExactSum& other);

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
  double rounded(Direction direction) const;
  int bit_count() const;
  bool bit(int place) const;
  std::uint64_t bits_from(int place) const;  // kKeptBits of them
  bool any_bit_below(int place) const;

  std::array<std::int64_t, kLimbs> limbs_{};
  std::int64_t terms_ = 0;  // since carries were propagated
  bool finite_ = true;
};

}  // namespace vdwmesh

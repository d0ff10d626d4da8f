// WideInterval: each operation computes its lower end rounded down and its upper end rounded up,
// from those ends of its arguments at which the result is least and greatest.
#include "measures/certificate/wide_interval.hpp"

#include <algorithm>
#include <array>

namespace vdwmesh::certificate {
namespace {

thread_local int working_bits = 64;

}  // namespace

Precision::Precision(int bits) : before_(working_bits) { working_bits = bits; }
// MPFR keeps constants for each thread. Threads end without notice, so they are given back here.
Precision::~Precision() {
  working_bits = before_;
  mpfr_free_cache2(MPFR_FREE_LOCAL_CACHE);
}

WideInterval::WideInterval() : WideInterval(0.0) {}

WideInterval::WideInterval(double value) : WideInterval(Interval(value)) {}

// A double has 53 bits, and fewer bits are never asked for; if they were, the ends would be rounded
// outward.
WideInterval::WideInterval(const Interval& x) {
  mpfr_init2(low_, working_bits);
  mpfr_init2(high_, working_bits);
  mpfr_set_d(low_, x.inf(), MPFR_RNDD);
  mpfr_set_d(high_, x.sup(), MPFR_RNDU);
}

WideInterval::WideInterval(const WideInterval& other) {
  mpfr_init2(low_, mpfr_get_prec(other.low_));
  mpfr_init2(high_, mpfr_get_prec(other.high_));
  mpfr_set(low_, other.low_, MPFR_RNDD);
  mpfr_set(high_, other.high_, MPFR_RNDU);
}

WideInterval& WideInterval::operator=(const WideInterval& other) {
  if (this == &other) return *this;
  mpfr_set_prec(low_, mpfr_get_prec(other.low_));
  mpfr_set_prec(high_, mpfr_get_prec(other.high_));
  mpfr_set(low_, other.low_, MPFR_RNDD);
  mpfr_set(high_, other.high_, MPFR_RNDU);
  return *this;
}

WideInterval::~WideInterval() {
  mpfr_clear(low_);
  mpfr_clear(high_);
}

WideInterval operator+(const WideInterval& a, const WideInterval& b) {
  WideInterval sum;
  mpfr_add(sum.low_, a.low_, b.low_, MPFR_RNDD);
  mpfr_add(sum.high_, a.high_, b.high_, MPFR_RNDU);
  return sum;
}

WideInterval operator-(const WideInterval& a, const WideInterval& b) {
  WideInterval difference;
  mpfr_sub(difference.low_, a.low_, b.high_, MPFR_RNDD);
  mpfr_sub(difference.high_, a.high_, b.low_, MPFR_RNDU);
  return difference;
}

// The ends of the product are among the four products of ends.
WideInterval operator*(const WideInterval& a, const WideInterval& b) {
  WideInterval product, other;
  mpfr_mul(product.low_, a.low_, b.low_, MPFR_RNDD);
  mpfr_mul(product.high_, a.low_, b.low_, MPFR_RNDU);
  const std::array<std::array<mpfr_srcptr, 2>, 3> factors{
      {{a.low_, b.high_}, {a.high_, b.low_}, {a.high_, b.high_}}};
  for (const auto& [f, g] : factors) {
    mpfr_mul(other.low_, f, g, MPFR_RNDD);
    mpfr_mul(other.high_, f, g, MPFR_RNDU);
    mpfr_min(product.low_, product.low_, other.low_, MPFR_RNDD);
    mpfr_max(product.high_, product.high_, other.high_, MPFR_RNDU);
  }
  return product;
}

WideInterval operator/(const WideInterval& a, const WideInterval& b) {
  WideInterval inverse;
  if (mpfr_sgn(b.low_) <= 0 && mpfr_sgn(b.high_) >= 0) {
    mpfr_set_inf(inverse.low_, -1);
    mpfr_set_inf(inverse.high_, 1);
    return inverse;
  }
  mpfr_ui_div(inverse.low_, 1, b.high_, MPFR_RNDD);
  mpfr_ui_div(inverse.high_, 1, b.low_, MPFR_RNDU);
  return a * inverse;
}

WideInterval square(const WideInterval& a) {
  WideInterval result;
  const bool low_is_nearer = mpfr_cmpabs(a.low_, a.high_) <= 0;
  const mpfr_srcptr near = low_is_nearer ? a.low_ : a.high_, far = low_is_nearer ? a.high_ : a.low_;
  const bool across_zero = mpfr_sgn(a.low_) <= 0 && mpfr_sgn(a.high_) >= 0;
  if (!across_zero) mpfr_sqr(result.low_, near, MPFR_RNDD);
  mpfr_sqr(result.high_, far, MPFR_RNDU);
  return result;
}

WideInterval at_least_zero(const WideInterval& a) {
  WideInterval result;
  if (mpfr_sgn(a.low_) > 0) mpfr_set(result.low_, a.low_, MPFR_RNDD);
  if (mpfr_nan_p(a.high_) != 0) mpfr_set_inf(result.high_, 1);
  if (mpfr_sgn(a.high_) > 0) mpfr_set(result.high_, a.high_, MPFR_RNDU);
  return result;
}

WideInterval root(const WideInterval& square) {
  WideInterval result = at_least_zero(square);
  mpfr_sqrt(result.low_, result.low_, MPFR_RNDD);
  mpfr_sqrt(result.high_, result.high_, MPFR_RNDU);
  return result;
}

WideInterval pi(const WideInterval&) {
  WideInterval result;
  mpfr_const_pi(result.low_, MPFR_RNDD);
  mpfr_const_pi(result.high_, MPFR_RNDU);
  return result;
}

// On the upper half plane the angle falls with x. It grows with y if x > 0, and falls with y if
// x < 0. So its least value is at the upper end of x, and its greatest at the lower end. The
// zero vector has no angle; where it is an end, 0 and π are the bounds.
WideInterval angle(const WideInterval& y_or_less, const WideInterval& x) {
  const WideInterval y = at_least_zero(y_or_less);
  WideInterval result = pi(x);
  mpfr_atan2(result.low_, mpfr_sgn(x.high_) > 0 ? y.low_ : y.high_, x.high_, MPFR_RNDD);
  if (mpfr_sgn(x.high_) == 0 && mpfr_sgn(y.high_) == 0) mpfr_set_zero(result.low_, 1);
  const mpfr_srcptr highest = mpfr_sgn(x.low_) < 0 ? y.low_ : y.high_;
  const bool zero = mpfr_sgn(x.low_) == 0 && mpfr_sgn(highest) == 0;
  if (!zero) mpfr_atan2(result.high_, highest, x.low_, MPFR_RNDU);
  return result;
}

// Comparisons with NaN are false, so an end that is NaN is replaced.
WideInterval within(double lower, double upper, const WideInterval& x) {
  WideInterval result(Interval(lower, upper));
  if (mpfr_greater_p(x.low_, result.low_)) mpfr_set(result.low_, x.low_, MPFR_RNDD);
  if (mpfr_less_p(x.high_, result.high_)) mpfr_set(result.high_, x.high_, MPFR_RNDU);
  if (mpfr_greater_p(result.low_, result.high_)) mpfr_swap(result.low_, result.high_);
  return result;
}

Interval enclosure(const WideInterval& a) {
  return {mpfr_get_d(a.low_, MPFR_RNDD), mpfr_get_d(a.high_, MPFR_RNDU)};
}

}  // namespace vdwmesh::certificate

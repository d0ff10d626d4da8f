// Intervals with ends of any number of bits, for what doubles leave too wide. The ends are numbers
// of MPFR, which rounds every operation correctly in the direction asked for; the rounding mode of
// the processor does not matter, and neither overflow nor underflow is to be feared.
#pragma once

#include <mpfr.h>

#include "measures/certificate/interval.hpp"

namespace vdwmesh::certificate {

// While one lives, intervals that this thread makes have ends of so many bits.
class Precision {
 public:
  explicit Precision(int bits);
  ~Precision();
  Precision(const Precision&) = delete;
  Precision& operator=(const Precision&) = delete;

 private:
  int before_;
};

class WideInterval {
 public:
  WideInterval();  // 0
  WideInterval(double value);
  WideInterval(const Interval& x);  // exactly these ends
  WideInterval(const WideInterval& other);
  WideInterval& operator=(const WideInterval& other);
  ~WideInterval();

  friend WideInterval operator+(const WideInterval& a, const WideInterval& b);
  friend WideInterval operator-(const WideInterval& a, const WideInterval& b);
  friend WideInterval operator-(const WideInterval& a) { return WideInterval(0.0) - a; }
  friend WideInterval operator*(const WideInterval& a, const WideInterval& b);
  // All numbers, if b contains 0.
  friend WideInterval operator/(const WideInterval& a, const WideInterval& b);
  friend WideInterval square(const WideInterval& a);
  friend WideInterval at_least_zero(const WideInterval& a);
  friend WideInterval root(const WideInterval& square);
  friend WideInterval pi(const WideInterval&);
  friend WideInterval angle(const WideInterval& y, const WideInterval& x);
  friend WideInterval within(double lower, double upper, const WideInterval& x);

  // The smallest interval of doubles around it.
  friend Interval enclosure(const WideInterval& a);
  friend double middle(const WideInterval& a) { return middle(enclosure(a)); }

 private:
  mpfr_t low_, high_;
};

}  // namespace vdwmesh::certificate

// Compensated summation: a sum of doubles with about 106 bits of working precision.
//
// The sum is an unevaluated pair high_ + low_. Knuth's TwoSum computes the rounding error of each
// addition to high_ exactly, and low_ collects these errors (algorithm Sum2 of T. Ogita, S. M. Rump
// and S. Oishi, SIAM J. Sci. Comput. 26 (2005) 1955). A total of 10^6 terms of one sign is correct
// in every digit of a double. The result still depends on the order of the terms in its last bits,
// so callers add in an order that does not depend on the number of threads.
#pragma once

namespace vdwmesh {

class WideSum {
 public:
  void add(double term) {
    const double sum = high_ + term;
    const double part = sum - high_;
    // `part` is the share of the term that the rounded sum contains, and sum - part the share of
    // high_. The two brackets are what both lost; together they are the exact rounding error.
    low_ += (high_ - (sum - part)) + (term - part);
    high_ = sum;
  }
  void add(const WideSum& other) {
    add(other.high_);
    low_ += other.low_;
  }
  double value() const { return high_ + low_; }

 private:
  double high_ = 0;  // the plain sum in double
  double low_ = 0;   // the sum of the rounding errors of high_
};

}  // namespace vdwmesh

// Wide accumulation: the sum is carried as an unevaluated pair of doubles (Knuth's TwoSum), about
// 106 bits, so totals over 10^6 terms keep every digit of a double.
#pragma once

namespace vdwmesh {

class WideSum {
 public:
  void add(double term) {
    const double sum = high_ + term;
    const double part = sum - high_;
    low_ += (high_ - (sum - part)) + (term - part);
    high_ = sum;
  }
  void add(const WideSum& other) {
    add(other.high_);
    low_ += other.low_;
  }
  double value() const { return high_ + low_; }

 private:
  double high_ = 0;
  double low_ = 0;
};

}  // namespace vdwmesh

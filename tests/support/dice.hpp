// Random numbers of a fixed seed, the same everywhere (the standard leaves distributions open).
#pragma once

#include <random>

namespace vdwmesh::testing {

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double real(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }
  int whole(int low, int high) {
    return low + static_cast<int>(random_() % static_cast<unsigned>(high - low + 1));
  }
  bool one_in(int n) { return whole(1, n) == 1; }

 private:
  std::mt19937 random_;
};

}  // namespace vdwmesh::testing

// The sign of the volume of a tetrahedron without rounding error, for host and device. It is asked
// for where rounding leaves the sign open, which is rare.
//
// The volume is a sum of products of differences of coordinates. Sum, difference and product of two
// doubles are each the sum of two doubles, the rounded result and its error, exactly (T. J. Dekker,
// Numer. Math. 18 (1971) 224). So the volume is a sum of 192 doubles, which are added without error
// by growing an expansion (J. R. Shewchuk, Discrete Comput. Geom. 18 (1997) 305). Exact as long as
// nothing overflows or underflows: for points within 1e30 Å whose differences are 0 or above 1e-90
// Å.
#pragma once

#include <cmath>

#include "core/host_device.hpp"
#include "core/vec3.hpp"

namespace vdwmesh {

// `high` + `low` exactly, where `high` is the rounded value.
struct ExactPair {
  double high, low;
};

VDWMESH_HD inline ExactPair exact_sum(double a, double b) {
  const double sum = a + b, of_b = sum - a;
  return {sum, (a - (sum - of_b)) + (b - of_b)};
}

VDWMESH_HD inline ExactPair exact_product(double a, double b) {
  using std::fma;
  const double product = a * b;
  return {product, fma(a, b, -product)};
}

// A sum of doubles without rounding error: the terms are in order of magnitude, the smallest first,
// not zero, and no two of them have bits in common places. So the last one has the sum's sign.
class ExactSumOfTerms {
 public:
  // Not inlined, nor is exact_orientation(): both are rarely called, and device code with all
  // their loops unrolled would take minutes to compile.
  VDWMESH_HD [[gnu::noinline]] void add(double term) {
    int kept = 0;
    for (int i = 0; i < count_; ++i) {
      const ExactPair sum = exact_sum(term, terms_[i]);
      if (sum.low != 0) terms_[kept++] = sum.low;
      term = sum.high;
    }
    if (term != 0 && kept == kRoom) {
      terms_[1] += terms_[0];
      for (int i = 1; i < kept; ++i) terms_[i - 1] = terms_[i];
      --kept;
    }
    if (term != 0) terms_[kept++] = term;
    count_ = kept;
  }
  VDWMESH_HD int sign() const {
    if (count_ == 0) return 0;
    return terms_[count_ - 1] > 0 ? 1 : -1;
  }

 private:
  static constexpr int kRoom = 64;

  double terms_[kRoom];
  int count_ = 0;
};

// Adds a b c to the sum.
VDWMESH_HD inline void add_product(double a, double b, double c, ExactSumOfTerms& sum) {
  const ExactPair ab = exact_product(a, b);
  const ExactPair high = exact_product(ab.high, c), low = exact_product(ab.low, c);
  sum.add(low.low);
  sum.add(low.high);
  sum.add(high.low);
  sum.add(high.high);
}

// 1 if a, b, c run counter-clockwise as seen from d, -1 if clockwise, 0 if all lie in a plane.
VDWMESH_HD [[gnu::noinline]] inline int exact_orientation(const Vec3d& a, const Vec3d& b,
                                                          const Vec3d& c, const Vec3d& d) {
  ExactPair edge[3][3];
  for (int axis = 0; axis < 3; ++axis) {
    edge[0][axis] = exact_sum(b[axis], -a[axis]);
    edge[1][axis] = exact_sum(c[axis], -a[axis]);
    edge[2][axis] = exact_sum(d[axis], -a[axis]);
  }
  ExactSumOfTerms sum;
  for (int x = 0; x < 3; ++x) {
    for (int turn = 1; turn < 3; ++turn) {
      const int y = (x + turn) % 3, z = (x + 3 - turn) % 3;
      const double sign = turn == 1 ? 1 : -1;
      for (int part = 0; part < 8; ++part) {
        const ExactPair &u = edge[0][x], &v = edge[1][y], &w = edge[2][z];
        add_product(sign * ((part & 1) != 0 ? u.high : u.low), (part & 2) != 0 ? v.high : v.low,
                    (part & 4) != 0 ? w.high : w.low, sum);
      }
    }
  }
  return sum.sign();
}

}  // namespace vdwmesh

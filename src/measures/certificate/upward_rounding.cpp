// with_rounding(): sets the rounding mode for the time of a call. It must not be compiled together
// with its callers; see the header.
#include "measures/certificate/upward_rounding.hpp"

#include <CGAL/FPU.h>

#include "core/errors.hpp"

namespace vdwmesh::certificate {

void call_rounding(RoundingMode mode, void (*function)(void*), void* argument) {
  const CGAL::Protect_FPU_rounding<true> protection(
      mode == RoundingMode::upward ? CGAL_FE_UPWARD : CGAL_FE_TONEAREST);
  function(argument);
}

// 1 + 2^-60 is 1 unless it is rounded upward, and so is (1 + 2^-30)^2 - 2^-29. The numbers are
// volatile, so that the processor computes with them and not the compiler.
void require_upward_rounding() {
  volatile double one = 1, tiny = 0x1p-60, factor = 1 + 0x1p-30, below = -1;
  const volatile double sum = one + tiny, product = factor * factor, difference = below + tiny;
  if (sum > 1 && product > 1 + 0x1p-29 && difference > -1) return;
  throw InternalError(
      "the processor, or what stands for it, does not round upward when asked to: there can be no "
      "certificate");
}

}  // namespace vdwmesh::certificate

// Runs a function while the processor rounds upward, as intervals of doubles need.
//
// The mode belongs to the thread, and is what it was before when the call returns or throws. The
// compiler knows nothing of the mode: it might move an addition across the place where the mode
// changes. So the function is called through a pointer that the compiler cannot follow: this
// file's code is compiled apart from the code that computes, and that code is compiled with
// -frounding-math, so that it is not folded into constants either.
#pragma once

#include <type_traits>

namespace vdwmesh::certificate {

// Intervals need `upward`. The usual mode, in which MPFR is called, breaks them; tests compute them
// in it to see that broken rounding is noticed.
enum class RoundingMode { upward, to_nearest };

// Calls function(argument) in this mode.
void call_rounding(RoundingMode mode, void (*function)(void*), void* argument);

// The same for a function object without arguments and result.
template <class Function>
void with_rounding(RoundingMode mode, Function&& function) {
  call_rounding(
      mode, [](void* f) { (*static_cast<std::remove_reference_t<Function>*>(f))(); }, &function);
}

// Throws InternalError if sums and products are not rounded upward in this thread at this moment,
// for example because an emulator of the processor ignores the mode.
void require_upward_rounding();

}  // namespace vdwmesh::certificate

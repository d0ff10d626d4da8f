#pragma once

#include "core/errors.hpp"

namespace vdwmesh {

// Curves along which patches of a surface meet lie too close to be told apart at the lengths asked
// for. Others may do.
class CurvesTooClose : public LimitExceeded {
  using LimitExceeded::LimitExceeded;
};

}  // namespace vdwmesh

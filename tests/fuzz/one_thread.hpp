// Fuzzers run as many processes as there are cores; each input is small.
#pragma once

#include <tbb/global_control.h>

namespace vdwmesh::fuzz {

class OneThread {
 private:
  tbb::global_control control_{tbb::global_control::max_allowed_parallelism, 1};
};

}  // namespace vdwmesh::fuzz

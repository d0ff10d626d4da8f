// What libFuzzer and replay.cpp call with every input.
#include <tbb/global_control.h>

#include "fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Fuzzers run as many processes as there are cores; each input is small.
  static const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  vdwmesh::fuzz::run_input(data, size);
  return 0;
}

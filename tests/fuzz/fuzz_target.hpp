// What the fuzz targets share. A target hands some bytes to a piece of the library that must cope
// with any bytes, and stops the program where a promise is broken. The same source makes a fuzzer
// (clang, -fsanitize=fuzzer) and a program that replays files (replay.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "core/errors.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace vdwmesh::fuzz {

// What each target defines: one input.
void run_input(const std::uint8_t* data, std::size_t size);

inline void require(bool holds, const char* promise) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", promise);
  std::abort();
}

// Runs `use`, which may refuse its input by the library's own exceptions, in one line. Any other
// exception leaves, and the fuzzer counts it as a crash.
template <class Use>
void allow_refusal(Use&& use) {
  try {
    use();
  } catch (const Error& error) {
    const std::string_view message = error.what();
    require(!message.empty(), "a refusal says why");
    require(message.find_first_of("\r\n") == std::string_view::npos, "a refusal is one line");
  }
}

inline std::string_view as_text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace vdwmesh::fuzz

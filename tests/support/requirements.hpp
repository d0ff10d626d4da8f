// What a test does where the machine lacks something that the test needs. It skips and names what
// is missing. It fails instead where an environment variable says that the thing must be there:
//
//   VDWMESH_REQUIRE_SHARED    the structures and references beside the project
//   VDWMESH_REQUIRE_PACKAGES  the programs and modules of Debian packages
//   VDWMESH_REQUIRE_EGL       drawing
//   VDWMESH_REQUIRE_CUDA      a CUDA device
//
// Continuous integration sets the ones it can fulfil, and tests/allowed_skips.csv lists every other
// skip that it accepts. tests/cli/program.py is the counterpart for tests in Python.
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace vdwmesh::testing {

// An unset variable, an empty one and "0" require nothing.
bool is_required(const char* variable);

// Whether a folder of $PATH holds an executable of this name.
bool has_program(const std::string& name);

}  // namespace vdwmesh::testing

// Ends the running test because something is missing: a failure where `variable` requires it,
// otherwise a skip.
#define VDWMESH_MISSING(variable, what)                  \
  do {                                                   \
    if (::vdwmesh::testing::is_required(variable)) {     \
      FAIL() << (variable) << " is set, but " << (what); \
    } else {                                             \
      GTEST_SKIP() << (what);                            \
    }                                                    \
  } while (false)

// For tests that run another program as a witness. `package` is the Debian package it comes with.
#define VDWMESH_NEEDS_PROGRAM(program, package)                                                \
  do {                                                                                         \
    if (!::vdwmesh::testing::has_program(program)) {                                           \
      VDWMESH_MISSING("VDWMESH_REQUIRE_PACKAGES", std::string(package) + " is not installed"); \
    }                                                                                          \
  } while (false)

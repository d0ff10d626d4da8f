// The structures and references that lie beside the project. A test that reads one begins with
// VDWMESH_NEEDS_SHARED.
#pragma once

#include <filesystem>
#include <string>

#include "support/requirements.hpp"

namespace vdwmesh::testing {

// The folder is ../shared beside the checkout, or the one that VDWMESH_SHARED names.
std::filesystem::path shared_path(const std::string& relative);

// `relative` itself, or `relative` with ".gz" behind it where only the compressed file is there.
std::string plain_or_gzipped(const std::string& relative);

}  // namespace vdwmesh::testing

// Skips the running test where the file is missing; fails it with VDWMESH_REQUIRE_SHARED=1.
#define VDWMESH_NEEDS_SHARED(relative)                                                       \
  do {                                                                                       \
    if (!std::filesystem::exists(::vdwmesh::testing::shared_path(relative))) {               \
      VDWMESH_MISSING("VDWMESH_REQUIRE_SHARED",                                              \
                      ::vdwmesh::testing::shared_path(relative).string() + " is not there"); \
    }                                                                                        \
  } while (false)

// Files that tests may use but must do without: the structures and references beside the project.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace vdwmesh::testing {

// VDWMESH_SHARED overrides where they are looked for.
std::filesystem::path shared_path(const std::string& relative);

}  // namespace vdwmesh::testing

// Skips the running test, naming the file, where it is not there.
#define VDWMESH_NEEDS_SHARED(relative)                                     \
  if (!std::filesystem::exists(::vdwmesh::testing::shared_path(relative))) \
  GTEST_SKIP() << "needs " << ::vdwmesh::testing::shared_path(relative).string()

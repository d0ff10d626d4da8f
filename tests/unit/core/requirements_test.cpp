// The tests' own rule for what is missing: a skip, unless a variable makes it a failure.
#include "support/requirements.hpp"

#include <gtest/gtest-spi.h>

#include <cstdlib>

#include "support/shared_files.hpp"

namespace vdwmesh::testing {
namespace {

constexpr const char* kVariable = "VDWMESH_REQUIRE_NOTHING_REAL";

// Sets or unsets a variable of the environment and restores it at the end of the scope.
class EnvironmentVariable {
 public:
  EnvironmentVariable(const char* name, const char* value) : name_(name) {
    const char* old = std::getenv(name);
    had_value_ = old != nullptr;
    if (old) old_ = old;
    setenv(name, value, 1);
  }
  EnvironmentVariable(const EnvironmentVariable&) = delete;
  EnvironmentVariable& operator=(const EnvironmentVariable&) = delete;
  ~EnvironmentVariable() {
    if (had_value_) {
      setenv(name_, old_.c_str(), 1);
    } else {
      unsetenv(name_);
    }
  }

 private:
  const char* name_;
  std::string old_;
  bool had_value_ = false;
};

TEST(Requirements, UnsetEmptyAndZeroRequireNothing) {
  EXPECT_FALSE(is_required(kVariable));
  for (const char* value : {"", "0"}) {
    const EnvironmentVariable variable(kVariable, value);
    EXPECT_FALSE(is_required(kVariable)) << "'" << value << "'";
  }
  for (const char* value : {"1", "yes", "00"}) {
    const EnvironmentVariable variable(kVariable, value);
    EXPECT_TRUE(is_required(kVariable)) << "'" << value << "'";
  }
}

TEST(Requirements, ARequiredThingThatIsMissingIsAFailure) {
  const EnvironmentVariable variable(kVariable, "1");
  EXPECT_FATAL_FAILURE(VDWMESH_MISSING(kVariable, "a thing"), "a thing");
}

TEST(Requirements, ARequiredFileThatIsMissingIsAFailure) {
  const EnvironmentVariable variable("VDWMESH_REQUIRE_SHARED", "1");
  EXPECT_FATAL_FAILURE(VDWMESH_NEEDS_SHARED("no/such/file"), "no/such/file");
}

TEST(Requirements, ARequiredProgramThatIsMissingIsAFailure) {
  const EnvironmentVariable variable("VDWMESH_REQUIRE_PACKAGES", "1");
  EXPECT_FATAL_FAILURE(VDWMESH_NEEDS_PROGRAM("no-such-program", "no-such-package"),
                       "no-such-package");
}

TEST(Requirements, ProgramsAreLookedForOnThePath) {
  EXPECT_TRUE(has_program("sh"));
  const EnvironmentVariable variable("PATH", "/nowhere");
  EXPECT_FALSE(has_program("sh"));
}

}  // namespace
}  // namespace vdwmesh::testing

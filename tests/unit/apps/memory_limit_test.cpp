// The memory that control groups leave to a process.
#include "request/memory_limit.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace vdwmesh {
namespace {

class CgroupLimit : public ::testing::Test {
 protected:
  CgroupLimit() : root_(std::filesystem::path(::testing::TempDir()) / "vdwmesh_cgroup_limit") {
    std::filesystem::remove_all(root_);
  }
  ~CgroupLimit() override { std::filesystem::remove_all(root_); }

  void write(const std::string& file, const std::string& text) const {
    const std::filesystem::path path = root_ / file;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }
  std::optional<std::uint64_t> limit(const std::string& groups) const {
    std::istringstream lines(groups);
    return cgroup_limit(lines, root_);
  }

 private:
  std::filesystem::path root_;
};

TEST_F(CgroupLimit, TheLowestOfAGroupAndThoseAroundIt) {
  write("a/b/c/memory.max", "4000\n");
  write("a/b/memory.max", "max\n");
  write("a/memory.max", "3000\n");
  write("x/memory.max", "1\n");
  EXPECT_EQ(limit("0::/a/b/c\n"), 3000u);
  EXPECT_EQ(limit("0::/a/b\n"), 3000u);
  write("a/b/c/memory.max", "2000\n");
  EXPECT_EQ(limit("0::/a/b/c\n"), 2000u);
}

TEST_F(CgroupLimit, OfVersionOneTheGroupOfTheMemoryController) {
  write("memory/a/memory.limit_in_bytes", "500\n");
  write("memory/memory.limit_in_bytes", "700\n");
  write("cpu/a/memory.limit_in_bytes", "1\n");
  EXPECT_EQ(limit("3:cpu:/a\n7:memory:/a\n"), 500u);
  EXPECT_EQ(limit("7:memory:/\n"), 700u);
}

TEST_F(CgroupLimit, NoneWithoutFiles) {
  EXPECT_EQ(limit("0::/a/b\n"), std::nullopt);
  EXPECT_EQ(limit(""), std::nullopt);
}

}  // namespace
}  // namespace vdwmesh

// Files that appear under their names whole, or not at all.
#include "mesh/formats/output_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "core/errors.hpp"
#include "support/temporary_directory.hpp"

namespace vdwmesh {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::TemporaryDirectory;

TEST(OutputFile, AppearsAtCommitOnly) {
  for (const auto staging :
       {OutputFile::Staging::unnamed_where_possible, OutputFile::Staging::hidden}) {
    const TemporaryDirectory directory;
    {
      OutputFile dropped(directory / "dropped", staging);
      dropped.write("half", 4);
    }
    EXPECT_THAT(directory.names(), IsEmpty());
    OutputFile kept(directory / "kept", staging);
    kept.write("whole", 5);
    EXPECT_FALSE(fs::exists(directory / "kept"));
    kept.commit();
    EXPECT_THAT(directory.names(), ElementsAre("kept"));
    EXPECT_EQ(fs::file_size(directory / "kept"), 5u);
  }
}

// As "/dev/stdout" in a pipe, and what a shell puts in place of ">(command)".
TEST(OutputFile, WritesIntoAPipeNamedByItsDescriptor) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const TemporaryDirectory directory;
  const fs::path named = "/proc/self/fd/" + std::to_string(ends[1]), link = directory / "link";
  fs::create_symlink(named, link);
  for (const fs::path& path : {named, link}) {
    OutputFile file(path);
    file.write("whole", 5);
    file.commit();
    char read[6] = {};
    EXPECT_EQ(::read(ends[0], read, 5), 5);
    EXPECT_STREQ(read, "whole");
  }
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST(OutputFile, FollowsALink) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "target") << "old";
  fs::create_symlink("target", directory / "link");
  OutputFile file(directory / "link");
  file.write("fresh", 5);
  file.commit();
  EXPECT_TRUE(fs::is_symlink(directory / "link"));
  EXPECT_EQ(fs::file_size(directory / "target"), 5u);
}

// A private file stays private, an executable one executable.
TEST(OutputFile, KeepsThePermissionsOfWhatItReplaces) {
  for (const auto staging :
       {OutputFile::Staging::unnamed_where_possible, OutputFile::Staging::hidden}) {
    for (const auto wanted : {fs::perms(0600), fs::perms(0751)}) {
      const TemporaryDirectory directory;
      std::ofstream(directory / "file") << "old";
      fs::permissions(directory / "file", wanted);
      OutputFile file(directory / "file", staging);
      file.write("fresh", 5);
      file.commit();
      EXPECT_EQ(fs::status(directory / "file").permissions(), wanted);
      EXPECT_EQ(fs::file_size(directory / "file"), 5u);
    }
  }
}

// So long that parts of it are sent to the disk before the end; in pieces of several lengths.
TEST(OutputFile, ReplacesAFileByALongOne) {
  const TemporaryDirectory directory;
  const fs::path path = directory / "old";
  std::ofstream(path) << "old";
  std::string expected;
  OutputFile file(path);
  for (std::size_t piece = 1; expected.size() < 30'000'000; piece *= 3) {
    const std::string bytes(piece, static_cast<char>('a' + piece % 7));
    file.write(bytes.data(), bytes.size());
    expected += bytes;
    EXPECT_EQ(fs::file_size(path), 3u);
  }
  file.commit();
  std::ifstream read(path, std::ios::binary);
  EXPECT_TRUE(std::string(std::istreambuf_iterator<char>(read), {}) == expected);
  EXPECT_THAT(directory.names(), ElementsAre("old"));
}

// 255 bytes on the file systems of Linux: nothing may be added to the name on the way.
TEST(OutputFile, TakesTheLongestName) {
  for (const auto staging :
       {OutputFile::Staging::unnamed_where_possible, OutputFile::Staging::hidden}) {
    const TemporaryDirectory directory;
    const long longest = ::pathconf((directory / ".").c_str(), _PC_NAME_MAX);
    ASSERT_GT(longest, 0);
    const std::string name(static_cast<std::size_t>(longest), 'x');
    OutputFile file(directory / name, staging);
    file.write("fresh", 5);
    file.commit();
    EXPECT_THAT(directory.names(), ElementsAre(name));
  }
}

// A killed process of our number may have left its hidden files, or somebody may have put links
// where ours would be: none of them is written to.
TEST(OutputFile, LeavesHiddenFilesOfOthersAlone) {
  for (const auto staging :
       {OutputFile::Staging::unnamed_where_possible, OutputFile::Staging::hidden}) {
    const TemporaryDirectory directory;
    std::string hidden;
    {
      OutputFile first(directory / "first", OutputFile::Staging::hidden);
      hidden = directory.names().at(0);
    }
    // The names that follow: of the form ".vdwmesh-PROCESS-NUMBER.tmp".
    const std::size_t dash = hidden.rfind('-'), dot = hidden.rfind('.');
    const int number = std::stoi(hidden.substr(dash + 1, dot - dash - 1));
    for (int i = 1; i <= 3; ++i) {
      const std::string next = hidden.substr(0, dash + 1) + std::to_string(number + i) + ".tmp";
      fs::create_symlink("victim", directory / next);
    }
    OutputFile file(directory / "file", staging);
    file.write("fresh", 5);
    file.commit();
    EXPECT_FALSE(fs::exists(directory / "victim"));
    EXPECT_EQ(fs::file_size(directory / "file"), 5u);
  }
}

// Through several links, the last of which leads to nothing yet.
TEST(OutputFile, FollowsLinksToWhatIsNotThere) {
  const TemporaryDirectory directory;
  fs::create_directory(directory / "folder");
  fs::create_symlink("folder/second", directory / "first");
  fs::create_symlink("third", directory / "folder/second");
  EXPECT_EQ(written_file(directory / "first"), directory / "folder/third");
  OutputFile file(directory / "first");
  file.write("fresh", 5);
  file.commit();
  EXPECT_TRUE(fs::is_symlink(directory / "first"));
  EXPECT_TRUE(fs::is_symlink(directory / "folder/second"));
  EXPECT_EQ(fs::file_size(directory / "folder/third"), 5u);
  fs::create_symlink("loop", directory / "loop");
  EXPECT_THROW(OutputFile(directory / "loop").write("x", 1), FileFormatError);
}

}  // namespace
}  // namespace vdwmesh

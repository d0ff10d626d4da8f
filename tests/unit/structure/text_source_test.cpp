#include "structure/read/text_source.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include "structure/temp_file.hpp"

namespace vdwmesh::testing {
namespace {

using ::testing::HasSubstr;

const std::string kXyzr = "0 0 0 1\n1 0 0 1\n";

TEST(TextSource, GzipIsToldByItsBytes) {
  EXPECT_EQ(read_text_as("a.xyzr.gz", gzipped(kXyzr)).atoms.size(), 2U);
  EXPECT_EQ(read_text_as("A.XYZR.GZ", gzipped(kXyzr)).atoms.size(), 2U);
  EXPECT_EQ(read_text_as("a.xyzr", gzipped(kXyzr)).atoms.size(), 2U);
  EXPECT_EQ(read_text_as("a.xyzr.gz", kXyzr).atoms.size(), 2U);
  EXPECT_EQ(read_text_as("a.xyzr.gz", gzipped(kXyzr) + gzipped(kXyzr)).atoms.size(), 4U);
  EXPECT_EQ(read_text_as("a.xyzr.gz", gzipped(kXyzr) + std::string(512, '\0')).atoms.size(), 2U);
}

TEST(TextSource, BytesInMemoryAreReadAsTheirFile) {
  ReadOptions xyzr, small;
  xyzr.format = StructureFormat::xyzr;
  small.memory_limit = (kXyzr.size() - 1) * kReadingFactor;
  for (const std::string& content : {kXyzr, gzipped(kXyzr)}) {
    EXPECT_EQ(read_structure("a.xyzr", content, {}).atoms.size(), 2U);
    EXPECT_EQ(read_structure("a", content, xyzr).atoms.size(), 2U);
    EXPECT_THROW(read_structure("a", content, {}), FileFormatError);  // of what format?
    EXPECT_THROW(read_structure("a.xyzr", content, small), LimitExceeded);
  }
}

TEST(TextSource, LongTextsComeThroughWhole) {
  std::string text;
  for (int i = 0; i < 400'000; ++i) text += std::to_string(i) + " 0 0 1\n";
  const TemporaryDirectory dir;
  for (const std::string& content : {text, gzipped(text)}) {
    const Text read = read_text(dir.write("a", content));
    EXPECT_TRUE(std::equal(read.begin(), read.end(), text.begin(), text.end()));
  }
}

TEST(TextSource, DamagedGzipIsRefused) {
  const std::string packed = gzipped(kXyzr);
  for (std::size_t kept = 2; kept < packed.size(); ++kept)
    EXPECT_THAT(refusal_of_text<FileFormatError>("a.xyzr.gz", packed.substr(0, kept)),
                HasSubstr("gzip data"));
  std::string flipped = packed;
  flipped[packed.size() - 6] = static_cast<char>(flipped[packed.size() - 6] ^ 1);  // checksum
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.xyzr.gz", flipped), HasSubstr("damaged"));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.xyzr.gz", packed + "more"),
              HasSubstr("something else after"));
}

// The header may have a checksum of its own (RFC 1952): a flag in its fourth byte, and the two low
// bytes of the CRC-32 of the header behind it.
TEST(TextSource, ChecksumOfTheHeaderIsLookedAt) {
  const std::string packed = gzipped(kXyzr);
  std::string header = packed.substr(0, 10);
  header[3] = 2;
  const auto checksum = crc32(0, reinterpret_cast<const Bytef*>(header.data()), 10);
  for (const unsigned damage : {0u, 1u}) {
    std::string content = header;
    content += static_cast<char>((checksum ^ damage) & 0xff);
    content += static_cast<char>(checksum >> 8 & 0xff);
    content += packed.substr(10);
    if (damage == 0)
      EXPECT_EQ(read_text_as("a.xyzr.gz", content).atoms.size(), 2U);
    else
      EXPECT_THAT(refusal_of_text<FileFormatError>("a.xyzr.gz", content), HasSubstr("damaged"));
  }
}

// The last four bytes tell the size of the last member alone, or lie.
TEST(TextSource, SizesInTheTrailerMayMislead) {
  std::string longer(100'000, ' ');
  longer += kXyzr;
  for (const std::string& content :
       {gzipped(longer) + gzipped(kXyzr), gzipped(kXyzr) + gzipped(longer)})
    EXPECT_EQ(read_text_as("a.xyzr.gz", content).atoms.size(), 4U);
  for (const std::size_t place : {1, 2, 4}) {
    std::string packed = gzipped(longer);
    packed[packed.size() - place] = static_cast<char>(packed[packed.size() - place] ^ 1);
    EXPECT_THAT(refusal_of_text<FileFormatError>("a.xyzr.gz", packed), HasSubstr("damaged"));
  }
}

TEST(TextSource, SizeIsBounded) {
  const TemporaryDirectory dir;
  const std::string blanks(100'000, ' ');
  for (const std::string& content : {blanks, gzipped(blanks)}) {
    const auto path = dir.write("a", content);
    EXPECT_EQ(read_text(path, blanks.size()).size(), blanks.size());
    EXPECT_THROW(read_text(path, blanks.size() - 1), LimitExceeded);
  }
}

TEST(TextSource, WhatCannotBeReadIsSaid) {
  const TemporaryDirectory dir;
  EXPECT_THAT(refusal_of<FileFormatError>(dir.path() / "none.pdb"), HasSubstr("No such file"));
  std::filesystem::create_directory(dir.path() / "dir.pdb");
  EXPECT_THAT(refusal_of<FileFormatError>(dir.path() / "dir.pdb"), HasSubstr("is a directory"));
}

// Root may read everything, so there the reading is done as nobody.
TEST(TextSource, PermissionIsSaid) {
  constexpr uid_t kNobody = 65534;
  const TemporaryDirectory dir;
  const auto path = dir.write("a.xyzr", kXyzr);
  std::filesystem::permissions(path, std::filesystem::perms::none);
  const uid_t user = geteuid();
  if (user == 0 && seteuid(kNobody) != 0) GTEST_SKIP() << "root cannot become nobody here";
  EXPECT_THAT(refusal_of<FileFormatError>(path), HasSubstr("Permission denied"));
  EXPECT_EQ(seteuid(user), 0);
}

TEST(TextSource, WhatIsNoStructureFileIsSaid) {
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.pdb", ""), HasSubstr("is empty"));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.cif", " \r\n\n# only a comment\n"),
              HasSubstr("is empty"));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.pdb", std::string("ATOM\0\1\2", 7)),
              HasSubstr("zero byte at offset 4"));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.pdb", "PK\x03\x04..."), HasSubstr("zip"));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.pdb", "<!DOCTYPE html>"), HasSubstr("web page"));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.pdb", "{\"data\": 1}"), HasSubstr("JSON"));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.pdb", std::string("\xff\xfe"
                                                                    "A\0",
                                                                    4)),
              HasSubstr("UTF-16"));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.pdb", gzipped(gzipped(kXyzr))),
              HasSubstr("gzip data inside gzip data"));
}

TEST(TextSource, ExtensionsThatAreNotReadAreSaid) {
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.xtc", "x"), HasSubstr("trajectory"));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.mol2", "x"), HasSubstr(".mol2"));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a", "x"), HasSubstr("--format"));
}

TEST(TextSource, ContentOfAnotherFormatIsSaid) {
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.pdb", "# x\ndata_1UBQ\n"),
              HasSubstr("holds mmCIF"));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.cif", "HEADER    PROTEIN\n"),
              HasSubstr("holds PDB"));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.cif", "nonsense\n"), HasSubstr("not mmCIF"));
  EXPECT_THAT(
      refusal_of_text<FileFormatError>("a.pdb", "ATOM 1 N MET 1 -6.406 5.469 -3.259 -0.3 1.85\n"),
      HasSubstr("a.pdb:1: x in columns 31-38"));
}

TEST(TextSource, FormatOptionOverridesTheExtension) {
  ReadOptions options;
  options.format = StructureFormat::xyzr;
  EXPECT_EQ(read_text_as("a.pdb", kXyzr, options).atoms.size(), 2U);
}

// Puts a file in place of standard input while it lives.
class StandardInput {
 public:
  explicit StandardInput(const std::filesystem::path& path) : saved_(dup(0)) {
    const int file = open(path.c_str(), O_RDONLY);
    dup2(file, 0);
    close(file);
  }
  ~StandardInput() {
    dup2(saved_, 0);
    close(saved_);
  }

 private:
  int saved_;
};

TEST(TextSource, StandardInputNeedsAFormat) {
  const TemporaryDirectory dir;
  EXPECT_THAT(refusal_of<InvalidInput>("-"), HasSubstr("--format"));
  ReadOptions options;
  options.format = StructureFormat::xyzr;
  for (const std::string& content : {kXyzr, gzipped(kXyzr)}) {
    const StandardInput input(dir.write("in", content));
    EXPECT_EQ(read_structure("-", options).atoms.size(), 2U);
  }
  const StandardInput input(dir.write("in", "0 0 0 x\n"));
  EXPECT_THAT(refusal_of<FileFormatError>("-", options), HasSubstr("standard input:1: "));
}

}  // namespace
}  // namespace vdwmesh::testing

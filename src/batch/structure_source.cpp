// One source for each kind of input, and one that goes through them. Archives are libarchive's: it
// reads their headers and unpacks them as a stream, so no archive is ever in memory as a whole.
#include "batch/structure_source.hpp"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <istream>
#include <streambuf>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/errors.hpp"
#include "core/letters.hpp"

namespace vdwmesh {
namespace {

namespace fs = std::filesystem;
using Content = StructureSource::Content;

bool is_archive_name(const fs::path& path) {
  const std::string name = lower_case(path.filename().string());
  constexpr std::array<std::string_view, 9> kEndings{
      ".tar", ".tar.gz", ".tgz", ".tar.bz2", ".tbz2", ".tar.xz", ".tar.zst", ".txz", ".tzst"};
  return std::any_of(kEndings.begin(), kEndings.end(),
                     [&](std::string_view ending) { return name.ends_with(ending); });
}

// Whether a name alone, or the options, say how the structure is read.
bool is_structure(const fs::path& name, const SourceOptions& options) {
  return options.format != StructureFormat::by_extension || has_structure_extension(name);
}

class FileSource : public StructureSource {
 public:
  explicit FileSource(const fs::path& path) : name_(path.string()) {}
  std::optional<NamedStructure> next(Content) override {
    if (given_) return std::nullopt;
    given_ = true;
    return NamedStructure{name_, std::nullopt, {}};
  }
  std::uint64_t left_out() const override { return 0; }

 private:
  std::string name_;
  bool given_ = false;
};

class FolderSource : public StructureSource {
 public:
  FolderSource(const fs::path& folder, const SourceOptions& options) {
    try {
      for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.is_directory()) continue;
        if (is_structure(entry.path(), options)) {
          names_.push_back(entry.path().string());
        } else {
          ++left_out_;
        }
      }
    } catch (const fs::filesystem_error& error) {
      throw FileFormatError(
          fmt::format("{}: cannot be listed: {}", folder.string(), error.code().message()));
    }
    std::sort(names_.begin(), names_.end());
  }
  std::optional<NamedStructure> next(Content) override {
    if (next_ == names_.size()) return std::nullopt;
    return NamedStructure{names_[next_++], std::nullopt, {}};
  }
  std::uint64_t left_out() const override { return left_out_; }

 private:
  std::vector<std::string> names_;
  std::size_t next_ = 0;
  std::uint64_t left_out_ = 0;
};

// The bytes of standard input, of which the first were read to tell what they are. They come from
// the descriptor, because stdio may have none of them or too many.
class StandardInput {
 public:
  StandardInput() {
    first_.resize(kPeeked);
    std::size_t used = 0;
    while (used < kPeeked) {
      const std::size_t got = read(first_.data() + used, kPeeked - used);
      if (got == 0) break;
      used += got;
    }
    first_.resize(used);
  }
  std::string_view first() const { return first_; }
  // Returns the number of bytes; 0 at the end.
  std::size_t read(char* bytes, std::size_t most) {
    for (;;) {
      const ssize_t got = ::read(STDIN_FILENO, bytes, most);
      if (got >= 0) return static_cast<std::size_t>(got);
      if (errno == EINTR) continue;
      throw FileFormatError(fmt::format("standard input: cannot be read: {}",
                                        std::generic_category().message(errno)));
    }
  }

 private:
  static constexpr std::size_t kPeeked = 512;  // bytes: the header of a tar archive
  std::string first_;
};

class StandardBuffer : public std::streambuf {
 public:
  explicit StandardBuffer(StandardInput& input) : input_(input), bytes_(input.first()) {
    setg(bytes_.data(), bytes_.data(), bytes_.data() + bytes_.size());
  }

 protected:
  int_type underflow() override {
    constexpr std::size_t kMost = 65536;
    bytes_.resize(kMost);
    const std::size_t got = input_.read(bytes_.data(), kMost);
    setg(bytes_.data(), bytes_.data(), bytes_.data() + got);
    return got == 0 ? traits_type::eof() : traits_type::to_int_type(bytes_.front());
  }

 private:
  StandardInput& input_;
  std::string bytes_;
};

// Blank lines are passed over.
class NameListSource : public StructureSource {
 public:
  explicit NameListSource(const fs::path& path) : name_(path.string()), file_(path), list_(&file_) {
    if (!file_) throw FileFormatError(name_ + ": cannot be opened");
  }
  explicit NameListSource(StandardInput& input)
      : name_("standard input"),
        buffer_(std::make_unique<StandardBuffer>(input)),
        stream_(std::make_unique<std::istream>(buffer_.get())),
        list_(stream_.get()) {}

  std::optional<NamedStructure> next(Content) override {
    for (std::string line; std::getline(*list_, line);) {
      while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
      if (line.find('\0') != line.npos)
        throw FileFormatError(name_ + ": is neither a structure file nor a list of their names");
      if (!line.empty()) return NamedStructure{std::move(line), std::nullopt, {}};
    }
    if (list_->bad()) throw FileFormatError(name_ + ": cannot be read on");
    return std::nullopt;
  }
  std::uint64_t left_out() const override { return 0; }

 private:
  std::string name_;
  std::unique_ptr<StandardBuffer> buffer_;
  std::unique_ptr<std::istream> stream_;
  std::ifstream file_;
  std::istream* list_;
};

class ArchiveSource : public StructureSource {
 public:
  ArchiveSource(const fs::path& path, const SourceOptions& options)
      : ArchiveSource(options, path.string()) {
    constexpr std::size_t kBlock = 1 << 16;
    check(archive_read_open_filename(archive_.get(), path.c_str(), kBlock));
  }
  ArchiveSource(StandardInput& input, const SourceOptions& options)
      : ArchiveSource(options, "standard input") {
    input_ = &input;
    check(archive_read_open(archive_.get(), this, nullptr, give_bytes, nullptr));
  }

  std::optional<NamedStructure> next(Content content) override {
    for (;;) {
      archive_entry* entry = nullptr;
      const int status = archive_read_next_header(archive_.get(), &entry);
      if (status == ARCHIVE_EOF) return std::nullopt;
      check(status);
      if (archive_entry_filetype(entry) != AE_IFREG) continue;
      const char* const member = archive_entry_pathname(entry);
      NamedStructure found{member ? member : "", std::nullopt, {}};
      if (!is_structure(found.name, options_)) {
        ++left_out_;
        continue;
      }
      if (content == Content::read) read(entry, found);
      return found;
    }
  }
  std::uint64_t left_out() const override { return left_out_; }

 private:
  // External programs, which libarchive can start for rare kinds of packing, are not asked for.
  ArchiveSource(const SourceOptions& options, std::string name)
      : name_(std::move(name)), options_(options), archive_(archive_read_new()) {
    if (!archive_) throw std::bad_alloc();
    archive_read_support_format_tar(archive_.get());
    archive_read_support_filter_gzip(archive_.get());
    archive_read_support_filter_bzip2(archive_.get());
    archive_read_support_filter_xz(archive_.get());
    archive_read_support_filter_zstd(archive_.get());
  }

  void check(int status) const {
    if (status >= ARCHIVE_WARN) return;  // ARCHIVE_OK, or something that does no harm
    const char* const cause = archive_error_string(archive_.get());
    throw FileFormatError(fmt::format("{}: {}", name_, cause ? cause : "is no tar archive"));
  }

  void read(archive_entry* entry, NamedStructure& found) const {
    const auto size =
        static_cast<std::uint64_t>(std::max<la_int64_t>(0, archive_entry_size(entry)));
    if (size > options_.largest_member) {
      found.fault = fmt::format("{}: holds {} bytes in {}, more than the {} that are read",
                                found.name, size, name_, options_.largest_member);
      return;
    }
    std::string& bytes = found.bytes.emplace();
    // The size is the header's word, so memory is taken as the bytes come.
    constexpr std::size_t kChunk = 1 << 20;
    while (bytes.size() < size) {
      const std::size_t used = bytes.size();
      bytes.resize(used + std::min<std::uint64_t>(kChunk, size - used));
      const la_ssize_t got =
          archive_read_data(archive_.get(), bytes.data() + used, bytes.size() - used);
      bytes.resize(used + static_cast<std::size_t>(std::max<la_ssize_t>(0, got)));
      if (got > 0) continue;
      found.fault = fmt::format("{}: {} ends in the middle of it", found.name, name_);
      return;
    }
  }

  static la_ssize_t give_bytes(struct archive* archive, void* source, const void** bytes) noexcept {
    auto& self = *static_cast<ArchiveSource*>(source);
    try {
      if (!self.begun_) {
        self.begun_ = true;
        self.block_ = self.input_->first();
      } else {
        self.block_.resize(1 << 16);
        self.block_.resize(self.input_->read(self.block_.data(), self.block_.size()));
      }
      *bytes = self.block_.data();
      return static_cast<la_ssize_t>(self.block_.size());
    } catch (const std::exception& error) {
      archive_set_error(archive, EIO, "%s", error.what());
      return -1;
    }
  }

  struct Free {
    void operator()(struct archive* archive) const { archive_read_free(archive); }
  };

  std::string name_;
  SourceOptions options_;
  std::unique_ptr<struct archive, Free> archive_;
  std::uint64_t left_out_ = 0;
  StandardInput* input_ = nullptr;
  std::string block_;  // of standard input
  bool begun_ = false;
};

// Tar archives have a word of their own in the first header; packed data are recognised by their
// first bytes, and a list of names does not begin like that.
bool begins_archive(std::string_view first) {
  using namespace std::string_view_literals;
  constexpr std::array kPacked{"\x1f\x8b"sv, "BZh"sv,
                               "\xfd"
                               "7zXZ"sv,
                               "\x28\xb5\x2f\xfd"sv};
  return (first.size() > 262 && first.substr(257, 5) == "ustar") ||
         std::any_of(kPacked.begin(), kPacked.end(),
                     [first](std::string_view magic) { return first.starts_with(magic); });
}

class StandardSource : public StructureSource {
 public:
  explicit StandardSource(const SourceOptions& options) {
    if (begins_archive(input_.first())) {
      source_ = std::make_unique<ArchiveSource>(input_, options);
    } else {
      source_ = std::make_unique<NameListSource>(input_);
    }
  }
  std::optional<NamedStructure> next(Content content) override { return source_->next(content); }
  std::uint64_t left_out() const override { return source_->left_out(); }

 private:
  StandardInput input_;
  std::unique_ptr<StructureSource> source_;
};

std::unique_ptr<StructureSource> open(const fs::path& input, const SourceOptions& options) {
  if (input == "-") return std::make_unique<StandardSource>(options);
  if (fs::is_directory(input)) return std::make_unique<FolderSource>(input, options);
  if (is_archive_name(input)) return std::make_unique<ArchiveSource>(input, options);
  if (has_structure_extension(input)) return std::make_unique<FileSource>(input);
  return std::make_unique<NameListSource>(input);
}

class SourceOfAll : public StructureSource {
 public:
  SourceOfAll(std::vector<fs::path> inputs, const SourceOptions& options)
      : inputs_(std::move(inputs)), options_(options) {}

  std::optional<NamedStructure> next(Content content) override {
    for (;;) {
      if (!source_) {
        if (opened_ == inputs_.size()) return std::nullopt;
        source_ = open(inputs_[opened_++], options_);
      }
      if (std::optional<NamedStructure> found = source_->next(content)) return found;
      left_out_ += source_->left_out();
      source_.reset();
    }
  }
  std::uint64_t left_out() const override {
    return left_out_ + (source_ ? source_->left_out() : 0);
  }

 private:
  std::vector<fs::path> inputs_;
  SourceOptions options_;
  std::size_t opened_ = 0;  // inputs
  std::unique_ptr<StructureSource> source_;
  std::uint64_t left_out_ = 0;
};

}  // namespace

std::unique_ptr<StructureSource> open_structures(std::vector<fs::path> inputs,
                                                 const SourceOptions& options) {
  for (const fs::path& input : inputs) {
    std::error_code error;
    if (input != "-" && !fs::exists(input, error))
      throw InvalidInput(
          fmt::format("{}: is not there; name a structure file, a folder, a tar archive or a list",
                      input.string()));
  }
  return std::make_unique<SourceOfAll>(std::move(inputs), options);
}

std::uint64_t count_structures(const std::vector<fs::path>& inputs, const SourceOptions& options) {
  if (std::count(inputs.begin(), inputs.end(), "-") > 0)
    throw InvalidInput(
        "-: standard input can be read only once, so its structures are not counted");
  const std::unique_ptr<StructureSource> source = open_structures(inputs, options);
  std::uint64_t count = 0;
  while (source->next(Content::skip)) ++count;
  return count;
}

}  // namespace vdwmesh

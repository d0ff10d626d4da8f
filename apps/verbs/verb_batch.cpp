// `vdwmesh batch`: the figures of many structures. Each row is written when it and all before it
// are there, unlike other outputs, which appear whole: whatever ends the program leaves complete
// rows and at most one torn line. A later call checks the rows that the file has against the names
// and bytes of the structures, which it reads but does not measure, drops the torn line, and goes
// on behind them.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <fstream>
#include <limits>
#include <system_error>
#include <utility>

#include "batch/batch.hpp"
#include "batch/ordered_rows.hpp"
#include "command_line/command_line.hpp"
#include "core/errors.hpp"
#include "memory_plan.hpp"
#include "report/output.hpp"
#include "request/refuse.hpp"
#include "steps/session.hpp"
#include "steps/steps.hpp"
#include "verbs/batch_pockets.hpp"
#include "verbs/batch_report.hpp"
#include "verbs/batch_rows.hpp"
#include "verbs/verbs.hpp"

namespace vdwmesh::apps {
namespace {

constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();

// What a file of rows holds already.
struct KeptRows {
  std::uint64_t rows = 0, refused = 0;
};

// Where rows go.
class RowFile {
 public:
  // An empty path is standard output.
  explicit RowFile(std::string path) : path_(std::move(path)) {
    if (path_.empty()) return;
    constexpr int kMode = 0666;
    is_new_ = ::access(path_.c_str(), F_OK) != 0;
    fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, kMode);
    if (fd_ < 0 && (errno == EINVAL || errno == ENXIO || errno == EACCES))  // write-only devices
      fd_ = ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
    if (fd_ < 0) fail("opened");
    struct stat info {};
    is_regular_ = ::fstat(fd_, &info) == 0 && S_ISREG(info.st_mode);
    if (is_regular_) lock();
  }
  RowFile(const RowFile&) = delete;
  RowFile& operator=(const RowFile&) = delete;
  // A call that is refused leaves no empty file behind.
  ~RowFile() {
    struct stat info {};
    const bool is_empty = is_new_ && ::fstat(fd_, &info) == 0 && info.st_size == 0;
    if (is_empty && std::uncaught_exceptions() > 0) ::unlink(path_.c_str());
    if (fd_ > STDOUT_FILENO) ::close(fd_);
  }

  // Whether it can be read again and cut.
  bool is_regular() const { return is_regular_; }

  void cut(std::uint64_t length) {
    if (::ftruncate(fd_, static_cast<off_t>(length)) != 0) fail("cut");
  }

  // What goes before the next text.
  void write_before(std::string text) { before_ = std::move(text); }

  void write(std::string_view text) {
    if (!before_.empty()) write(std::exchange(before_, ""));
    while (!text.empty()) {
      const ssize_t written = ::write(fd_, text.data(), text.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail("written");
      text.remove_prefix(static_cast<std::size_t>(written));
    }
  }

 private:
  // The lock goes with the process. File systems without locks are used without one.
  void lock() const {
    refuse_if(::flock(fd_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK,
              "-o {}: another call of vdwmesh batch is writing this file; wait for it, or name "
              "another file",
              path_);
  }

  [[noreturn]] void fail(const char* what) const {
    throw FileFormatError(fmt::format("{}: cannot be {}: {}",
                                      path_.empty() ? "standard output" : path_, what,
                                      std::generic_category().message(errno)));
  }

  std::string path_, before_;
  int fd_ = STDOUT_FILENO;
  bool is_regular_ = false, is_new_ = false;
};

// The structures of another source, of which the next can be looked at beforehand.
class Source : public StructureSource {
 public:
  explicit Source(std::unique_ptr<StructureSource> source) : source_(std::move(source)) {}

  const std::optional<NamedStructure>& peek() {
    if (!next_) next_ = source_->next(Content::read);
    return next_;
  }
  std::optional<NamedStructure> next(Content content) override {
    return next_ ? std::exchange(next_, std::nullopt) : source_->next(content);
  }
  std::uint64_t left_out() const override { return source_->left_out(); }

 private:
  std::unique_ptr<StructureSource> source_;
  std::optional<NamedStructure> next_;
};

// Whether one is the beginning of the other.
bool begin_alike(std::string_view a, std::string_view b) {
  return a.starts_with(b) || b.starts_with(a);
}

// Refuses a line, which may be torn, that is not the row of the next structure with these settings,
// or is the row of another content.
void require_row(const std::string& line, const std::string& path, std::uint64_t row,
                 const RowWriter& writer, const NamedStructure* structure) {
  const bool torn = !line.ends_with('\n');
  const std::string beginning = structure ? writer.beginning(structure->name) : "";
  refuse_if(!structure || !(torn ? begin_alike(line, beginning) : line.starts_with(beginning)),
            "-o {}: row {} is not of {} with these options and this program; name another file, "
            "or say --resume off",
            path, row, structure ? structure->name : "any structure");
  refuse_if(
      !torn && !line.substr(beginning.size()).starts_with(writer.content(content_of(*structure))),
      "-o {}: {} is another one than when row {} was written; name another file, or say "
      "--resume off",
      path, structure->name, row);
}

// Goes through the lines of the file and the structures of the source side by side. Throws where a
// line is not the row of its structure, before anything is changed; a torn one is dropped then.
KeptRows keep_rows(const std::string& path, const std::string& header, const RowWriter& writer,
                   std::uint64_t most, Source& source, RowFile& file) {
  std::ifstream lines(path, std::ios::binary);
  KeptRows kept;
  std::uint64_t length = 0;
  for (std::string line; std::getline(lines, line);) {
    const bool torn = lines.eof();
    if (!torn) line += '\n';
    if (length == 0 && !header.empty()) {
      refuse_if(torn ? !header.starts_with(line) : line != header,
                "-o {}: begins with something else than the columns of rows; name "
                "another file, or say --resume off",
                path);
    } else {
      const bool is_next = kept.rows < most && source.peek();
      require_row(line, path, kept.rows + 1, writer, is_next ? &*source.peek() : nullptr);
      if (torn) break;
      source.next(StructureSource::Content::skip);
      ++kept.rows;
      if (writer.is_refusal(line)) ++kept.refused;
    }
    if (!torn) length += line.size();
  }
  file.cut(length);
  if (length > 0) file.write_before("");
  return kept;
}

// The options of one structure. Workers share the memory.
BatchOptions options_of_one(const Options& options, Monitor* monitor) {
  BatchOptions batch;
  const InputOptions& input = options.inputs.front();
  batch.read = input.read;
  batch.probe = input.probe;
  batch.method = options.exact.method;
  batch.topology = options.exact.topology;
  batch.threads = static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
  batch.monitor = monitor;
  const std::uint64_t share =
      options.machine.memory_limit / static_cast<std::uint64_t>(batch.threads);
  batch.read.memory_limit = share;
  batch.check = [share, method = method_for_memory(options.exact)](const SphereSet& spheres) {
    MemoryDemand demand;
    demand.exact = method;
    check_memory_before(demand, spheres, share);
  };
  return batch;
}

// Makes the rows of the next structures, up to `most`, and hands each of them to on_row(). Returns
// their number.
std::uint64_t make_rows_of_verb(StructureSource& source, std::uint64_t most, const Options& options,
                                Monitor* monitor, const auto& on_row) {
  const BatchOptions one = options_of_one(options, monitor);
  const bool excluded = options.exact.surface == ExactSurface::excluded;
  if (options.batch.verb == BatchVerb::exact && !excluded)
    return run_batch(source, most, one, on_row);
  const auto rows_of = [&](const auto& make_row) {
    using Row = decltype(make_row(NamedStructure(), options, one));
    return make_rows<Row>(
        source, most, static_cast<std::size_t>(one.threads), monitor,
        [&](const NamedStructure& structure) { return make_row(structure, options, one); }, on_row);
  };
  if (options.batch.verb == BatchVerb::interface) return rows_of(make_interface_row);
  if (options.batch.verb == BatchVerb::pockets) return rows_of(make_pockets_row);
  if (options.batch.verb == BatchVerb::exact) return rows_of(make_excluded_row);
  return rows_of(make_report_row);
}

void skip(StructureSource& source, std::uint64_t count) {
  while (count > 0 && source.next(StructureSource::Content::skip)) --count;
}

}  // namespace

void run_batch_verb(const Options& options) {
  VerbSession session(options.machine);
  const BatchChoice& choice = options.batch;
  const InputOptions& input = options.inputs.front();
  std::vector<std::filesystem::path> inputs;
  for (const InputOptions& each : options.inputs) inputs.push_back(each.path);
  const SourceOptions of_source{input.read.format, options.machine.memory_limit / kReadingFactor};
  // Only standard input is not counted.
  const bool counted = std::ranges::count(inputs, "-") == 0;
  const BatchPart part = counted ? part_of(choice.shard.number - 1, choice.shard.count,
                                           count_structures(inputs, of_source))
                                 : BatchPart{0, kAll};
  Source source(open_structures(inputs, of_source));
  skip(source, part.first);

  const RowWriter writer(options);
  const std::string header = choice.shard.number == 1 ? writer.header() : "";
  RowFile file(choice.output);
  KeptRows kept;
  file.write_before(header);
  if (file.is_regular()) {
    if (choice.resume == Switch::off) file.cut(0);
    kept = keep_rows(choice.output, header, writer, part.count, source, file);
  }
  begin_stage(session.monitor, "structures", counted ? part.count : 0);
  advance(session.monitor, kept.rows);
  std::uint64_t refused = kept.refused;
  const std::uint64_t made = make_rows_of_verb(source, part.count - kept.rows, options,
                                               session.monitor, [&](const auto& row) {
                                                 if (row.error) ++refused;
                                                 file.write(writer.text(row));
                                               });
  session.end_progress();
  if (source.left_out() > 0)
    print_warnings({fmt::format("{} of the files had no extension of a structure and {} left out",
                                source.left_out(), source.left_out() == 1 ? "was" : "were")});
  const std::uint64_t rows = kept.rows + made;
  refuse_if(
      rows == 0 && choice.shard.count == 1,
      "{}: holds no structures; their names end in .pdb .ent .pdbqt .cif .mmcif .bcif .pqr .xyzr "
      ".gro .mol2 .sdf .mol or .xyz, also with .gz, or --format says what all of them are",
      inputs.size() == 1 ? inputs.front().string() : "INPUT");
  file.write("");
  if (file.is_regular() && session.machine.verbosity != Verbosity::quiet)
    write_standard_output(fmt::format("{} {}, {} {}, written to {}\n", rows,
                                      rows == 1 ? "row" : "rows", refused,
                                      refused == 1 ? "error" : "errors", choice.output));
  if (refused > 0)
    throw FileFormatError(
        fmt::format("{} of {} structures were refused; their rows say why", refused, rows));
}

}  // namespace vdwmesh::apps

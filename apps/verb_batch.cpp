// `vdwmesh batch`: the figures of many structures. Each row is written when it and all before it
// are there, unlike other outputs, which appear whole: whatever ends the program leaves complete
// rows and at most one torn line. A later call checks the rows that the file has, drops the torn
// line, and goes on behind them.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <limits>
#include <system_error>

#include "batch/batch.hpp"
#include "batch/ordered_rows.hpp"
#include "batch_report.hpp"
#include "batch_rows.hpp"
#include "command_line/command_line.hpp"
#include "core/errors.hpp"
#include "memory_plan.hpp"
#include "output.hpp"
#include "refuse.hpp"
#include "session.hpp"
#include "steps.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();

// What a file of rows holds already.
struct Kept {
  std::uint64_t rows = 0, refused = 0;
};

// Where rows go.
class RowFile {
 public:
  // An empty path is standard output.
  explicit RowFile(std::string path) : path_(std::move(path)) {
    if (path_.empty()) return;
    constexpr int kMode = 0666;
    fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, kMode);
    if (fd_ < 0 && (errno == EINVAL || errno == ENXIO || errno == EACCES))  // write-only devices
      fd_ = ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
    if (fd_ < 0) fail("opened");
    struct stat info {};
    is_regular_ = ::fstat(fd_, &info) == 0 && S_ISREG(info.st_mode);
  }
  RowFile(const RowFile&) = delete;
  RowFile& operator=(const RowFile&) = delete;
  ~RowFile() {
    if (fd_ > STDOUT_FILENO) ::close(fd_);
  }

  // Whether it can be read again and cut.
  bool is_regular() const { return is_regular_; }

  void cut(std::uint64_t length) {
    if (::ftruncate(fd_, static_cast<off_t>(length)) != 0) fail("cut");
  }

  void write(std::string_view text) {
    while (!text.empty()) {
      const ssize_t written = ::write(fd_, text.data(), text.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail("written");
      text.remove_prefix(static_cast<std::size_t>(written));
    }
  }

 private:
  [[noreturn]] void fail(const char* what) const {
    throw FileFormatError(fmt::format("{}: cannot be {}: {}",
                                      path_.empty() ? "standard output" : path_, what,
                                      std::generic_category().message(errno)));
  }

  std::string path_;
  int fd_ = STDOUT_FILENO;
  bool is_regular_ = false;
};

// Goes through the complete lines of the file and the structures of the source side by side. Throws
// where a line is not the row of its structure with these settings.
Kept keep_rows(const std::string& path, const std::string& header, const RowWriter& writer,
               std::uint64_t most, StructureSource& source, RowFile& file) {
  std::ifstream lines(path, std::ios::binary);
  Kept kept;
  std::uint64_t length = 0;
  bool is_header = !header.empty();
  for (std::string line; std::getline(lines, line) && !lines.eof();) {
    line += '\n';
    if (is_header) {
      refuse_if(line != header,
                "-o {}: begins with something else than the columns of rows; name "
                "another file, or say --resume off",
                path);
      is_header = false;
    } else {
      std::optional<NamedStructure> structure;
      if (kept.rows < most) structure = source.next(StructureSource::Content::skip);
      refuse_if(
          !structure || !line.starts_with(writer.beginning(structure->name)),
          "-o {}: row {} is not of {} with these options and this program; name another file, "
          "or say --resume off",
          path, kept.rows + 1, structure ? structure->name : "any structure");
      ++kept.rows;
      if (writer.is_refusal(line)) ++kept.refused;
    }
    length += line.size();
  }
  file.cut(length);
  if (length == 0) file.write(header);
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
  if (options.batch.verb == BatchVerb::exact) return run_batch(source, most, one, on_row);
  const RowWork<ReportRow> work{[&](const NamedStructure& structure, std::size_t) {
                                  return make_report_row(structure, options, one);
                                },
                                on_row};
  return make_rows(source, most, work, static_cast<std::size_t>(one.threads), monitor);
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
  const std::unique_ptr<StructureSource> source = open_structures(inputs, of_source);
  skip(*source, part.first);

  const RowWriter writer(choice, settings_key(options));
  const std::string header = choice.shard.number == 1 ? writer.header() : "";
  RowFile file(choice.output);
  Kept kept;
  if (!file.is_regular()) {
    file.write(header);
  } else {
    if (choice.resume == Switch::off) file.cut(0);
    kept = keep_rows(choice.output, header, writer, part.count, *source, file);
  }
  begin_stage(session.monitor, "structures", counted ? part.count : 0);
  advance(session.monitor, kept.rows);
  std::uint64_t refused = kept.refused;
  const std::uint64_t made = make_rows_of_verb(*source, part.count - kept.rows, options,
                                               session.monitor, [&](const auto& row) {
                                                 if (row.error) ++refused;
                                                 file.write(writer.text(row));
                                               });
  session.end_progress();
  if (source->left_out() > 0)
    print_warnings({fmt::format("{} of the files had no extension of a structure and {} left out",
                                source->left_out(), source->left_out() == 1 ? "was" : "were")});
  const std::uint64_t rows = kept.rows + made;
  refuse_if(rows == 0 && choice.shard.count == 1,
            "{}: holds no structures; their names end in .pdb .ent .cif .mmcif .bcif .pqr or "
            ".xyzr, also with .gz, or --format says what all of them are",
            inputs.size() == 1 ? inputs.front().string() : "INPUT");
  if (refused > 0)
    throw FileFormatError(
        fmt::format("{} of {} structures were refused; their rows say why", refused, rows));
}

}  // namespace vdwmesh::apps

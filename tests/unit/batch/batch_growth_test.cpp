// How the work on many small files grows with their number (support/growth.hpp): each is taken from
// its source once, and few are taken before the rows of those before them are written.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "batch/batch.hpp"
#include "support/growth.hpp"
#include "support/temporary_directory.hpp"

namespace vdwmesh::testing {
namespace {

// A source that counts what is taken from another one, and asks the monitor each time.
class CountedSource : public StructureSource {
 public:
  CountedSource(std::unique_ptr<StructureSource> source, Monitor& monitor)
      : source_(std::move(source)), monitor_(monitor) {}
  std::optional<NamedStructure> next(Content content) override {
    advance(&monitor_, 0);
    ++taken_;
    return source_->next(content);
  }
  std::uint64_t left_out() const override { return source_->left_out(); }
  std::uint64_t taken() const { return taken_; }

 private:
  std::unique_ptr<StructureSource> source_;
  Monitor& monitor_;
  std::atomic<std::uint64_t> taken_{0};
};

TEST(BatchGrowth, ManySmallFiles) {
  constexpr int kThreads = 2;
  constexpr std::uint64_t kMostAhead = 32;  // a few for each thread
  expect_growth(50, [&](int files, Monitor& monitor) {
    const TemporaryDirectory folder;
    for (int i = 0; i < files; ++i) {
      folder.write(fmt::format("{:04}.xyzr", i), fmt::format("0 0 0 1\n{} 0 0 1.5\n", 1 + i % 3));
    }
    CountedSource source(open_structures({folder.path()}), monitor);
    std::uint64_t rows = 0, ahead = 0;
    BatchOptions options;
    options.threads = kThreads;
    options.monitor = &monitor;
    const auto count = static_cast<std::uint64_t>(files);
    EXPECT_EQ(run_batch(source, count + 1, options,
                        [&](const BatchRow& row) {
                          EXPECT_FALSE(row.error) << *row.error;
                          ahead = std::max(ahead, source.taken() - rows);
                          ++rows;
                        }),
              count);
    EXPECT_EQ(rows, count);
    EXPECT_LE(source.taken(), count + 1);  // once for each, and once behind the last
    EXPECT_LE(ahead, kMostAhead);
  });
}

}  // namespace
}  // namespace vdwmesh::testing

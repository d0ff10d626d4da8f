// How the work of each stage grows with what it works on. Every loop over many things asks the
// monitor once in so many steps, so a monitor that counts the questions counts the steps. A stage
// works on n and 4n things, and may not take much more than n log n steps.
#pragma once

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

#include "core/monitor.hpp"

namespace vdwmesh::testing {

// Counts the questions in each stage.
class StepCounter : public Monitor {
 public:
  void begin_stage(std::string_view name, std::uint64_t) override {
    const std::lock_guard lock(mutex_);
    current_ = &steps_[std::string(name)];
    ++rounds_[std::string(name)];
  }
  void advance(std::uint64_t) override {}
  bool cancelled() const override {
    ++*current_.load();
    return false;
  }
  // By stage. One that begins repeatedly, as rounds of meshing do until no piece is split, counts
  // by round: how many rounds there are is up to the narrowest place of all.
  std::map<std::string, std::uint64_t> steps() const {
    std::map<std::string, std::uint64_t> out;
    for (const auto& [stage, steps] : steps_) {
      const auto rounds = rounds_.find(stage);
      out[stage] = steps / (rounds == rounds_.end() ? 1 : rounds->second);
    }
    return out;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::atomic<std::uint64_t>> steps_;
  std::map<std::string, std::uint64_t> rounds_;
  std::atomic<std::atomic<std::uint64_t>*> current_ = &steps_["before the first stage"];
};

// Four times as many things are four times as much work, and a logarithm's share more; a step that
// grows with the power 3/2 takes eight times as much, one that looks at all pairs sixteen times.
// Stages that hardly ask are not judged.
inline constexpr double kMostGrowth = 7;
inline constexpr std::uint64_t kFewQuestions = 10;

// run(n, monitor) does the work on n things.
template <class Run>
void expect_growth(int count, const Run& run, double most = kMostGrowth) {
  // The number of blocks follows that of cores.
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  StepCounter few, many;
  run(count, few);
  run(4 * count, many);
  const auto before = few.steps();
  std::uint64_t asked = 0;
  for (const auto& [stage, steps] : many.steps()) {
    const auto at = before.find(stage);
    const std::uint64_t least = std::max(kFewQuestions, at == before.end() ? 0 : at->second);
    EXPECT_LE(static_cast<double>(steps), most * static_cast<double>(least))
        << stage << ": " << least << " questions, then " << steps << ", of " << count << " and "
        << 4 * count;
    asked = std::max(asked, steps);
  }
  EXPECT_GT(asked, kFewQuestions) << "no stage is judged";
}

}  // namespace vdwmesh::testing

// Costs of the stages of one run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/monitor.hpp"
#include "memory.hpp"
#include "pipeline/pipeline_bench.hpp"
#include "steps/stopwatch.hpp"

namespace vdwmesh::apps {

// CPU and wall seconds and peak memory from its construction to finish().
class StageClock {
 public:
  explicit StageClock(std::string name, StageKind kind = StageKind::stage) {
    row_.name = std::move(name);
    row_.kind = kind;
  }
  StageRow finish() {
    row_.cpu_seconds = cpu_.seconds();
    row_.wall_seconds = wall_.seconds();
    row_.peak_memory = memory_.bytes();
    return row_;
  }

 private:
  StageRow row_;
  PeakMemory memory_;  // before the watches: to reset it takes time
  Stopwatch wall_;
  CpuWatch cpu_;
};

// Splits work into parts where the library announces its stages.
class PartClock : public Monitor {
 public:
  void begin_stage(std::string_view name, std::uint64_t /*steps*/) override {
    finish();
    clock_.emplace(std::string(name), StageKind::part);
  }
  void advance(std::uint64_t /*steps*/) override {}
  bool cancelled() const override { return false; }

  void finish() {
    if (clock_) parts_.push_back(clock_->finish());
    clock_.reset();
  }
  std::vector<StageRow>& parts() { return parts_; }

 private:
  std::optional<StageClock> clock_;
  std::vector<StageRow> parts_;
};

}  // namespace vdwmesh::apps

// SIGINT and SIGTERM. They end the program at once, except while an output file is being written:
// then they wait until what there is of it is removed, or it stands whole under its name.
#pragma once

#include <filesystem>
#include <string>

#include "core/monitor.hpp"

namespace vdwmesh::apps {

void install_signal_handlers();

// The signal that came while a file was being written; 0: none.
int pending_signal();

// While one of these lives, signals wait. Throws Cancelled when one came earlier.
class HoldSignals {
 public:
  HoldSignals();
  ~HoldSignals();
  HoldSignals(const HoldSignals&) = delete;
  HoldSignals& operator=(const HoldSignals&) = delete;
};

// While this lives, a signal that ends the program removes the file first: of a file that other
// processes write as well, nobody can wait for the end. One at a time.
class RemoveOnSignal {
 public:
  explicit RemoveOnSignal(const std::filesystem::path& file);
  ~RemoveOnSignal();
  RemoveOnSignal(const RemoveOnSignal&) = delete;
  RemoveOnSignal& operator=(const RemoveOnSignal&) = delete;

 private:
  std::string name_;
};

// Cancelled by a signal that waits. Shows no progress.
class SignalMonitor : public Monitor {
 public:
  void begin_stage(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return pending_signal() != 0; }
};

// Whether the cursor stands in a progress line, which an interrupted program ends.
void set_progress_line_open(bool open);

}  // namespace vdwmesh::apps

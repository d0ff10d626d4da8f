// Handles SIGINT and SIGTERM. A handler may do next to nothing, so it either ends the process at
// once or, while somebody holds signals, leaves a note that is asked for later. Lock-free atomics
// are all that both sides share.
#include "interrupt.hpp"

#include <unistd.h>

#include <atomic>
#include <csignal>

#include "core/errors.hpp"

namespace vdwmesh::apps {
namespace {

std::atomic<int> holders{0};
std::atomic<int> pending{0};
std::atomic<bool> progress_line_open{false};
std::atomic<const char*> removed_file{nullptr};
static_assert(std::atomic<const char*>::is_always_lock_free &&
                  std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free,
              "a signal handler may use them");

// Nothing but what POSIX allows in a signal handler.
extern "C" void on_signal(int signal) {
  if (holders.load() > 0) {
    pending.store(signal);
    return;
  }
  if (progress_line_open.load()) [[maybe_unused]]
    const auto n = ::write(STDERR_FILENO, "\n", 1);
  if (const char* const file = removed_file.load()) ::unlink(file);
  ::_exit(128 + signal);
}

}  // namespace

void install_signal_handlers() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  // A file that grows past its limit is an error of the write, which says so.
  std::signal(SIGXFSZ, SIG_IGN);
}

int pending_signal() { return pending.load(); }

HoldSignals::HoldSignals() {
  if (pending_signal() != 0) throw Cancelled("stopped on request");
  ++holders;
}

HoldSignals::~HoldSignals() { --holders; }

RemoveOnSignal::RemoveOnSignal(const std::filesystem::path& file) : name_(file.string()) {
  removed_file.store(name_.c_str());
}

RemoveOnSignal::~RemoveOnSignal() { removed_file.store(nullptr); }

void set_progress_line_open(bool open) { progress_line_open.store(open); }

}  // namespace vdwmesh::apps

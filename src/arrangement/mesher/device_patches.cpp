// One thread takes what was sent, in order, and gives it to the device, which spreads it over
// threads of its own. Jobs stay in place until the end, since the device writes its outcome there.
#include "arrangement/mesher/device_patches.hpp"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <utility>

namespace vdwmesh {

void HostTurns::let_read() {
  std::unique_lock lock(mutex_);
  is_hosts_turn_ = false;
  changed_.notify_all();
  changed_.wait(lock, [&] { return readers_ == 0; });
  is_hosts_turn_ = true;
}

void HostTurns::end() noexcept {
  const std::lock_guard lock(mutex_);
  is_hosts_turn_ = false;
  changed_.notify_all();
}

void HostTurns::announce() {
  const std::lock_guard lock(mutex_);
  ++readers_;
}

void HostTurns::retract() noexcept {
  const std::lock_guard lock(mutex_);
  --readers_;
  changed_.notify_all();
}

void HostTurns::read(const std::function<void()>& look) {
  announce();
  read_announced(look);
}

void HostTurns::read_announced(const std::function<void()>& look) {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !is_hosts_turn_; });
  }
  FirstError error;
  error.guard(look);
  retract();
  error.rethrow();
}

DevicePatches::DevicePatches(PatchDevice& device, std::size_t balls, Sources sources,
                             Monitor* monitor)
    : device_(device),
      sources_(std::move(sources)),
      monitor_(monitor),
      job_of_(balls, nullptr),
      was_sent_(balls, 0) {
  jobs_.reserve(2 * balls);
  thread_ = std::jthread([this] { error_.guard([this] { work(); }); });
}

DevicePatches::~DevicePatches() {
  // The thread goes on only if the host has failed, which then has its turn.
  if (thread_.joinable()) {
    for (PatchJob& job : jobs_) job.is_withdrawn = true;
  }
  turns_.end();
  end_thread();
}

void DevicePatches::withdraw(std::uint32_t ball) {
  PatchJob*& job = job_of_[ball];
  if (job) job->is_withdrawn = true;
  job = nullptr;
}

std::size_t DevicePatches::take_back() {
  std::size_t count = 0;
  for (PatchJob& job : jobs_) {
    if (job.is_begun || job.is_withdrawn) continue;
    withdraw(job.ball);
    ++count;
  }
  return count;
}

void DevicePatches::tell_thread() {
  const std::lock_guard lock(mutex_);
  ready_ = jobs_.size();
  if (is_idle_ && !is_announced_) {
    turns_.announce();
    is_announced_ = true;
  }
  changed_.notify_all();
}

void DevicePatches::end_thread() noexcept {
  {
    const std::lock_guard lock(mutex_);
    is_last_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

void DevicePatches::work() {
  std::size_t begun = 0;
  while (true) {
    std::span<PatchJob> jobs;
    bool is_announced = false;
    {
      std::unique_lock lock(mutex_);
      is_idle_ = true;
      changed_.wait(lock, [&] { return is_last_ || begun < ready_; });
      is_idle_ = false;
      if (begun == ready_) return;
      jobs = {jobs_.data() + begun, ready_ - begun};
      begun = ready_;
      is_announced = std::exchange(is_announced_, false);
    }
    mesh(jobs, is_announced);
  }
}

// The first look is the one that was announced, if there is one. If it does not come to that, the
// host must not wait for it.
void DevicePatches::mesh(std::span<PatchJob> jobs, bool is_announced) {
  std::atomic<bool> announced = is_announced;
  const auto look = [&](const std::function<void()>& f) {
    if (announced.exchange(false)) {
      turns_.read_announced(f);
    } else {
      turns_.read(f);
    }
  };
  FirstError error;
  error.guard([&] { device_.mesh({jobs, look, sources_, monitor_}); });
  if (announced.exchange(false)) turns_.retract();
  error.rethrow();
}

std::vector<std::uint32_t> DevicePatches::take_results(std::span<const std::uint32_t> balls,
                                                       std::span<const std::uint32_t> of_host,
                                                       std::vector<PatchMesh>& patches,
                                                       ExactMeshStats& stats) const {
  const std::vector<std::uint32_t> not_done =
      collect<std::uint32_t>(balls.size(), [&](std::size_t i, std::vector<std::uint32_t>& found) {
        const PatchJob* const of_ball = job(balls[i]);
        if (of_ball && of_ball->is_done) {
          patches[balls[i]] = {{}, {}, of_ball->splits, 0};
        } else {
          found.push_back(balls[i]);
        }
      });
  std::vector<std::uint32_t> left;
  std::ranges::set_difference(not_done, of_host, std::back_inserter(left));
  for (const std::uint32_t b : left) stats.left_patches += job(b) != nullptr;
  stats.device_patches += balls.size() - not_done.size();
  return left;
}

void beside(const std::function<void()>& on_device, const std::function<void()>& on_host) {
  FirstError error;
  {
    const std::jthread device([&] { error.guard(on_device); });
    error.guard(on_host);
  }
  error.rethrow();
}

}  // namespace vdwmesh

// One thread takes what was sent, in order, and gives it to the device, which spreads it over
// threads of its own. Jobs stay in place until the end, since the device writes its outcome there.
#include "arrangement/mesher/device_patches.hpp"

#include <algorithm>
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

void HostTurns::read(const std::function<void()>& look) {
  {
    std::unique_lock lock(mutex_);
    ++readers_;
    changed_.wait(lock, [&] { return !is_hosts_turn_; });
  }
  FirstError error;
  error.guard(look);
  {
    const std::lock_guard lock(mutex_);
    --readers_;
    changed_.notify_all();
  }
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

void DevicePatches::tell_thread() {
  const std::lock_guard lock(mutex_);
  ready_ = jobs_.size();
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
  const auto look = [this](const std::function<void()>& f) { turns_.read(f); };
  std::size_t begun = 0;
  while (true) {
    std::span<PatchJob> jobs;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return is_last_ || begun < ready_; });
      if (begun == ready_) return;
      jobs = {jobs_.data() + begun, ready_ - begun};
      begun = ready_;
    }
    device_.mesh({jobs, look, sources_, monitor_});
  }
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

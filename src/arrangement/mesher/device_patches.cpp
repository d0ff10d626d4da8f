// One thread takes what was sent, in order, and gives it to the device, which spreads it over
// threads of its own. Jobs stay in place until the end, since the device writes its outcome there.
#include "arrangement/mesher/device_patches.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <utility>

namespace vdwmesh {

void HostTurns::lend(const std::function<void()>& work) {
  {
    const std::lock_guard lock(mutex_);
    is_hosts_turn_ = false;
    changed_.notify_all();
  }
  FirstError error;
  error.guard(work);
  {
    std::unique_lock lock(mutex_);
    is_hosts_turn_ = true;
    changed_.wait(lock, [&] { return readers_ == 0; });
  }
  error.rethrow();
}

void HostTurns::end() noexcept {
  const std::lock_guard lock(mutex_);
  is_hosts_turn_ = false;
  changed_.notify_all();
}

void HostTurns::read(const std::function<void()>& look) {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !is_hosts_turn_; });
    ++readers_;
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

void DevicePatches::look(std::span<const std::uint32_t> balls, DeviceWork work, const Looks& looks,
                         ExactMeshStats& stats) {
  std::vector<std::uint8_t> is_done(balls.size(), 0);  // bytes, since several threads set them
  if (work == DeviceWork::all || balls.size() >= kLeastLooksForDevice) {
    device_.look({balls.size(), [&](std::size_t i) { return looks.begin(balls[i]); },
                  [&](std::size_t i, PatchVector<PieceSplit>&& splits) {
                    looks.end(balls[i], std::move(splits));
                    is_done[i] = 1;
                    advance(monitor_, 1);
                  }});
    const auto done = static_cast<std::size_t>(std::ranges::count(is_done, std::uint8_t{1}));
    stats.device_looks += done;
    stats.left_looks += balls.size() - done;
  }
  tbb::parallel_for(std::size_t{0}, balls.size(), [&](std::size_t i) {
    if (is_done[i]) return;
    looks.look(balls[i]);
    advance(monitor_, 1);
  });
}

void DevicePatches::withdraw(std::uint32_t ball) {
  PatchJob*& job = job_of_[ball];
  if (job) job->is_withdrawn = true;
  job = nullptr;
}

// Takes out of `balls` the patches that the device shall mesh.
std::vector<std::uint32_t> DevicePatches::take_share(std::vector<std::uint32_t>& balls,
                                                     HostWork host, const MakeJob& make) {
  std::vector<std::uint32_t> sizes(balls.size()), taken, others;
  for_each_index(balls.size(),
                 [&](std::size_t i) { sizes[i] = sizes_of(make(balls[i])).most_points; });
  const DeviceLoad load = load_for_device(sizes, host, busy_);
  busy_ += load.milliseconds;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    (sizes[i] <= load.most_points ? taken : others).push_back(balls[i]);
  }
  balls = std::move(others);
  return taken;
}

void DevicePatches::send(std::vector<std::uint32_t>& balls, DeviceWork work, HostWork host,
                         const MakeJob& make) {
  const std::vector<std::uint32_t> taken =
      work == DeviceWork::all ? std::exchange(balls, {}) : take_share(balls, host, make);
  if (taken.empty()) return;
  const std::size_t first = jobs_.size();
  jobs_.resize(first + taken.size());
  for_each_index(taken.size(), [&](std::size_t i) {
    PatchJob& job = jobs_[first + i] = make(taken[i]);
    job_of_[job.ball] = &job;
    was_sent_[job.ball] = 1;
  });
  const std::lock_guard lock(mutex_);
  ready_ = jobs_.size();
  changed_.notify_all();
}

void DevicePatches::host_has_looked_at(std::size_t boundaries) {
  busy_ = busy_after(busy_, boundaries);
}

void DevicePatches::take_back() {
  std::size_t count = 0;
  for (PatchJob& job : jobs_) {
    if (job.is_begun || job.is_withdrawn) continue;
    withdraw(job.ball);
    ++count;
  }
  busy_ = busy_without(busy_, count);
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
  for (std::size_t begun = 0;;) {
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
                                                       ExactMeshStats& stats) {
  std::atomic<std::uint64_t> returned = 0;
  const std::vector<std::uint32_t> not_done =
      collect<std::uint32_t>(balls.size(), [&](std::size_t i, std::vector<std::uint32_t>& found) {
        PatchJob* const of_ball = job_of_[balls[i]];
        if (of_ball && of_ball->is_done) {
          PatchMesh& patch = patches[balls[i]] = {};
          if (of_ball->patch) patch = std::move(*of_ball->patch);
          if (!patch.triangles.empty()) ++returned;
        } else {
          found.push_back(balls[i]);
        }
      });
  std::vector<std::uint32_t> left;
  std::ranges::set_difference(not_done, of_host, std::back_inserter(left));
  for (const std::uint32_t b : left) stats.left_patches += job(b) != nullptr;
  stats.device_patches += balls.size() - not_done.size();
  stats.returned_patches += returned;
  stats.device_batches += device_.batches();
  return left;
}

void DevicePatches::place(const PlacedBalls& balls, std::span<const std::uint64_t> first_vertex,
                          std::span<const std::uint64_t> first_triangle,
                          std::span<const std::uint32_t> first_vertices, IndexedMesh& mesh) {
  const std::vector<PatchPlace> places =
      collect<PatchPlace>(job_of_.size(), [&](std::size_t b, std::vector<PatchPlace>& found) {
        const PatchJob* const kept = kept_job(static_cast<std::uint32_t>(b));
        if (!kept) return;
        found.push_back({kept->kept, kept->interior, kept->triangles, balls.balls[b], balls.ids[b],
                         first_vertex[b], first_triangle[b]});
      });
  device_.place({places, std::ldexp(1.0, balls.scale_exponent), first_vertices}, mesh);
  device_.forget();
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

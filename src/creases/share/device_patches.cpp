// Threads take what was sent, in order, and give it to the device: while it meshes what one of them
// has given, another one packs. Jobs stay in place until the end, since the device writes its
// outcome there.
#include "creases/share/device_patches.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <utility>

#include "complex/placed_balls.hpp"
#include "creases/share/patch_batch.hpp"

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

PatchDispatch::PatchDispatch(PatchDevice& device, std::size_t balls, Sources sources,
                             Monitor* monitor)
    : device_(device),
      sources_(std::move(sources)),
      monitor_(monitor),
      job_of_(balls, nullptr),
      was_sent_(balls, 0) {
  jobs_.reserve(2 * balls);
  try {
    while (threads_.size() < device.threads()) {
      threads_.emplace_back([this] { error_.guard([this] { work(); }); });
    }
  } catch (...) {  // those that have begun must not wait for ever
    end_threads();
    throw;
  }
}

PatchDispatch::~PatchDispatch() {
  // The threads go on only if the host has failed, which then has its turn.
  if (!threads_.empty()) {
    for (PatchJob& job : jobs_) job.is_withdrawn = true;
  }
  turns_.end();
  end_threads();
}

void PatchDispatch::look(std::span<const std::uint32_t> balls, DeviceWork work, const Looks& looks,
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

void PatchDispatch::withdraw(std::uint32_t ball) {
  PatchJob*& job = job_of_[ball];
  if (job) job->is_withdrawn = true;
  job = nullptr;
}

std::vector<PatchJob> PatchDispatch::make_jobs(std::span<const std::uint32_t> balls,
                                               const MakeJob& make) const {
  std::vector<PatchJob> jobs(balls.size());
  for_each_index(balls.size(), [&](std::size_t i) {
    jobs[i] = make(balls[i]);
    jobs[i].sizes = sizes_of(jobs[i]);
  });
  return jobs;
}

// The device gets patches of up to so many points.
std::uint32_t PatchDispatch::most_points(std::span<const PatchJob> jobs, HostWork host) {
  std::vector<std::uint32_t> sizes(jobs.size());
  for_each_index(jobs.size(), [&](std::size_t i) { sizes[i] = jobs[i].sizes.most_points; });
  const DeviceLoad load = load_for_device(std::move(sizes), host, busy_);
  busy_ += load.milliseconds;
  return load.most_points;
}

void PatchDispatch::send(std::vector<std::uint32_t>& balls, DeviceWork work, HostWork host,
                         const MakeJob& make) {
  std::vector<PatchJob> jobs = make_jobs(balls, make);
  const std::uint32_t most = work == DeviceWork::all ? kNoIndex : most_points(jobs, host);
  const std::size_t first = jobs_.size();
  balls.clear();
  for (PatchJob& job : jobs) {
    if (job.sizes.most_points > most) {
      balls.push_back(job.ball);
      continue;
    }
    PatchJob& sent = jobs_.emplace_back(std::move(job));
    job_of_[sent.ball] = &sent;
    was_sent_[sent.ball] = 1;
  }
  if (jobs_.size() == first) return;
  const std::lock_guard lock(mutex_);
  ready_ = jobs_.size();
  changed_.notify_all();
}

void PatchDispatch::host_has_looked_at(std::size_t boundaries) {
  busy_ = busy_after(busy_, boundaries);
}

void PatchDispatch::take_back() {
  std::size_t count = 0;
  for (PatchJob& job : jobs_) {
    if (job.is_begun || job.is_withdrawn) continue;
    withdraw(job.ball);
    ++count;
  }
  busy_ = busy_without(busy_, count);
}

void PatchDispatch::end_threads() noexcept {
  {
    const std::lock_guard lock(mutex_);
    is_last_ = true;
    changed_.notify_all();
  }
  threads_.clear();  // joins them
}

namespace {

// How many of so many jobs one of the idle threads takes: its share, so that the others may take
// theirs at the same time, if all shares are worth a batch, and no more than a batch has.
std::size_t share_of_thread(std::size_t jobs, std::size_t idle) {
  const bool is_worth_sharing = jobs >= idle * kLeastPatchesForDevice;
  return std::min(is_worth_sharing ? (jobs + idle - 1) / idle : jobs, kPatchesOfBatch);
}

}  // namespace

void PatchDispatch::work() {
  const auto look = [this](const std::function<void()>& f) { turns_.read(f); };
  for (;;) {
    std::span<PatchJob> jobs;
    {
      std::unique_lock lock(mutex_);
      ++idle_;
      changed_.wait(lock, [&] { return is_last_ || begun_ < ready_; });
      if (begun_ == ready_) return;
      jobs = {jobs_.data() + begun_, share_of_thread(ready_ - begun_, idle_--)};
      begun_ += jobs.size();
    }
    device_.mesh({jobs, look, sources_, monitor_});
  }
}

std::vector<std::uint32_t> PatchDispatch::take_results(std::span<const std::uint32_t> balls,
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

namespace {

PatchPlace place_of(std::uint32_t ball, std::uint64_t kept, const PatchDispatch::Places& places) {
  const auto length = [ball](std::span<const std::uint64_t> first) {
    return static_cast<std::uint32_t>(first[ball + 1] - first[ball]);
  };
  return {kept,
          length(places.first_vertex),
          length(places.first_triangle),
          places.balls.balls[ball],
          places.balls.ids[ball],
          places.first_vertex[ball],
          places.first_triangle[ball]};
}

// Å for each unit of the balls' lengths.
double unit_of(const PatchDispatch::Places& places) {
  return std::ldexp(1.0, places.balls.scale_exponent);
}

}  // namespace

std::vector<PatchPlace> PatchDispatch::kept_places(const Places& places) const {
  return collect<PatchPlace>(job_of_.size(), [&](std::size_t b, std::vector<PatchPlace>& found) {
    const auto ball = static_cast<std::uint32_t>(b);
    const PatchJob* const kept = kept_job(ball);
    if (kept) found.push_back(place_of(ball, kept->kept, places));
  });
}

void PatchDispatch::place(const Places& places, IndexedMesh& mesh) {
  device_.place({kept_places(places), unit_of(places), places.first_vertices}, mesh);
  device_.forget();
}

void PatchDispatch::assemble(const Places& places, std::span<const PatchMesh> patches,
                             const MeshPlacement& boundary) {
  const std::vector<PatchPlace> kept = kept_places(places);
  const std::vector<PatchOfHost> of_host =
      collect<PatchOfHost>(patches.size(), [&](std::size_t b, std::vector<PatchOfHost>& found) {
        const auto ball = static_cast<std::uint32_t>(b);
        if (!patches[b].triangles.empty()) {
          found.push_back({&patches[b], place_of(ball, 0, places)});
        }
      });
  device_.assemble({{places.first_vertex.back(), places.first_triangle.back()},
                    boundary,
                    of_host,
                    {kept, unit_of(places), places.first_vertices}});
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

// The boundaries and patches that UnionMesher gives a device, and the threads that make it mesh
// patches while UnionMesher still splits the pieces of arcs, in rounds.
//
// In the first round the device looks at boundaries, if they are many; the host at what is left.
//
// A patch none of whose pieces is split in a round is given to the device at once, though a later
// round may still split one of them: of 4,556 patches of haemoglobin, 1,910 are quiet in the second
// round, and 1,824 of them stay so. If one does not, it is withdrawn, and its result is dropped.
// The device reads boundaries and triangulations, which the rounds change. But a round changes only
// those of patches beside a piece that the round before has split, and these are withdrawn before
// it begins. So the device may look at all others while a round goes on. Between two rounds the
// host has the arcs, and what was sent, for itself.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "core/fixed_blocks.hpp"
#include "creases/share/patch_device.hpp"
#include "measures/many_unions.hpp"

namespace vdwmesh {

// Turns of one host and of any number of readers. The host has its turn at first.
class HostTurns {
 public:
  // Calls work(), and lets readers look meanwhile. Then it is the host's turn again, once those
  // that look have ended.
  void lend(const std::function<void()>& work);
  // Ends the host's turn: from now on, readers need not wait.
  void end() noexcept;
  // Calls look() as soon as it is not the host's turn.
  void read(const std::function<void()>& look);

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_hosts_turn_ = true;
  std::size_t readers_ = 0;  // that look
};

// From how many boundaries on a device looks at them first. Of 4,556, the 16 cores of an H200's
// host need 9 ms, and with the device it is 15 to 18; of 165,126 they need 0.34 s, and with it
// 0.22.
inline constexpr std::size_t kLeastLooksForDevice = 16384;

class PatchDispatch {
 public:
  // Writes where each point of the job's boundary comes from, as PatchOrder::sources does.
  using Sources = std::function<void(const PatchJob&, std::span<PointSource>)>;

  // For patches of so many balls. Keeps references.
  PatchDispatch(PatchDevice& device, std::size_t balls, Sources sources, Monitor* monitor);
  // Withdraws everything that the device has not begun, and waits for the rest.
  ~PatchDispatch();
  PatchDispatch(const PatchDispatch&) = delete;
  PatchDispatch& operator=(const PatchDispatch&) = delete;

  // These are for the host, in its turn.
  struct Looks {
    std::function<void(std::uint32_t ball)> look;  // on the host; from any thread
    // As in LookOrder, for a ball.
    std::function<LookJob(std::uint32_t ball)> begin;
    std::function<void(std::uint32_t ball, PatchVector<PieceSplit>&& splits)> end;
  };
  // First looks at the boundaries of these balls, by the device if they are many or `work` says so,
  // and by the host of what is left. Counts both in `stats`. Nothing must have been sent yet.
  void look(std::span<const std::uint32_t> balls, DeviceWork work, const Looks& looks,
            ExactMeshStats& stats);
  // Takes out of `balls` those whose patches the device shall mesh, and sends their jobs,
  // make(ball). Threads of the device that have nothing else to do share what was sent until then.
  // No ball may be sent more than twice, because jobs_ has room for two per ball.
  using MakeJob = std::function<PatchJob(std::uint32_t ball)>;
  void send(std::vector<std::uint32_t>& balls, DeviceWork work, HostWork host, const MakeJob& make);
  // So many boundaries, while the device was meshing.
  void host_has_looked_at(std::size_t boundaries);
  void withdraw(std::uint32_t ball);
  // Withdraws all that the device has not begun.
  void take_back();
  // Calls work(), which changes nothing of patches that were sent and not withdrawn, nor what their
  // sources depend on. The device may look at them meanwhile.
  void let_read(const std::function<void()>& work) { turns_.lend(work); }
  // The job of a ball, if it was sent and not withdrawn; else null.
  const PatchJob* job(std::uint32_t ball) const { return job_of_[ball]; }
  // The same, if the device keeps its result. To be asked once the device has finished.
  const PatchJob* kept_job(std::uint32_t ball) const {
    return job(ball) && job(ball)->is_kept ? job(ball) : nullptr;
  }
  bool was_sent(std::uint32_t ball) const { return was_sent_[ball] != 0; }

  // Ends the host's turns and calls on_host(). Returns when on_host() has returned and the device
  // has finished; the jobs then hold their results. Throws what the device or on_host() has thrown.
  template <class OnHost>
  void finish(const OnHost& on_host) {
    FirstError error;
    turns_.end();
    error.guard(on_host);
    end_threads();
    error.rethrow();
    error_.rethrow();
  }
  // After finish(): moves what the device has returned of those of `balls` that it has meshed,
  // requests or patches, to `patches`, and counts them in `stats`. Returns the balls that are still
  // to be meshed: neither the device has meshed them nor the host, which has meshed `of_host`.
  std::vector<std::uint32_t> take_results(std::span<const std::uint32_t> balls,
                                          std::span<const std::uint32_t> of_host,
                                          std::vector<PatchMesh>& patches, ExactMeshStats& stats);
  // Where patches go in the mesh: the first vertex and triangle inside of each ball's patch, with
  // one more entry at the end, and ArcSampling::first_vertices().
  struct Places {
    const PlacedBalls& balls;
    std::span<const std::uint64_t> first_vertex, first_triangle;
    std::span<const std::uint32_t> first_vertices;
  };
  // Lets the device write the patches that it keeps to their places in the mesh, and then forget
  // them.
  void place(const Places& places, IndexedMesh& mesh);
  // Whether assemble() is wanted in place of place(): PatchDevice::keeps_mesh().
  bool keeps_mesh() const { return device_.keeps_mesh(); }
  // Lets the device put the mesh together in its memory, of the patches that it keeps and of those
  // of the host, by ball, and then forget its own. `boundary` places corners and points of arcs.
  void assemble(const Places& places, std::span<const PatchMesh> patches,
                const MeshPlacement& boundary);

 private:
  std::vector<PatchJob> make_jobs(std::span<const std::uint32_t> balls, const MakeJob& make) const;
  std::uint32_t most_points(std::span<const PatchJob> jobs, HostWork host);
  std::vector<PatchPlace> kept_places(const Places& places) const;
  void end_threads() noexcept;
  void work();

  PatchDevice& device_;
  Sources sources_;
  Monitor* monitor_;
  HostTurns turns_;
  std::vector<PatchJob*> job_of_;       // by ball
  std::vector<std::uint8_t> was_sent_;  // by ball; bytes, since several threads set them
  // All that were sent. They never move, since the device writes there: there is room for all.
  std::vector<PatchJob> jobs_;
  double busy_ = 0;   // for how many milliseconds the device has work, about
  FirstError error_;  // of the device

  std::mutex mutex_;  // for what follows
  std::condition_variable changed_;
  std::size_t ready_ = 0;  // how many jobs the device may have
  std::size_t begun_ = 0;  // how many of them its threads have taken
  std::size_t idle_ = 0;   // threads that wait for more
  bool is_last_ = false;   // nothing more will be sent
  std::vector<std::jthread> threads_;
};

// Works on a device, on a thread of its own, and on the host at the same time.
void beside(const std::function<void()>& on_device, const std::function<void()>& on_host);

}  // namespace vdwmesh

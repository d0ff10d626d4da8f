// Which processors a rank may use: those that it is bound to, or its share of the host's. Only the
// first rank shows progress and prints.
#include <sched.h>
#include <unistd.h>

#include <algorithm>

#include "ranks/rank_verbs.hpp"

namespace vdwmesh::apps {
namespace {

// The processors on which this process may run: mpirun binds ranks to some of them.
std::uint64_t usable_processors() {
  cpu_set_t processors;
  CPU_ZERO(&processors);
  if (::sched_getaffinity(0, sizeof processors, &processors) != 0) return 1;
  return static_cast<std::uint64_t>(CPU_COUNT(&processors));
}

}  // namespace

// Ranks that are bound to processors of their own take these. Ranks that are not share all that the
// host has: the processors that they could use are then more than there are.
MachineOptions machine_of_rank(const Ranks& ranks, const MachineOptions& options) {
  MachineOptions own = options;
  const std::uint64_t usable = usable_processors(), wanted = ranks.sum_on_host(usable);
  const auto present = static_cast<std::uint64_t>(std::max(1L, ::sysconf(_SC_NPROCESSORS_ONLN)));
  if (own.threads == 0) {
    const std::uint64_t share = usable * std::min(present, wanted) / wanted;
    own.threads = static_cast<int>(std::max<std::uint64_t>(share, 1));
  }
  if (ranks.is_first()) return own;
  own.progress = Progress::never;
  own.verbosity = Verbosity::quiet;
  return own;
}

}  // namespace vdwmesh::apps

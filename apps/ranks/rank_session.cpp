// The first rank reads, because a parallel file system is slow for many readers of one small file,
// and because standard input is there alone.
#include "ranks/rank_session.hpp"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "steps.hpp"

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

SharedStructure load_together(const Ranks& ranks, const InputOptions& options, Session& session) {
  SharedStructure shared;
  SphereSet read;
  ranks.together([&] {
    if (!ranks.is_first()) return;
    auto [molecule, set] = load(options, session);
    shared.molecule = std::move(molecule);
    read = std::move(set);
  });
  shared.of_spheres = HostArray<Sphere>(ranks, read.spheres());
  ranks.together([&] { shared.spheres = SphereSet::view(shared.of_spheres.span()); });
  session.end_stage(&Timing::read);
  return shared;
}

HostArray<RgbColor> share_colors(const Ranks& ranks, const Molecule& molecule) {
  std::vector<RgbColor> colors;
  ranks.together([&] { colors = element_colors(molecule); });
  return {ranks, colors};
}

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

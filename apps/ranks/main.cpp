// The program vdwmesh-mpi, which mpirun starts on many ranks: reads the command line and runs a
// verb on all of them. If one rank fails, all end with the exit code of its failure, and one of
// them prints the one line that says why.
#include <cstdio>

#include "command_line/command_line.hpp"
#include "core/errors.hpp"
#include "interrupt.hpp"
#include "memory.hpp"
#include "outcome.hpp"
#include "ranks/rank_program.hpp"
#include "ranks/rank_verbs.hpp"

namespace vdwmesh::apps {
namespace {

// Reads the command line on every rank, since each needs the options. Only the first rank has a
// standard output to print help on.
std::optional<Command> read_together(const Ranks& ranks, const Program& program, int argc,
                                     const char* const* argv) {
  std::optional<Command> command;
  ranks.together([&] { command = read_command_line(program, argc, argv); });
  return command;
}

void run(const Ranks& ranks, int argc, const char* const* argv) {
  ranks.together([&] {
    if (!ranks.allows_threads())
      throw InvalidInput(
          "this MPI grants no threads (MPI_THREAD_FUNNELED); use an MPI that was built with them");
  });
  const std::vector<Verb> verbs =
      rank_verbs([&](const Options& options) { run_ranks_mesh(ranks, options); },
                 [&](const Options& options) { run_ranks_exact(ranks, options); });
  const Program program = rank_program(verbs, ranks.sum_on_host(1));
  const auto command = read_together(ranks, program, argc, argv);
  if (command) command->verb->run(command->options);
}

// Prints and ends. Without a failure that all ranks know of, the others would wait for this one.
int end(const Ranks& ranks, const Outcome& outcome) {
  const bool alone = outcome.status != kDone && !ranks.all_failed();
  if (outcome.status != kDone && (alone || ranks.is_first())) {
    std::fprintf(stderr, "vdwmesh-mpi: %s\n", outcome.message.c_str());
  }
  if (alone) ranks.abort(outcome.status);
  return outcome.status;
}

}  // namespace
}  // namespace vdwmesh::apps

int main(int argc, char** argv) {
  using namespace vdwmesh;
  const Ranks ranks(argc, argv);
  apps::install_signal_handlers();
  apps::keep_freed_memory();
  if (!ranks.is_first() && std::freopen("/dev/null", "w", stdout) == nullptr)
    return apps::kOwnFault;
  return apps::end(ranks, apps::outcome_of([&] { apps::run(ranks, argc, argv); }));
}

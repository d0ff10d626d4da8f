// The program: reads the command line, runs a verb, and ends with the exit code and the one line on
// standard error that say how it went. That nothing but the line is printed is part of the contract
// with scripts.
#include <cstdio>

#include "command_line/command_line.hpp"
#include "interrupt.hpp"
#include "memory.hpp"
#include "outcome.hpp"

int main(int argc, char** argv) {
  using namespace vdwmesh::apps;
  install_signal_handlers();
  keep_freed_memory();
  const Outcome outcome = outcome_of([&] {
    const auto command = read_command_line(plain_program(), argc, argv);
    if (command) command->verb->run(command->options);
  });
  if (outcome.status != kDone) std::fprintf(stderr, "vdwmesh: %s\n", outcome.message.c_str());
  const int signal = pending_signal();
  return signal != 0 ? kSignalBase + signal : outcome.status;
}

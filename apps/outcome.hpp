// How a run ended: the exit status and the line for standard error. Which cause has which status is
// part of the contract with scripts.
#pragma once

#include <functional>
#include <string>

namespace vdwmesh::apps {

enum ExitCode : int {
  kDone = 0,
  kBadInput = 1,
  kNoBackend = 2,
  kLimitHit = 3,
  kOwnFault = 4,
  kSignalBase = 128
};

struct Outcome {
  ExitCode status = kDone;
  std::string message;  // one line, without its end; empty if all is done
};

// Does the work and catches what it throws.
Outcome outcome_of(const std::function<void()>& work);

}  // namespace vdwmesh::apps

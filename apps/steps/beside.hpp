// Runs two stages of a verb at the same time and keeps their times true.
#pragma once

#include <functional>
#include <vector>

#include "steps/session.hpp"

namespace vdwmesh::apps {

struct StageWork {
  Timing::Stage Timing::*stage;
  std::function<void()> work;
};

// Runs the stages `here` from this thread, one after the other, and meanwhile `beside` on the other
// threads that the session has; if there are none, `beside` runs afterwards. Neither may touch what
// the other one writes. After a stage that throws no further one is begun; what is thrown is thrown
// after `beside` has ended, too. Precondition: the stage before has just ended.
//
// The wall time of a stage `here` is its own; that of `beside` is what it takes longer, so that
// stages still add up to the total. Processor time is that of this thread for the stages `here`,
// and all other for `beside`, also what other threads did for a stage `here`.
void run_beside(Session& session, const std::vector<StageWork>& here, const StageWork& beside);

}  // namespace vdwmesh::apps

// Runs two stages of a verb at the same time and keeps their times true.
#pragma once

#include <functional>

#include "session.hpp"

namespace vdwmesh::apps {

struct StageWork {
  Timing::Stage Timing::*stage;
  std::function<void()> work;
};

// Runs `here` on this thread, and meanwhile `beside` on the other threads that the session has; if
// there are none, `beside` runs afterwards. Neither may touch what the other one writes. What
// either throws is thrown after both have ended. Precondition: the stage before has just ended.
//
// The wall time of `here` is its own; that of `beside` is what it takes longer, so that stages
// still add up to the total. Processor time is that of this thread for `here`, and all other for
// `beside`, also what other threads did for `here`.
void run_beside(Session& session, const StageWork& here, const StageWork& beside);

}  // namespace vdwmesh::apps

// Stages at the same time, by a task of oneTBB. The task is begun by a worker of oneTBB, of
// which there are as many as the session allows beside this thread; without any, this thread runs
// it when it waits for it. The loops within the task use all workers.
//
// The task is never cancelled: that would stop its loops half done.
#include "steps/beside.hpp"

#include <tbb/task_group.h>

#include <algorithm>
#include <ctime>
#include <exception>

namespace vdwmesh::apps {
namespace {

// Processor seconds of this thread.
double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

void run_beside(Session& session, const std::vector<StageWork>& here, const StageWork& beside) {
  std::exception_ptr failure;
  tbb::task_group task;
  task.run(beside.work);
  for (const StageWork& stage : here) {
    if (failure) break;
    const double begin = thread_seconds();
    try {
      stage.work();
    } catch (...) {
      failure = std::current_exception();
    }
    const double thread = thread_seconds() - begin;
    const StageTime lap = session.clock.lap();
    const double own = std::min(thread, lap.cpu);  // the two clocks may differ by a tick
    add(session.report.timing.*stage.stage, {lap.wall, own});
    add(session.report.timing.*beside.stage, {0, lap.cpu - own});
  }
  task.wait();
  session.end_stage(beside.stage);
  if (failure) std::rethrow_exception(failure);
}

}  // namespace vdwmesh::apps

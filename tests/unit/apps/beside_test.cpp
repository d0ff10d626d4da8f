// Stages at the same time: both sides run to their end whatever either throws, and their times add
// up.
#include "steps/beside.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <stdexcept>

namespace vdwmesh::apps {
namespace {

// Keeps a thread busy. Returns a number so that the loop is not left out.
double work(int rounds) {
  double sum = 0;
  for (int i = 1; i < rounds * 100000; ++i) sum += 1.0 / i;
  return sum;
}

class Beside : public ::testing::TestWithParam<std::size_t> {
 protected:
  tbb::global_control threads_{tbb::global_control::max_allowed_parallelism, GetParam()};
  Session session_;
};

TEST_P(Beside, TimesOfBothStagesAddUpToTheClock) {
  std::atomic<int> loops{0};
  double here = 0;
  run_beside(session_, {{&Timing::write, [&] { here = work(40); }}},
             {&Timing::measure,
              [&] { tbb::parallel_for(0, 100, [&](int) { loops += work(2) > 0 ? 1 : 0; }); }});
  EXPECT_EQ(loops, 100);
  EXPECT_GT(here, 0);
  const StageTime write = session_.report.timing.write.value(),
                  measure = session_.report.timing.measure.value(), whole = session_.clock.whole();
  EXPECT_NEAR(write.wall + measure.wall, whole.wall, 1e-9);
  EXPECT_NEAR(write.cpu + measure.cpu, whole.cpu, 1e-9);
  for (const double seconds : {write.wall, write.cpu, measure.cpu}) EXPECT_GT(seconds, 0);
  EXPECT_GE(measure.wall, 0);
}

TEST_P(Beside, SeveralStagesFollowEachOther) {
  double built = 0, written = 0;
  run_beside(session_,
             {{&Timing::build, [&] { built = work(20); }},
              {&Timing::write, [&] { written = built + work(20); }}},
             {&Timing::measure, [] { (void)work(30); }});
  EXPECT_GT(written, built);
  const Timing& timing = session_.report.timing;
  const StageTime whole = session_.clock.whole();
  EXPECT_NEAR(timing.build->wall + timing.write->wall + timing.measure->wall, whole.wall, 1e-9);
  EXPECT_NEAR(timing.build->cpu + timing.write->cpu + timing.measure->cpu, whole.cpu, 1e-9);
  for (const auto& stage : {timing.build, timing.write}) {
    EXPECT_GT(stage->wall, 0);
    EXPECT_GT(stage->cpu, 0);
  }
}

TEST_P(Beside, NoStageFollowsAFailure) {
  bool written = false, ended = false;
  const auto run = [&] {
    run_beside(session_,
               {{&Timing::build, [] { throw std::runtime_error("no fan"); }},
                {&Timing::write, [&] { written = true; }}},
               {&Timing::measure, [&] { ended = work(5) > 0; }});
  };
  EXPECT_THROW(run(), std::runtime_error);
  EXPECT_FALSE(written);
  EXPECT_TRUE(ended);
}

TEST_P(Beside, AFailureHereWaitsForTheOtherStage) {
  bool ended = false;
  const auto fail = [] { throw std::runtime_error("disk full"); };
  const auto run = [&] {
    run_beside(session_, {{&Timing::write, fail}}, {&Timing::measure, [&] {
                                                      tbb::parallel_for(
                                                          0, 10, [&](int) { (void)work(5); });
                                                      ended = true;
                                                    }});
  };
  EXPECT_THROW(run(), std::runtime_error);
  EXPECT_TRUE(ended);
}

TEST_P(Beside, AFailureOfTheOtherStageIsThrown) {
  bool ended = false;
  const auto run = [&] {
    run_beside(session_, {{&Timing::write, [&] { ended = work(5) > 0; }}},
               {&Timing::measure, [] { throw std::runtime_error("no memory"); }});
  };
  EXPECT_THROW(run(), std::runtime_error);
  EXPECT_TRUE(ended);
}

INSTANTIATE_TEST_SUITE_P(Threads, Beside, ::testing::Values(1, 2, 3));

}  // namespace
}  // namespace vdwmesh::apps

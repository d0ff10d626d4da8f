// The progress line of a study.
#include "study/study_progress.hpp"

#include <gtest/gtest.h>

namespace vdwmesh::apps {
namespace {

TEST(StudyProgress, TheRestTakesAsLongAsWhatIsFinished) {
  EXPECT_EQ(time_of_rest(30, 1, 4), 90);
  EXPECT_EQ(time_of_rest(30, 3, 4), 10);
  EXPECT_EQ(time_of_rest(30, 4, 4), 0);
}

TEST(StudyProgress, TimesAreInAUnitThatFits) {
  EXPECT_EQ(duration_text(0.4), "0 s");
  EXPECT_EQ(duration_text(89), "89 s");
  EXPECT_EQ(duration_text(90), "2 min");
  EXPECT_EQ(duration_text(89.4 * 60), "89 min");
  EXPECT_EQ(duration_text(90 * 60), "1.5 h");
}

}  // namespace
}  // namespace vdwmesh::apps

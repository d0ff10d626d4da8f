// What a report says of angles that the crease-exact mesher could not raise. Few sets have some,
// and none a number of them that one could choose, so the counts are set here.
#include <gmock/gmock.h>

#include <iterator>
#include <string>

#include "report/report_text_parts.hpp"
#include "steps/steps.hpp"

namespace vdwmesh::apps {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> notes_of(const ExactMeshStats& stats) {
  Report report;
  describe_exact_mesh(stats, report);
  return report.notes;
}

TEST(SmallAngles, NoneIsNotNoted) {
  EXPECT_THAT(notes_of({}), IsEmpty());
  EXPECT_THAT(notes_of({.below_floor = 0}), IsEmpty());
}

TEST(SmallAngles, OneAndSeveralAreNotedByTheirOwnWords) {
  const std::string floor =
      " below 5°, or below half of the exact angle at a corner: "
      "edges would have to be shorter than the limits allow";
  EXPECT_THAT(notes_of({.below_floor = 1}), ElementsAre("before subdivision 1 angle is" + floor));
  EXPECT_THAT(notes_of({.below_floor = 2}), ElementsAre("before subdivision 2 angles are" + floor));
  EXPECT_THAT(notes_of({.below_min_angle = 1, .below_floor = {}}),
              ElementsAre(HasSubstr("1 triangle has an angle below --min-angle and is not near")));
  EXPECT_THAT(
      notes_of({.below_min_angle = 2, .below_floor = {}}),
      ElementsAre(HasSubstr("2 triangles have an angle below --min-angle and are not near")));
}

std::string proof_of(std::uint64_t below_floor) {
  ComparisonReport comparison;
  comparison.proof.emplace().below_floor = below_floor;
  std::string text;
  proof_text(std::back_inserter(text), comparison, {});
  return text;
}

TEST(SmallAngles, TheProofCountsThem) {
  EXPECT_THAT(proof_of(0), HasSubstr(" 0 angles below their floors, before subdivision\n"));
  EXPECT_THAT(proof_of(1), HasSubstr(" 1 angle below its floor, before subdivision\n"));
  EXPECT_THAT(proof_of(2), HasSubstr(" 2 angles below their floors, before subdivision\n"));
}

}  // namespace
}  // namespace vdwmesh::apps

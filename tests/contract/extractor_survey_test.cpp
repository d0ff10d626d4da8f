// The first sets of the survey of docs/notes/robustness.md.
#include "contract/extractor_contract.hpp"
#include "support/extract_survey.hpp"

namespace vdwmesh::testing {
namespace {

class ExtractorSurvey : public ExtractorContract {};

constexpr std::uint32_t kSets = 250, kSeed = 1;

TEST_P(ExtractorSurvey, EverySetIsSoundAndTheSameWithoutShortcuts) {
  SurveyCounts counts;
  for (std::uint32_t i = 0; i < kSets; ++i) {
    const ExtractSet set = extract_set(kSeed, i);
    EXPECT_EQ(complaint(set, GetParam(), counts), "") << "set " << i << ", " << set.name;
  }
  EXPECT_EQ(counts.sets, kSets);
  EXPECT_GE(counts.separated, kSets / 20);
  if (GetParam() == Backend::cpu) {
    EXPECT_GE(counts.plain, kSets / 10);
  }
}

VDWMESH_INSTANTIATE_BACKENDS(ExtractorSurvey);

}  // namespace
}  // namespace vdwmesh::testing

// What a report says where the CPU did what a device was asked to: no machine runs out of device
// memory on request, so the report is put together here.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "steps/steps.hpp"

namespace vdwmesh::apps {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

Report on_two_devices() {
  Report report;
  report.backend.emplace();
  report.backend->requested = Backend::automatic;
  report.backend->used = Backend::cuda;
  report.backend->device = "Some GPU";
  report.backend->driver = "12.0";
  report.backend->devices = 2;
  return report;
}

nlohmann::json backend_of(const Report& report) {
  return nlohmann::json::parse(to_json(report)).at("backend");
}

TEST(Fallback, ReportsNameTheCpu) {
  const std::string why = "refined on the CPU: the refinement needs 9 bytes, 8 are available";
  Report report = on_two_devices();
  account_for_fallback(why, report);
  const nlohmann::json backend = backend_of(report);
  EXPECT_EQ(backend.at("requested"), "auto");
  EXPECT_EQ(backend.at("used"), "cpu");
  EXPECT_EQ(backend.at("devices"), 0);
  EXPECT_EQ(backend.at("reason"), why);
  EXPECT_EQ(backend.at("device"), "Some GPU") << "it took part, or was tried";
  EXPECT_THAT(report.notes, ElementsAre(why));
  EXPECT_THAT(to_text(report, Verbosity::verbose),
              HasSubstr("Backend      cpu, Some GPU, driver 12.0"));
  EXPECT_THAT(to_text(report, Verbosity::verbose), HasSubstr("; " + why));
  EXPECT_THAT(to_text(report, Verbosity::verbose), Not(HasSubstr("no CUDA")));
}

TEST(Fallback, NothingChangesWithoutOne) {
  Report report = on_two_devices();
  account_for_fallback("", report);
  EXPECT_EQ(backend_of(report), backend_of(on_two_devices()));
  EXPECT_EQ(backend_of(report).at("used"), "cuda");
  EXPECT_THAT(report.notes, IsEmpty());
}

}  // namespace
}  // namespace vdwmesh::apps

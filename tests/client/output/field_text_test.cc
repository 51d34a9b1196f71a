#include "client/output/field_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/result.pb.h"
#include "tests/support/message_text.h"

namespace ballpiston::client {
namespace {

using ::testing::ElementsAre;

TEST(FieldText, HasAFormForEachType) {
  const auto job = FromText<v1::EnsembleJob>(R"(
    name: "ensembleJobs/a" state: RUNNING spec { experiment: FIRST_HIT } pinned: true
    priority: -7 progress { points_done: 3 samples: 1e6 } create_time { seconds: 1700000000 })");
  EXPECT_THAT(
      FieldTexts(job, {"name", "state", "spec.experiment", "pinned", "results_expired", "priority",
                       "progress.points_done", "progress.samples", "create_time", "end_time"}),
      ElementsAre("ensembleJobs/a", "running", "first-hit", "true", "false", "-7", "3", "1000000",
                  "2023-11-14T22:13:20Z", ""));
}

TEST(FieldText, OnlyAnOptionalFieldCanBeAbsent) {
  const auto estimate = FromText<v1::Estimate>("exact: 0.1");
  EXPECT_THAT(FieldTexts(estimate, {"value", "standard_error", "exact"}),
              ElementsAre("0", "", "0.1"));
  EXPECT_EQ(NumberIn(estimate, "standard_error"), std::nullopt);
  EXPECT_EQ(NumberIn(estimate, "exact"), 0.1);
}

}  // namespace
}  // namespace ballpiston::client

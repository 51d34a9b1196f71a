#include "client/figure/comparison_progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/status_matchers.h"

namespace ballpiston::client {
namespace {

constexpr char kLine[] =
    "{\"method\":\"fixed-step\",\"time_step\":0.01,\"quantity\":\"mean-free-time\",\"delta\":0.1,"
    "\"samples\":1024,\"wall_hits\":5000000000,\"work_seconds\":0.1234,\"value\":-1e-05,"
    "\"statistical_error\":0.25}\n";

std::string ReportedComparison(ProgressStyle style) {
  std::ostringstream err;
  ComparisonProgress(style, err).OnMeasurement(*ParseMeasurement(kLine), kLine);
  return err.str();
}

TEST(ComparisonProgress, TheBarRedrawsOneLine) {
  EXPECT_EQ(ReportedComparison(ProgressStyle::kBar),
            "\r  1 measurements  mean-free-time, fixed-step 0.01: 1024 samples in 0.123 s\x1b[K\n");
}

TEST(ComparisonProgress, JsonHasALineForEachMeasurement) {
  EXPECT_EQ(ReportedComparison(ProgressStyle::kJson), kLine);
}

TEST(ComparisonProgress, NonePrintsNothing) {
  EXPECT_EQ(ReportedComparison(ProgressStyle::kNone), "");
}

TEST(MethodMeasurement, IsReadFromItsLine) {
  ASSERT_OK_AND_ASSIGN(const MethodMeasurement measurement, ParseMeasurement(kLine));
  EXPECT_EQ(measurement.delta, 0.1);
  EXPECT_EQ(measurement.wall_hits, 5'000'000'000u);
  EXPECT_EQ(measurement.value, -1e-5);
  EXPECT_EQ(measurement.statistical_error, 0.25);
}

TEST(MethodMeasurement, ALineWithoutAllFieldsIsAnError) {
  for (const char* line : {"", "[]", "{\"method\":\"billiard\"}"}) {
    EXPECT_THAT(ParseMeasurement(line),
                StatusIs(absl::StatusCode::kInternal, testing::HasSubstr("no measurement")))
        << line;
  }
}

}  // namespace
}  // namespace ballpiston::client

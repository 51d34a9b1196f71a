#include "client/output/comparison_progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace ballpiston::client {
namespace {

v1::MethodMeasurement FixedStepMeasurement() {
  v1::MethodMeasurement measurement;
  measurement.set_method(v1::MethodMeasurement::FIXED_STEP);
  measurement.set_time_step(0.01);
  measurement.set_quantity(v1::MethodMeasurement::MEAN_FREE_TIME);
  measurement.set_samples(1024);
  measurement.set_work(0.1234);
  return measurement;
}

std::string ReportedComparison(ProgressStyle style) {
  std::ostringstream err;
  {
    ComparisonProgress progress(style, err);
    progress.Begin();
    progress.OnMeasurement(FixedStepMeasurement());
  }
  return err.str();
}

TEST(ComparisonProgress, TheBarRedrawsOneLine) {
  EXPECT_EQ(ReportedComparison(ProgressStyle::kBar),
            "\rcomparing methods\x1b[K"
            "\r  1 measurements  mean-free-time, fixed-step 0.01: 1024 samples in 0.123 s\x1b[K\n");
}

TEST(ComparisonProgress, JsonHasALineForEachMeasurement) {
  EXPECT_EQ(ReportedComparison(ProgressStyle::kJson),
            "{\"method\":\"FIXED_STEP\",\"time_step\":0.01,\"quantity\":\"MEAN_FREE_TIME\","
            "\"samples\":\"1024\",\"wall_hits\":\"0\",\"work\":0.1234,\"value\":0,"
            "\"statistical_error\":0,\"delta\":0}\n");
}

TEST(ComparisonProgress, NonePrintsNothing) {
  EXPECT_EQ(ReportedComparison(ProgressStyle::kNone), "");
}

}  // namespace
}  // namespace ballpiston::client

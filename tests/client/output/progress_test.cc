#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <sstream>

#include "client/output/progress_line.h"
#include "client/output/progress_meter.h"
#include "client/output/progress_reporter.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::client {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const absl::Time kFirstReading = absl::FromUnixSeconds(1'000'000);

v1::JobProgress Progress(int done, double samples, std::optional<double> fraction) {
  v1::JobProgress progress;
  progress.set_points(100);
  progress.set_points_done(done);
  progress.set_samples(samples);
  if (fraction) progress.set_fraction(*fraction);
  return progress;
}

v1::PointResult ConditionalPoint() {
  v1::PointResult point;
  point.mutable_parameters()->set_delta(0.1);
  point.mutable_parameters()->set_epsilon(0.25);
  v1::Estimate* estimate = point.add_estimates();
  estimate->set_name("mean_free_time_conditional");
  estimate->set_value(21.63214);
  estimate->set_standard_error(0.1234);
  return point;
}

TEST(ProgressMeter, HasNoRateAfterOneReading) {
  ProgressMeter meter;
  meter.Update(Progress(50, 1e6, 0.5), kFirstReading);
  EXPECT_EQ(meter.SamplesPerSecond(), std::nullopt);
  EXPECT_EQ(meter.TimeLeft(), std::nullopt);
  EXPECT_EQ(meter.Fraction(), 0.5);
}

// The rate of a job that was half done when the watch began is that of the watched half.
TEST(ProgressMeter, MeasuresFromTheStartOfTheWatch) {
  ProgressMeter meter;
  meter.Update(Progress(50, 1e6, 0.5), kFirstReading);
  meter.Update(Progress(60, 1.2e6, 0.6), kFirstReading + absl::Seconds(10));
  EXPECT_DOUBLE_EQ(*meter.SamplesPerSecond(), 2e4);
  EXPECT_NEAR(absl::ToDoubleSeconds(*meter.TimeLeft()), 40, 1e-6);
}

TEST(ProgressMeter, FallsBackOnFinishedPoints) {
  ProgressMeter meter;
  meter.Update(Progress(0, 0, std::nullopt), kFirstReading);
  meter.Update(Progress(25, 10, std::nullopt), kFirstReading + absl::Seconds(10));
  EXPECT_NEAR(absl::ToDoubleSeconds(*meter.TimeLeft()), 30, 1e-6);
}

TEST(ProgressMeter, StartsAgainWhenSamplesWereLost) {
  ProgressMeter meter;
  meter.Update(Progress(50, 1e6, 0.5), kFirstReading);
  meter.Update(Progress(40, 8e5, 0.4), kFirstReading + absl::Seconds(10));
  EXPECT_EQ(meter.SamplesPerSecond(), std::nullopt);
  meter.Update(Progress(50, 9e5, 0.5), kFirstReading + absl::Seconds(20));
  EXPECT_DOUBLE_EQ(*meter.SamplesPerSecond(), 1e4);
}

ProgressMeter Halfway() {
  ProgressMeter meter;
  meter.Update(Progress(0, 0, 0), kFirstReading);
  meter.Update(Progress(50, 1234567, 0.5), kFirstReading + absl::Seconds(10));
  return meter;
}

TEST(ProgressLine, ShowsPointsRateTimeAndTheRunningEstimate) {
  EXPECT_EQ(ProgressLine(Halfway(), ConditionalPoint(), 200),
            "[##############--------------] 50/100 points  1.2e5 samples/s  0:10 left  "
            "tau_conditional 21.63 +- 0.12  (delta 0.1 epsilon 0.25)");
}

TEST(ProgressLine, AnOrdinaryTerminalShowsTheEstimate) {
  EXPECT_EQ(ProgressLine(Halfway(), ConditionalPoint(), 79),
            "[##--] 50/100 points  1.2e5 samples/s  0:10 left  tau_conditional 21.63 +- 0.12");
}

TEST(ProgressLine, NeverExceedsTheWidth) {
  for (size_t width = 1; width < 150; ++width) {
    EXPECT_LE(ProgressLine(Halfway(), ConditionalPoint(), width).size(), width);
  }
  EXPECT_EQ(ProgressLine(Halfway(), ConditionalPoint(), 60),
            "[########--------] 50/100 points  1.2e5 samples/s  0:10 left");
}

v1::EnsembleJob RunningJob() {
  v1::EnsembleJob job;
  job.set_name("ensembleJobs/abc");
  job.set_state(v1::EnsembleJob::RUNNING);
  *job.mutable_progress() = Progress(0, 0, 0);
  return job;
}

std::string Reported(ProgressStyle style) {
  std::ostringstream err;
  const auto reporter = NewProgressReporter(style, err);
  reporter->OnJob(RunningJob());
  v1::StatisticsSnapshot snapshot;
  *snapshot.mutable_progress() = Progress(50, 1000, 0.5);
  *snapshot.add_points() = ConditionalPoint();
  reporter->OnSnapshot(snapshot);
  v1::EnsembleJob job = RunningJob();
  job.set_state(v1::EnsembleJob::SUCCEEDED);
  *job.mutable_progress() = Progress(100, 2000, 1);
  reporter->OnJob(job);
  reporter->OnEnd();
  return err.str();
}

TEST(ProgressBar, NamesTheJobOnceRedrawsOneLineAndEndsWithTheState) {
  const std::string text = Reported(ProgressStyle::kBar);
  EXPECT_THAT(text, StartsWith("\rensembleJobs/abc\x1b[K\n"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
  EXPECT_THAT(text, HasSubstr("50/100 points"));
  EXPECT_THAT(text, HasSubstr("\rsucceeded: 100 of 100 points, 2000 samples\x1b[K\n"));
}

// The user can compare the work with the plan.
TEST(ProgressBar, EndsWithTheWorkIfTheServerSendsIt) {
  std::ostringstream err;
  const auto reporter = NewProgressReporter(ProgressStyle::kBar, err);
  v1::EnsembleJob job = RunningJob();
  job.set_work(192);
  reporter->OnJob(job);
  reporter->OnEnd();
  EXPECT_THAT(err.str(), HasSubstr("0 samples, 3.2 min of one core\x1b[K\n"));
}

// The server sends the point that changed last first.
TEST(ProgressBar, HasThePointThatChangedLast) {
  std::ostringstream err;
  const auto reporter = NewProgressReporter(ProgressStyle::kBar, err);
  v1::StatisticsSnapshot snapshot;
  *snapshot.mutable_progress() = Progress(50, 1000, 0.5);
  *snapshot.add_points() = ConditionalPoint();
  *snapshot.add_points() = ConditionalPoint();
  snapshot.mutable_points(1)->mutable_estimates(0)->set_value(99.5);
  reporter->OnSnapshot(snapshot);
  EXPECT_THAT(err.str(), HasSubstr("tau_conditional 21.63"));
  EXPECT_THAT(err.str(), Not(HasSubstr("99.5")));
}

v1::StatisticsSnapshot WithFinishedPoints(int unfinished) {
  v1::StatisticsSnapshot snapshot;
  *snapshot.mutable_progress() = Progress(50, 1000, 0.5);
  for (int i = 0; i < unfinished; ++i) *snapshot.add_points() = ConditionalPoint();
  for (const double mean : {55.5, 66.5}) {
    *snapshot.add_finished_points() = ConditionalPoint();
    snapshot.mutable_finished_points()->rbegin()->mutable_estimates(0)->set_value(mean);
  }
  return snapshot;
}

// At the end of a job with one worker no point is being computed.
TEST(ProgressBar, HasThePointThatFinishedLast) {
  std::ostringstream err;
  NewProgressReporter(ProgressStyle::kBar, err)->OnSnapshot(WithFinishedPoints(0));
  EXPECT_THAT(err.str(), HasSubstr("tau_conditional 66.5"));
}

TEST(ProgressJson, HasUnfinishedAndFinishedPointsNewestFirst) {
  std::ostringstream err;
  const auto reporter = NewProgressReporter(ProgressStyle::kJson, err);
  v1::EnsembleJob job;
  job.set_name("ensembleJobs/abc");
  reporter->OnJob(job);
  reporter->OnSnapshot(WithFinishedPoints(1));
  const std::string text = err.str();
  EXPECT_LT(text.find("21.63"), text.find("66.5"));
  EXPECT_LT(text.find("66.5"), text.find("55.5"));
  EXPECT_NE(text.find("55.5"), std::string::npos);
}

// The server sends the points first, and the state last.
TEST(ProgressJson, HasThePointsOfAnEndedJob) {
  std::ostringstream err;
  const auto reporter = NewProgressReporter(ProgressStyle::kJson, err, "ensembleJobs/abc");
  reporter->OnSnapshot(WithFinishedPoints(0));
  EXPECT_THAT(err.str(),
              StartsWith(R"({"job": "ensembleJobs/abc", "state": "STATE_UNSPECIFIED", )"));
  EXPECT_THAT(err.str(), HasSubstr("66.5"));
}

TEST(ProgressJson, NotesAreObjects) {
  std::ostringstream err;
  NewProgressReporter(ProgressStyle::kJson, err)->Note("a \"hint\"\nof two lines");
  EXPECT_EQ(err.str(), "{\"note\": \"a \\\"hint\\\"\\nof two lines\"}\n");
}

TEST(ProgressJson, IsOneObjectALine) {
  const std::string text = Reported(ProgressStyle::kJson);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
  EXPECT_THAT(text,
              StartsWith(R"({"job": "ensembleJobs/abc", "state": "RUNNING", "progress": )"
                         R"({"points":100,"points_done":0,"samples":0,"fraction":0}, )"
                         R"("samples_per_second": null, "seconds_left": null, "points": []})"));
  EXPECT_THAT(text, HasSubstr(R"("points": [{"index":0,"parameters":{"rho":0,"delta":0.1,)"));
  EXPECT_THAT(text, HasSubstr(R"("state": "SUCCEEDED")"));
}

TEST(ProgressNone, PrintsNotesOnly) {
  EXPECT_EQ(Reported(ProgressStyle::kNone), "");
  std::ostringstream err;
  NewProgressReporter(ProgressStyle::kNone, err)->Note("hint");
  EXPECT_EQ(err.str(), "hint\n");
}

TEST(ProgressStyle, IsOneOfFour) {
  EXPECT_THAT(ParseProgressStyle("bar"), IsOkAndHolds(ProgressStyle::kBar));
  EXPECT_THAT(ParseProgressStyle("json"), IsOkAndHolds(ProgressStyle::kJson));
  EXPECT_THAT(ParseProgressStyle("none"), IsOkAndHolds(ProgressStyle::kNone));
  EXPECT_OK(ParseProgressStyle("auto"));
  EXPECT_THAT(ParseProgressStyle("loud"), StatusIs(absl::StatusCode::kInvalidArgument));
}

}  // namespace
}  // namespace ballpiston::client

#include "client/output/progress.h"

#include <google/protobuf/util/json_util.h>

#include "ballpiston/file/v1/progress.pb.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

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
  return FromText<v1::PointResult>(
      "parameters { delta: 0.1 epsilon: 0.25 }"
      "estimates { name: 'mean_free_time_conditional' value: 21.63214 standard_error: 0.1234 }");
}

// If half of a job was done when the watch began, its rate is the rate of the second half. Without
// a fraction the finished points count.
TEST(ProgressMeter, MeasuresFromTheStartOfTheWatch) {
  ProgressMeter meter, by_points;
  meter.Update(Progress(50, 1e6, 0.5), kFirstReading);
  meter.Update(Progress(60, 1.2e6, 0.6), kFirstReading + absl::Seconds(10));
  EXPECT_DOUBLE_EQ(*meter.SamplesPerSecond(), 2e4);
  EXPECT_NEAR(absl::ToDoubleSeconds(*meter.TimeLeft()), 40, 1e-6);
  by_points.Update(Progress(0, 0, std::nullopt), kFirstReading);
  by_points.Update(Progress(25, 10, std::nullopt), kFirstReading + absl::Seconds(10));
  EXPECT_NEAR(absl::ToDoubleSeconds(*by_points.TimeLeft()), 30, 1e-6);
}

TEST(ProgressMeter, StartsAgainWhenSamplesWereLost) {
  ProgressMeter meter;
  meter.Update(Progress(50, 1e6, 0.5), kFirstReading);
  meter.Update(Progress(40, 8e5, 0.4), kFirstReading + absl::Seconds(10));
  EXPECT_EQ(meter.SamplesPerSecond(), std::nullopt);
  meter.Update(Progress(50, 9e5, 0.5), kFirstReading + absl::Seconds(20));
  EXPECT_DOUBLE_EQ(*meter.SamplesPerSecond(), 1e4);
}

// The job waits for 1000 s, then computes its second half in the same time as its first.
TEST(ProgressMeter, TimeInTheQueueDoesNotCount) {
  ProgressMeter meter;
  for (const int second : {0, 500, 1000}) {
    meter.Update(Progress(0, 0, 0), kFirstReading + absl::Seconds(second));
    EXPECT_EQ(meter.TimeLeft(), std::nullopt);
  }
  meter.Update(Progress(50, 1e6, 0.5), kFirstReading + absl::Seconds(1010));
  EXPECT_DOUBLE_EQ(*meter.SamplesPerSecond(), 1e5);
  EXPECT_NEAR(absl::ToDoubleSeconds(*meter.TimeLeft()), 10, 1e-6);
}

TEST(ProgressLine, ShowsWhatFitsIntoTheWidth) {
  ProgressMeter halfway;
  halfway.Update(Progress(0, 0, 0), kFirstReading);
  halfway.Update(Progress(50, 1234567, 0.5), kFirstReading + absl::Seconds(10));
  const std::pair<size_t, const char*> cases[] = {
      {200,
       "[##############--------------] 50/100 points  1.2e5 samples/s  0:10 left  "
       "tau_conditional 21.63 +- 0.12  (delta 0.1 epsilon 0.25)"},
      {79, "[##--] 50/100 points  1.2e5 samples/s  0:10 left  tau_conditional 21.63 +- 0.12"},
      {60, "[########--------] 50/100 points  1.2e5 samples/s  0:10 left"}};
  for (const auto& [width, line] : cases) {
    EXPECT_EQ(ProgressLine(halfway, ConditionalPoint(), width), line);
  }
  for (size_t width = 1; width < 150; ++width) {
    EXPECT_LE(ProgressLine(halfway, ConditionalPoint(), width).size(), width);
  }
  v1::PointResult gas = ConditionalPoint();
  *gas.mutable_parameters() =
      FromText<v1::PointParameters>("delta: 0.1 cells: '4x3' temperature: 0.5 hot: 2 cold: 1");
  EXPECT_THAT(ProgressLine(halfway, gas, 200),
              EndsWith("  (delta 0.1 cells 4x3 T 0.5 hot 2 cold 1)"));
}

v1::EnsembleJob JobWith(v1::EnsembleJob::State state, const v1::JobProgress& progress) {
  v1::EnsembleJob job = JobIn(state);
  *job.mutable_progress() = progress;
  return job;
}

// A reporter with the text that it wrote.
struct Reported {
  explicit Reported(ProgressStyle style) : reporter(style, err, kJobName) {}
  std::string Text() const { return err.str(); }

  std::ostringstream err;
  ProgressReporter reporter;
};

// The server sends the unfinished point that changed last first, and the point that finished last
// last.
v1::StatisticsSnapshot Snapshot(int unfinished = 1) {
  v1::StatisticsSnapshot snapshot;
  *snapshot.mutable_progress() = Progress(50, 1000, 0.5);
  for (int i = 0; i < unfinished; ++i) *snapshot.add_points() = ConditionalPoint();
  for (const double mean : {55.5, 66.5}) {
    *snapshot.add_finished_points() = ConditionalPoint();
    snapshot.mutable_finished_points()->rbegin()->mutable_estimates(0)->set_value(mean);
    snapshot.mutable_finished_points()->rbegin()->set_name("ensembleJobs/abc/results/1");
  }
  return snapshot;
}

// A whole job, from its start to its end.
std::string ReportOf(ProgressStyle style) {
  Reported report(style);
  report.reporter.OnJob(JobWith(v1::EnsembleJob::RUNNING, Progress(0, 0, 0)));
  report.reporter.OnSnapshot(Snapshot());
  report.reporter.OnJob(JobWith(v1::EnsembleJob::SUCCEEDED, Progress(100, 2000, 1)));
  report.reporter.OnEnd();
  return report.Text();
}

// Clears the bar: to the first column, then to the end of the line.
constexpr char kClear[] = "\r\x1b[K";

TEST(ProgressBar, NamesTheJobOnceRedrawsOneLineAndEndsWithTheState) {
  EXPECT_THAT(ReportOf(ProgressStyle::kBar),
              MatchesRegex("ensembleJobs/abc\n[^\n]*50/100 points [^\r\n]*\x1b\\[K\r[^\n]*"
                           "\r\x1b\\[Ksucceeded: 100 of 100 points, 2000 samples\n"));
}

// The user can compare the work with the plan.
TEST(ProgressBar, EndsWithTheWorkIfTheServerSendsIt) {
  Reported report(ProgressStyle::kBar);
  v1::EnsembleJob job = JobWith(v1::EnsembleJob::RUNNING, Progress(0, 0, 0));
  job.set_work(192);
  report.reporter.OnJob(job);
  report.reporter.OnEnd();
  EXPECT_THAT(report.Text(), HasSubstr("0 samples, 3.2 min of one core\n"));
}

// At the end of a job with one worker no point is running.
TEST(ProgressBar, HasThePointThatChangedLast) {
  Reported running(ProgressStyle::kBar), finished(ProgressStyle::kBar);
  v1::StatisticsSnapshot snapshot = Snapshot(2);
  snapshot.mutable_points(1)->mutable_estimates(0)->set_value(99.5);
  running.reporter.OnSnapshot(snapshot);
  EXPECT_THAT(running.Text(), HasSubstr("tau_conditional 21.63"));
  EXPECT_THAT(running.Text(), Not(HasSubstr("99.5")));
  finished.reporter.OnSnapshot(Snapshot(0));
  EXPECT_THAT(finished.Text(), HasSubstr("tau_conditional 66.5"));
}

TEST(ProgressBar, ANoteClearsTheMessageOfALostConnection) {
  Reported report(ProgressStyle::kBar);
  report.reporter.OnDisconnect(absl::UnavailableError("gone"), absl::Seconds(1.5));
  report.reporter.Note("a");
  report.reporter.OnDisconnect(absl::ResourceExhaustedError("2 open streams"), absl::Seconds(5));
  EXPECT_EQ(report.Text(), absl::StrCat(kClear, "connection lost, retrying in 1.5 s", kClear, "a\n",
                                        kClear, "server busy, retrying in 5.0 s"));
}

// The farewell keeps its lock until the process ends. Therefore these objects are never destroyed.
TEST(ProgressBar, IsNotDrawnAfterTheFarewell) {
  static auto& report = *new Reported(ProgressStyle::kBar);
  report.reporter.OnSnapshot(Snapshot());
  report.reporter.Farewell("a\nb");
  EXPECT_THAT(report.Text(), EndsWith(absl::StrCat(kClear, "a\nb\n")));
  static std::atomic<pid_t> thread = 0;
  static std::atomic<bool> is_redrawn = false;
  std::thread([] {
    thread = gettid();
    report.reporter.OnSnapshot(Snapshot());
    is_redrawn = true;
  }).detach();
  const auto sleeps = [] {  // the thread, at the lock
    return Contents(absl::StrCat("/proc/self/task/", thread.load(), "/stat")).find(") S ") !=
           std::string::npos;
  };
  AwaitThat([&] { return is_redrawn || (thread != 0 && sleeps()); });
  EXPECT_FALSE(is_redrawn);
}

// ---- JSON ----

std::vector<file::v1::WatchProgress> JsonLines(const std::string& text) {
  std::vector<file::v1::WatchProgress> lines;
  for (const absl::string_view line : absl::StrSplit(text, '\n', absl::SkipEmpty())) {
    EXPECT_TRUE(
        google::protobuf::util::JsonStringToMessage(std::string(line), &lines.emplace_back()).ok())
        << line;
  }
  return lines;
}

TEST(ProgressJson, IsOneMessageALine) {
  const auto lines = JsonLines(ReportOf(ProgressStyle::kJson));
  ASSERT_EQ(lines.size(), 3u);
  for (const file::v1::WatchProgress& line : lines) EXPECT_EQ(line.job(), "ensembleJobs/abc");
  EXPECT_EQ(lines[0].state(), v1::EnsembleJob::RUNNING);
  EXPECT_EQ(lines[0].progress().points(), 100);
  EXPECT_FALSE(lines[0].has_samples_per_second());
  EXPECT_FALSE(lines[0].has_seconds_left());
  EXPECT_EQ(lines[1].progress().samples(), 1000);
  EXPECT_GT(lines[1].samples_per_second(), 0);
  EXPECT_GT(lines[1].seconds_left(), 0);
  ASSERT_EQ(lines[1].points_size(), 3);  // the newest first
  EXPECT_EQ(lines[1].points(0).estimates(0).value(), 21.63214);
  EXPECT_EQ(lines[1].points(1).estimates(0).value(), 66.5);
  EXPECT_EQ(lines[1].points(2).estimates(0).value(), 55.5);
  for (const v1::PointResult& point : lines[1].points()) EXPECT_FALSE(point.has_name());
  EXPECT_EQ(lines[2].state(), v1::EnsembleJob::SUCCEEDED);
}

TEST(ProgressJson, AStateIsAbsentUntilItIsKnownAndNotOlderThanTheProgress) {
  Reported report(ProgressStyle::kJson);
  report.reporter.Note("waiting");
  v1::StatisticsSnapshot snapshot;
  *snapshot.mutable_progress() = Progress(1, 100, 1);
  report.reporter.OnSnapshot(snapshot);  // of a job that has ended
  report.reporter.OnJob(JobWith(v1::EnsembleJob::QUEUED, Progress(0, 0, 0)));
  report.reporter.OnSnapshot(snapshot);
  const auto lines = JsonLines(report.Text());
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_FALSE(lines[0].has_state());
  EXPECT_EQ(lines[1].state(), v1::EnsembleJob::RUNNING);
  EXPECT_EQ(lines[2].state(), v1::EnsembleJob::QUEUED);
  EXPECT_EQ(lines[3].state(), v1::EnsembleJob::RUNNING);
}

}  // namespace
}  // namespace ballpiston::client

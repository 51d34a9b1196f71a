// Watches of jobs, and the pauses between their attempts.
#include "client/library/job_watch.h"
#include "client/library/reattach_pace.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

// ---- reattach_pace.h ----

using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;

const ReattachPace::Time kStart = ReattachPace::Time() + hours(1);

WatchOptions ThreeMinutes() {
  WatchOptions options;
  options.initial_backoff = absl::Seconds(1);
  options.max_backoff = absl::Seconds(4);
  options.give_up_after = absl::Minutes(3);
  return options;
}

TEST(ReattachPace, PausesDoubleUpToTheirMaximumAndStartAgainAfterAMessage) {
  const WatchOptions options = ThreeMinutes();
  ReattachPace pace(options, kStart);
  for (int round = 0; round < 2; ++round) {
    for (const double expected : {1, 2, 4, 4, 4, 4}) {
      const std::optional<absl::Duration> pause = pace.NextPause(kStart);
      ASSERT_TRUE(pause);
      EXPECT_GE(absl::ToDoubleSeconds(*pause), 0.999 * expected);
      EXPECT_LE(absl::ToDoubleSeconds(*pause), 1.251 * expected);
    }
    pace.Heard(kStart);
  }
}

TEST(ReattachPace, APauseIsAsLongAsTheServerAsks) {
  const WatchOptions options = ThreeMinutes();
  ReattachPace pace(options, kStart);
  for (const double expected : {10, 10, 10}) {
    const std::optional<absl::Duration> pause = pace.NextPause(kStart, absl::Seconds(10));
    ASSERT_TRUE(pause);
    EXPECT_GE(absl::ToDoubleSeconds(*pause), expected);
    EXPECT_LE(absl::ToDoubleSeconds(*pause), 1.251 * expected);
  }
  EXPECT_FALSE(pace.NextPause(kStart, absl::Minutes(4)));
}

// A pause of 1 s to 1.25 s that begins after 178 s ends within 3 min. A pause that begins after 180
// s ends too late.
TEST(ReattachPace, GivesUpWhenTheNextAttemptWouldComeTooLate) {
  const WatchOptions options = ThreeMinutes();
  EXPECT_TRUE(ReattachPace(options, kStart).NextPause(kStart + seconds(178)));
  EXPECT_FALSE(ReattachPace(options, kStart).NextPause(kStart + seconds(180)));
}

TEST(ReattachPace, TheTimeToGiveUpStartsAgainWithEveryMessage) {
  const WatchOptions options = ThreeMinutes();
  ReattachPace pace(options, kStart);
  ReattachPace::Time now = kStart;
  for (int i = 0; i < 100; ++i) {
    now += minutes(2);
    ASSERT_TRUE(pace.NextPause(now)) << i;
    pace.Heard(now);
  }
  EXPECT_FALSE(pace.NextPause(now + minutes(3)));
}

// ---- job_watch.h ----

using Job = v1::EnsembleJob;

const grpc::Status kUnavailable(grpc::StatusCode::UNAVAILABLE, "connection reset");

WatchScript Unavailable(std::vector<v1::WatchEnsembleJobResponse> messages = {}) {
  return {std::move(messages), kUnavailable};
}

WatchScript Succeeded(const std::string& token = "t") {
  return {{JobMessage(JobIn(Job::SUCCEEDED), token)}, grpc::Status::OK};
}

// Records the callbacks of a watch.
class JobWatch : public ::testing::Test {
 protected:
  JobWatch() {
    options_.initial_backoff = absl::Milliseconds(1);
    options_.max_backoff = absl::Milliseconds(4);
    options_.give_up_after = absl::FromChrono(kPatience);
  }

  void Start(std::vector<WatchScript> watches) {
    server_.ensemble.watches = std::move(watches);
    server_.Start();
  }

  absl::StatusOr<Job> Watch() {
    WatchCallbacks callbacks;
    callbacks.on_job = [this](const auto& job) { states_.push_back(job.state()); };
    callbacks.on_snapshot = [this](const auto& snapshot) {
      samples_.push_back(snapshot.progress().samples());
      after_snapshot_();
    };
    callbacks.on_disconnect = [this](const absl::Status&, absl::Duration pause) {
      pauses_.push_back(absl::ToDoubleMilliseconds(pause));
      after_disconnect_();
    };
    return Client(server_.Channel(), kCallTimeout, revival_)
        .Watch(kJobName, callbacks, options_, stop_.get_token());
  }

  std::vector<std::string> Tokens() const {
    std::vector<std::string> tokens;
    const auto asked = server_.ensemble.Asked();
    for (const auto& request : asked.watch) tokens.push_back(request.resume_token());
    return tokens;
  }

  FakeServer server_;
  WatchOptions options_;
  Revival revival_;
  std::stop_source stop_;
  std::function<void()> after_snapshot_ = [] {}, after_disconnect_ = [] {};
  std::vector<Job::State> states_;
  std::vector<double> samples_;
  std::vector<double> pauses_;  // in milliseconds, one for each disconnection
};

TEST_F(JobWatch, ReportsSnapshotsAndEndsWithTheJob) {
  Start({{{JobMessage(JobIn(Job::RUNNING), "t1"), SnapshotMessage(10, "t2"),
           SnapshotMessage(20, "t3"), JobMessage(JobIn(Job::SUCCEEDED), "t4")},
          grpc::Status::OK}});
  ASSERT_OK_AND_ASSIGN(const Job job, Watch());
  EXPECT_EQ(job.state(), Job::SUCCEEDED);
  EXPECT_THAT(states_, ElementsAre(Job::RUNNING, Job::SUCCEEDED));
  EXPECT_THAT(samples_, ElementsAre(10, 20));
}

TEST_F(JobWatch, PassesTheLastResumeTokenOn) {
  Start({Unavailable({JobMessage(JobIn(Job::RUNNING), "t1"), SnapshotMessage(10, "t2")}),
         Unavailable(), Unavailable({SnapshotMessage(20, "t3")}), Succeeded("t4")});
  EXPECT_OK(Watch());
  EXPECT_THAT(Tokens(), ElementsAre("", "t2", "t2", "t3"));
  EXPECT_THAT(samples_, ElementsAre(10, 20));
  EXPECT_THAT(pauses_, SizeIs(3));
}

// The server sends the terminal state twice, then the stream breaks: on_job is called once.
TEST_F(JobWatch, ShowsTheTerminalStateOnce) {
  const auto last = JobMessage(JobIn(Job::CANCELLED), "t1");
  Start({Unavailable({last, last}), {{last}, grpc::Status::OK}});
  ASSERT_OK_AND_ASSIGN(const Job job, Watch());
  EXPECT_EQ(job.state(), Job::CANCELLED);
  EXPECT_THAT(states_, ElementsAre(Job::CANCELLED));
  EXPECT_THAT(Tokens(), SizeIs(1));
}

TEST_F(JobWatch, AnEndWithoutTheTerminalStateIsADisconnection) {
  Start({{{SnapshotMessage(10, "t1")}, grpc::Status::OK}, Succeeded()});
  EXPECT_OK(Watch());
  EXPECT_THAT(Tokens(), ElementsAre("", "t1"));
}

class ErrorOfWatch : public JobWatch, public ::testing::WithParamInterface<grpc::StatusCode> {};

TEST_P(ErrorOfWatch, EndsTheWatch) {
  Start({Unavailable({SnapshotMessage(10, "t1")}), {{}, grpc::Status(GetParam(), "text")}});
  EXPECT_THAT(Watch(), StatusIs(GetParam()));
  EXPECT_THAT(Tokens(), SizeIs(2));
}

INSTANTIATE_TEST_SUITE_P(JobWatch, ErrorOfWatch,
                         ::testing::Values(grpc::StatusCode::NOT_FOUND,
                                           grpc::StatusCode::UNAUTHENTICATED,
                                           grpc::StatusCode::RESOURCE_EXHAUSTED));

// No server listens at the address for a while, as during a restart.
TEST_F(JobWatch, WaitsForAnAbsentServer) {
  server_.ensemble.watches = {Succeeded()};
  after_disconnect_ = [this] {
    if (pauses_.size() == 3) server_.Start();
  };
  EXPECT_OK(Watch());
  EXPECT_THAT(pauses_, SizeIs(Ge(3)));
}

// This test does not count attempts: their number within the time depends on the machine.
TEST_F(JobWatch, GivesUpAfterTheConfiguredTime) {
  Start({Unavailable()});
  options_.give_up_after = absl::Milliseconds(50);
  EXPECT_THAT(Watch(),
              StatusIs(absl::StatusCode::kUnavailable,
                       HasSubstr("gave up watching after 50ms without a connection: connection "
                                 "reset")));
}

// Each attempt receives a message before it fails: the server is alive. The message restarts both
// the pauses and the time to give up.
TEST_F(JobWatch, ThePaceStartsAgainWithEveryMessage) {
  std::vector<WatchScript> watches(100, Unavailable({SnapshotMessage(1, "t")}));
  watches.push_back(Succeeded());
  Start(watches);
  EXPECT_OK(Watch());
  EXPECT_THAT(pauses_, AllOf(SizeIs(100), Each(Le(1.25))));
}

TEST_F(JobWatch, StartsTheServerAgainBeforeEachNewAttempt) {
  Start({Unavailable(), Unavailable(), Succeeded()});
  int revivals = 0;
  revival_ = [&revivals] {
    ++revivals;
    return absl::OkStatus();
  };
  EXPECT_OK(Watch());
  EXPECT_EQ(revivals, 2);
}

TEST_F(JobWatch, AStopEndsTheWatchAtOnce) {
  Start({{.messages = {SnapshotMessage(1, "t1")}, .end = grpc::Status::OK, .hangs = true}});
  after_snapshot_ = [this] { stop_.request_stop(); };
  EXPECT_THAT(Watch(), StatusIs(absl::StatusCode::kCancelled));
}

TEST_F(JobWatch, AStopEndsThePauseBetweenAttempts) {
  Start({Unavailable()});
  options_.initial_backoff = absl::FromChrono(kUnreachedLimit);
  options_.give_up_after = absl::InfiniteDuration();
  after_disconnect_ = [this] { stop_.request_stop(); };
  EXPECT_THAT(Watch(), StatusIs(absl::StatusCode::kCancelled));
}

}  // namespace
}  // namespace ballpiston::client

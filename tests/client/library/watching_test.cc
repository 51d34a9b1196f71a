// Watches of jobs, and the pauses between their attempts.
#include "client/library/job_watch.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

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
    server_.jobs = {JobIn(Job::QUEUED)};
    options_.initial_backoff = absl::Milliseconds(1);
    options_.max_backoff = absl::Milliseconds(4);
    options_.give_up_after = absl::FromChrono(kPatience);
  }

  void Start(std::vector<WatchScript> watches) {
    server_.watches = std::move(watches);
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
    for (const auto& request : server_.Asked<v1::WatchEnsembleJobRequest>()) {
      tokens.push_back(request.resume_token());
    }
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

// An end of the stream without the terminal state is a disconnection.
TEST_F(JobWatch, PassesTheLastResumeTokenOn) {
  Start({Unavailable({JobMessage(JobIn(Job::RUNNING), "t1"), SnapshotMessage(10, "t2")}),
         Unavailable(),
         {{SnapshotMessage(20, "t3")}, grpc::Status::OK},
         Succeeded("t4")});
  EXPECT_OK(Watch());
  EXPECT_THAT(Tokens(), ElementsAre("", "t2", "t2", "t3"));
  EXPECT_THAT(states_, ElementsAre(Job::RUNNING, Job::SUCCEEDED));
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

TEST_F(JobWatch, OtherErrorsEndTheWatch) {
  const std::vector<grpc::StatusCode> codes = {grpc::StatusCode::NOT_FOUND,
                                               grpc::StatusCode::UNAUTHENTICATED,
                                               grpc::StatusCode::RESOURCE_EXHAUSTED};
  std::vector<WatchScript> watches;
  for (const grpc::StatusCode code : codes) {
    watches.push_back(Unavailable({SnapshotMessage(10, "t1")}));
    watches.push_back({{}, grpc::Status(code, "text")});
  }
  Start(watches);
  for (const grpc::StatusCode code : codes) EXPECT_THAT(Watch(), StatusIs(code));
  EXPECT_THAT(Tokens(), ElementsAre("", "t1", "", "t1", "", "t1"));
}

// Each pause is up to a quarter longer at random. A message restarts the pauses.
TEST_F(JobWatch, PausesDoubleUpToTheirMaximum) {
  Start({Unavailable(), Unavailable(), Unavailable(), Unavailable(),
         Unavailable({SnapshotMessage(1, "t")}), Unavailable(), Succeeded()});
  EXPECT_OK(Watch());
  const std::vector<double> least = {1, 2, 4, 4, 1, 2};
  ASSERT_EQ(pauses_.size(), least.size());
  for (size_t i = 0; i < least.size(); ++i) {
    EXPECT_GE(pauses_[i], 0.999 * least[i]);
    EXPECT_LE(pauses_[i], 1.251 * least[i]);
  }
}

grpc::Status BusyFor(std::chrono::milliseconds pause) {
  google::rpc::RetryInfo retry;
  retry.mutable_retry_delay()->set_nanos(static_cast<int32_t>(pause / std::chrono::nanoseconds(1)));
  google::rpc::Status details;
  details.add_details()->PackFrom(retry);
  return {grpc::StatusCode::UNAVAILABLE, "busy", details.SerializeAsString()};
}

TEST_F(JobWatch, APauseIsAsLongAsTheServerAsks) {
  Start({{{}, BusyFor(std::chrono::milliseconds(20))}, Succeeded()});
  EXPECT_OK(Watch());
  EXPECT_THAT(pauses_, ElementsAre(AllOf(Ge(20), Le(25.1))));
}

WatchScript TooManyStreams() {
  return {{},
          WithReason(grpc::StatusCode::RESOURCE_EXHAUSTED, "2 open streams", "TOO_MANY_STREAMS")};
}

TEST_F(JobWatch, WaitsForABusyServer) {
  Start({TooManyStreams(), Succeeded()});
  EXPECT_OK(Watch());
  EXPECT_THAT(pauses_, SizeIs(1));
}

// No server listens at the address for a while, as during a restart.
TEST_F(JobWatch, WaitsForAnAbsentServer) {
  server_.watches = {Succeeded()};
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

TEST_F(JobWatch, ReturnsTheErrorOfAServerThatStaysBusy) {
  Start({TooManyStreams()});
  options_.give_up_after = absl::Milliseconds(50);
  EXPECT_THAT(Watch(), StatusIs(absl::StatusCode::kResourceExhausted,
                                HasSubstr("2 open streams (TOO_MANY_STREAMS)")));
}

// Each silence takes 0.8 s to 1 s, both together more than the time to give up.
TEST_F(JobWatch, TheTimeToGiveUpStartsAgainWithEveryMessage) {
  const grpc::Status busy = BusyFor(std::chrono::milliseconds(800));
  Start({{{}, busy}, {{SnapshotMessage(1, "t")}, busy}, Succeeded()});
  options_.give_up_after = absl::Milliseconds(1500);
  EXPECT_OK(Watch());
}

// A process that is stopped during the first stream is imitated by a sleep in the callback.
TEST_F(JobWatch, TheTimeToGiveUpBeginsWhenTheStreamBreaks) {
  Start({Unavailable({SnapshotMessage(1, "t")}), Succeeded()});
  options_.give_up_after = absl::Milliseconds(500);
  after_snapshot_ = [] { std::this_thread::sleep_for(std::chrono::milliseconds(600)); };
  EXPECT_OK(Watch());
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

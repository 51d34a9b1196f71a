#include "client/library/job_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stop_token>
#include <string>
#include <vector>

#include "client/library/ensemble_client.h"
#include "tests/client/fake_server.h"

namespace ballpiston::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr char kName[] = "ensembleJobs/abc";

const grpc::Status kUnavailable(grpc::StatusCode::UNAVAILABLE, "connection reset");

WatchOptions Quick() {
  WatchOptions options;
  options.initial_backoff = absl::Milliseconds(1);
  options.max_backoff = absl::Milliseconds(4);
  options.give_up_after = absl::Minutes(10);
  return options;
}

// Watches with everything that was shown noted down.
struct Watcher {
  std::vector<v1::EnsembleJob::State> states;
  std::vector<double> samples;
  int disconnects = 0;

  absl::StatusOr<v1::EnsembleJob> Watch(const FakeServer& server, const WatchOptions& options,
                                        std::stop_token stop = {}) {
    WatchCallbacks callbacks;
    callbacks.on_job = [this](const auto& job) { states.push_back(job.state()); };
    callbacks.on_snapshot = [this](const auto& snapshot) {
      samples.push_back(snapshot.progress().samples());
    };
    callbacks.on_disconnect = [this](const absl::Status&, absl::Duration) { ++disconnects; };
    return EnsembleClient(server.Channel()).Watch(kName, callbacks, options, stop);
  }
};

std::vector<std::string> TokensOf(const FakeServer& server) {
  std::vector<std::string> tokens;
  const auto asked = server.ensemble.Asked();
  for (const auto& request : asked.watch) {
    tokens.push_back(request.resume_token());
  }
  return tokens;
}

TEST(JobWatch, ShowsSnapshotsAndEndsWithTheJob) {
  FakeServer server;
  server.ensemble.watches = {
      {{JobMessage(JobIn(v1::EnsembleJob::RUNNING), "t1"), SnapshotMessage(10, "t2"),
        SnapshotMessage(20, "t3"), JobMessage(JobIn(v1::EnsembleJob::SUCCEEDED), "t4")},
       grpc::Status::OK}};
  server.Start();
  Watcher watcher;
  const auto job = watcher.Watch(server, Quick());
  ASSERT_TRUE(job.ok()) << job.status();
  EXPECT_EQ(job->state(), v1::EnsembleJob::SUCCEEDED);
  EXPECT_THAT(watcher.states, ElementsAre(v1::EnsembleJob::RUNNING, v1::EnsembleJob::SUCCEEDED));
  EXPECT_THAT(watcher.samples, ElementsAre(10, 20));
}

TEST(JobWatch, PassesTheLastResumeTokenOn) {
  FakeServer server;
  server.ensemble.watches = {
      {{JobMessage(JobIn(v1::EnsembleJob::RUNNING), "t1"), SnapshotMessage(10, "t2")},
       kUnavailable},
      {{}, kUnavailable},
      {{SnapshotMessage(20, "t3")}, kUnavailable},
      {{JobMessage(JobIn(v1::EnsembleJob::SUCCEEDED), "t4")}, grpc::Status::OK}};
  server.Start();
  Watcher watcher;
  const auto job = watcher.Watch(server, Quick());
  ASSERT_TRUE(job.ok()) << job.status();
  EXPECT_THAT(TokensOf(server), ElementsAre("", "t2", "t2", "t3"));
  EXPECT_THAT(watcher.samples, ElementsAre(10, 20));
  EXPECT_EQ(watcher.disconnects, 3);
}

// The stream breaks after the terminal state, and the server repeats it: one is shown.
TEST(JobWatch, ShowsTheTerminalStateOnce) {
  FakeServer server;
  const auto last = JobMessage(JobIn(v1::EnsembleJob::CANCELLED), "t1");
  server.ensemble.watches = {{{last, last}, kUnavailable}, {{last}, grpc::Status::OK}};
  server.Start();
  Watcher watcher;
  const auto job = watcher.Watch(server, Quick());
  ASSERT_TRUE(job.ok()) << job.status();
  EXPECT_EQ(job->state(), v1::EnsembleJob::CANCELLED);
  EXPECT_THAT(watcher.states, ElementsAre(v1::EnsembleJob::CANCELLED));
  EXPECT_EQ(server.ensemble.Asked().watch.size(), 1u);
}

TEST(JobWatch, AnEndWithoutTheTerminalStateIsADisconnection) {
  FakeServer server;
  server.ensemble.watches = {
      {{SnapshotMessage(10, "t1")}, grpc::Status::OK},
      {{JobMessage(JobIn(v1::EnsembleJob::SUCCEEDED), "t2")}, grpc::Status::OK}};
  server.Start();
  Watcher watcher;
  EXPECT_TRUE(watcher.Watch(server, Quick()).ok());
  EXPECT_THAT(TokensOf(server), ElementsAre("", "t1"));
}

TEST(JobWatch, OtherErrorsEndTheWatch) {
  for (const grpc::Status& end :
       {JobNotFound(kName), grpc::Status(grpc::StatusCode::UNAUTHENTICATED, "who is this?"),
        grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED, "too many")}) {
    FakeServer server;
    server.ensemble.watches = {{{SnapshotMessage(10, "t1")}, kUnavailable}, {{}, end}};
    server.Start();
    Watcher watcher;
    const auto job = watcher.Watch(server, Quick());
    EXPECT_EQ(static_cast<int>(job.status().code()), static_cast<int>(end.error_code()));
    EXPECT_EQ(server.ensemble.Asked().watch.size(), 2u);
  }
}

// As after a restart: nobody listens at the address for a while.
TEST(JobWatch, AServerThatIsNotThereIsWaitedFor) {
  FakeServer server;
  server.ensemble.watches = {
      {{JobMessage(JobIn(v1::EnsembleJob::SUCCEEDED), "t1")}, grpc::Status::OK}};
  int disconnects = 0;
  WatchCallbacks callbacks;
  callbacks.on_disconnect = [&](const absl::Status&, absl::Duration) {
    if (++disconnects == 3) server.Start();
  };
  const auto job = EnsembleClient(server.Channel()).Watch(kName, callbacks, Quick());
  ASSERT_TRUE(job.ok()) << job.status();
  EXPECT_GE(disconnects, 3);
}

// How many attempts fit into the time is the machine's affair: that there are more, if it is long
// enough, other tests show.
TEST(JobWatch, GivesUpAfterTheConfiguredTime) {
  FakeServer server;
  server.ensemble.watches = {{{}, kUnavailable}};
  server.Start();
  WatchOptions options = Quick();
  options.give_up_after = absl::Milliseconds(50);
  Watcher watcher;
  const auto job = watcher.Watch(server, options);
  EXPECT_EQ(job.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(job.status().message()),
              HasSubstr("gave up watching after 50ms without the server: connection reset"));
}

TEST(JobWatch, AnUnavailableServerIsAskedAgain) {
  FakeServer server;
  server.ensemble.watches.assign(3, {{}, kUnavailable});
  server.ensemble.watches.push_back(
      {{JobMessage(JobIn(v1::EnsembleJob::SUCCEEDED), "t")}, grpc::Status::OK});
  server.Start();
  Watcher watcher;
  EXPECT_TRUE(watcher.Watch(server, Quick()).ok());
  EXPECT_EQ(watcher.disconnects, 3);
  EXPECT_EQ(server.ensemble.Asked().watch.size(), 4u);
}

// Each attempt fails, but each brings news: the server is not gone. The time to give up starts
// again together with the pauses (reattach_pace_test.cc).
TEST(JobWatch, ThePaceStartsAgainWithEveryMessage) {
  FakeServer server;
  server.ensemble.watches.assign(100, {{SnapshotMessage(1, "t")}, kUnavailable});
  server.ensemble.watches.push_back(
      {{JobMessage(JobIn(v1::EnsembleJob::SUCCEEDED), "t")}, grpc::Status::OK});
  server.Start();
  const WatchOptions options = Quick();
  std::vector<absl::Duration> pauses;
  WatchCallbacks callbacks;
  callbacks.on_disconnect = [&](const absl::Status&, absl::Duration pause) {
    pauses.push_back(pause);
  };
  EXPECT_TRUE(EnsembleClient(server.Channel()).Watch(kName, callbacks, options).ok());
  ASSERT_EQ(pauses.size(), 100u);
  for (const absl::Duration pause : pauses) EXPECT_LE(pause, 1.25 * options.initial_backoff);
}

TEST(JobWatch, PausesDoubleUpToTheirMaximum) {
  FakeServer server;
  server.ensemble.watches.assign(8, {{}, kUnavailable});
  server.ensemble.watches.push_back(
      {{JobMessage(JobIn(v1::EnsembleJob::SUCCEEDED), "t")}, grpc::Status::OK});
  server.Start();
  std::vector<double> pauses;
  WatchCallbacks callbacks;
  callbacks.on_disconnect = [&](const absl::Status&, absl::Duration pause) {
    pauses.push_back(absl::ToDoubleMilliseconds(pause));
  };
  EXPECT_TRUE(EnsembleClient(server.Channel()).Watch(kName, callbacks, Quick()).ok());
  const double expected[] = {1, 2, 4, 4, 4, 4, 4, 4};
  ASSERT_EQ(pauses.size(), std::size(expected));
  for (size_t i = 0; i < pauses.size(); ++i) {
    EXPECT_GE(pauses[i], expected[i] * 0.999);
    EXPECT_LE(pauses[i], expected[i] * 1.251);
  }
}

TEST(JobWatch, RunsTheHookBeforeEachNewAttempt) {
  FakeServer server;
  server.ensemble.watches = {
      {{}, kUnavailable},
      {{}, kUnavailable},
      {{JobMessage(JobIn(v1::EnsembleJob::SUCCEEDED), "t")}, grpc::Status::OK}};
  server.Start();
  WatchOptions options = Quick();
  int revivals = 0;
  options.before_reattach = [&revivals] { ++revivals; };
  EXPECT_TRUE(Watcher().Watch(server, options).ok());
  EXPECT_EQ(revivals, 2);
}

TEST(JobWatch, AStopEndsTheWatchAtOnce) {
  FakeServer server;
  WatchScript hanging{{SnapshotMessage(1, "t1")}, grpc::Status::OK};
  hanging.hangs = true;
  server.ensemble.watches = {hanging};
  server.Start();
  std::stop_source stop;
  WatchCallbacks callbacks;
  callbacks.on_snapshot = [&stop](const auto&) { stop.request_stop(); };
  const auto job =
      EnsembleClient(server.Channel()).Watch(kName, callbacks, Quick(), stop.get_token());
  EXPECT_EQ(job.status().code(), absl::StatusCode::kCancelled);
}

TEST(JobWatch, AStopEndsThePauseBetweenAttempts) {
  FakeServer server;
  server.ensemble.watches = {{{}, kUnavailable}};
  server.Start();
  WatchOptions options;
  options.initial_backoff = absl::Hours(1);
  options.give_up_after = absl::InfiniteDuration();
  std::stop_source stop;
  WatchCallbacks callbacks;
  callbacks.on_disconnect = [&](const absl::Status&, absl::Duration) { stop.request_stop(); };
  const auto job =
      EnsembleClient(server.Channel()).Watch(kName, callbacks, options, stop.get_token());
  EXPECT_EQ(job.status().code(), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace ballpiston::client

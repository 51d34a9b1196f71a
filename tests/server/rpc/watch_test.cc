#include <chrono>
#include <latch>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/escaping.h"
#include "gmock/gmock.h"
#include "server/store/job_record.h"
#include "tests/server/error_details.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/own_channel.h"
#include "tests/server/requests.h"
#include "tests/server/rpc/watch_stream.h"
#include "tests/server/running_server.h"
#include "tests/server/store_access.h"
#include "tests/support/await.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::Not;
using v1::EnsembleJob;

bool HasPoints(const WatchMessage& message) { return message.snapshot().points_size() > 0; }

bool TellsFinished(const WatchMessage& message) {
  return message.snapshot().finished_points_size() > 0;
}

// The finished points in the messages, in their order.
std::vector<int> FinishedIn(const std::vector<WatchMessage>& messages) {
  std::vector<int> points;
  for (const WatchMessage& message : messages) {
    EXPECT_LE(message.snapshot().finished_points_size(), 100);
    for (const auto& point : message.snapshot().finished_points()) points.push_back(point.index());
  }
  return points;
}

size_t DistinctOf(const std::vector<int>& points) {
  return std::set<int>(points.begin(), points.end()).size();
}

class WatchTest : public testing::Test {
 protected:
  // Fake experiments; blocks from `held_from` on wait at the gate.
  RunningServer& Start(uint64_t held_from = std::numeric_limits<uint64_t>::max(),
                       std::chrono::milliseconds heartbeat = WatchTiming().heartbeat) {
    return StartWith({.factory = GatedExperiments(gate_, held_from),
                      .watch = {std::chrono::milliseconds(2), heartbeat}});
  }

  RunningServer& StartWith(TestServerOptions options) {
    server_.reset();  // first: one at a time
    options.data_dir = folder_.path();
    server_.emplace(options);
    return *server_;
  }

  Gate gate_;
  TemporaryFolder folder_;
  std::optional<RunningServer> server_;
};

// ---- resume tokens ----

// Each watch reads a few messages and leaves; the next one continues with its last token, also
// after restarts of the server. The simulation (tests/simulation) compares such chains of watches
// with the reference model while jobs are computed.
TEST_F(WatchTest, ResumesAfterTheLastPointThatWasRead) {
  const std::string name = Start().Submit(Equilibrium(2000, 1));
  std::vector<WatchMessage> chain;
  for (int watch = 0; chain.empty() || !HasEnded(chain.back().job().state()); ++watch) {
    if (watch % 4 == 3) Start();  // again
    WatchStream stream(*server_, name, chain.empty() ? "" : chain.back().resume_token());
    for (int read = 0; read <= watch % 3; ++read) {
      const auto message = stream.Next();
      if (!message) break;
      chain.push_back(*message);
    }
    stream.Leave();
  }
  EXPECT_EQ(chain.back().job().state(), EnsembleJob::SUCCEEDED);
  EXPECT_EQ(FinishedIn(chain).size(), 2000u);
  EXPECT_EQ(DistinctOf(FinishedIn(chain)), 2000u);
  // The order of the points is that of the store, for every watch.
  EXPECT_EQ(FinishedIn(WatchStream(*server_, name).ToTheEnd()), FinishedIn(chain));
  const auto rest = WatchStream(*server_, name, chain.back().resume_token()).ToTheEnd();
  ASSERT_EQ(rest.size(), 1u);  // with the last token only the end is sent
  EXPECT_EQ(rest[0].job().state(), EnsembleJob::SUCCEEDED);
}

TEST_F(WatchTest, WithoutAValidTokenAllIsSent) {
  RunningServer& server = Start();
  const std::string name = server.Succeeded(Equilibrium(3, 1));
  const std::string other = server.Succeeded(Equilibrium(3, 1));
  std::vector<std::string> tokens = {WatchStream(server, other).ToTheEnd().back().resume_token(),
                                     "nonsense", "%", std::string(10'000, 'A')};
  const std::string id = name.substr(name.find('/') + 1);
  for (const std::string numbers : {"0:4:a:1", "0:-1:a:1", "0:1e9:a:1", "0:2:a:x", "0:2:a",
                                    ":::", "1:2:a:1", "-1:2:a:1", "x:2:a:1", "0:2:a:1:7"}) {
    tokens.push_back(absl::WebSafeBase64Escape(id + ":" + numbers));
  }
  for (const std::string& token : tokens) {
    WatchStream stream(server, name, token);
    EXPECT_EQ(stream.Until(TellsFinished).snapshot().finished_points_size(), 3) << token;
    EXPECT_OK(stream.End());
  }
}

// Also if this engine computed the job at first, and another engine later.
TEST_F(WatchTest, AfterARestartForAnotherEngineAllIsSentAgain) {
  const std::string name = Start().Succeeded(Equilibrium(3, 1));
  const std::string token = WatchStream(*server_, name).ToTheEnd().back().resume_token();
  server_.reset();
  ChangeStore(folder_.File("store.sqlite3"),
              "UPDATE jobs SET state = 2, engine_version = '0.0.1'");  // RUNNING
  EXPECT_EQ(FinishedIn(WatchStream(Start(), name, token).ToTheEnd()).size(), 3u);
}

TEST_F(WatchTest, WithATokenOnlyNewerStateIsSent) {
  RunningServer& server = Start(7, std::chrono::milliseconds(20));
  const std::string name = server.Submit(Equilibrium(1, 100));
  gate_.AwaitWaiting(2);  // seven blocks are done; the others wait
  std::string token;
  {
    WatchStream stream(server, name);
    token = stream
                .Until([](const WatchMessage& message) {
                  return HasPoints(message) &&
                         message.snapshot().points(0).samples() == 7 * kFakeSamplesPerBlock;
                })
                .resume_token();
    stream.context.TryCancel();
  }
  WatchStream again(server, name, token);
  EXPECT_TRUE(again.Next()->has_job());
  again.Until([](const WatchMessage& message) {
    EXPECT_FALSE(HasPoints(message));
    return message.has_heartbeat();
  });
}

// ---- messages ----

// Both to a watch that began before the end, when the job was active, and to a later watch.
TEST_F(WatchTest, TheEndSaysWhenTheResultsExpire) {
  RunningServer& server =
      StartWith({.factory = GatedExperiments(gate_, 3), .limits = {.retain_days = 3}});
  const std::string name = server.Submit(Equilibrium(1, 5));
  WatchStream stream(server, name);
  EXPECT_FALSE(stream.Next()->job().has_expire_time());
  gate_.Open();
  for (const EnsembleJob& job :
       {stream.ToTheEnd().back().job(), WatchStream(server, name).ToTheEnd().back().job()}) {
    EXPECT_EQ(job.expire_time().seconds() - job.end_time().seconds(), 3 * 86400);
  }
}

TEST_F(WatchTest, AQuietJobHasAHeartbeat) {
  RunningServer& server = Start(0, std::chrono::milliseconds(20));
  WatchStream stream(server, server.Submit(Equilibrium(1, 100)));
  int beats = 0;
  stream.Until(
      [&](const WatchMessage& message) { return message.has_heartbeat() && ++beats == 3; });
  EXPECT_EQ(beats, 3);
}

TEST_F(WatchTest, TheJobHasNoGrid) {
  RunningServer& server = Start(0);
  const std::string name = server.Submit(LargeEquilibrium());
  WatchStream stream(server, name);
  const auto first = stream.Next();
  ASSERT_TRUE(first);
  EXPECT_FALSE(first->job().spec().has_grid());
  EXPECT_EQ(first->job().spec().experiment(), v1::EnsembleSpec::EQUILIBRIUM);
  EXPECT_EQ(first->job().progress().points(), 90'000);
}

// The points are far more than a stalled stream can hold, and do not wait for the reader.
TEST_F(WatchTest, ASlowReaderGetsEveryFinishedPoint) {
  RunningServer& server = Start();
  const std::string name = server.Submit(Equilibrium(20'000, 1));
  WatchStream slow(server, name);
  ASSERT_TRUE(slow.Next());
  EXPECT_EQ(server.AwaitEnd(name).progress().points_done(), 20'000);
  const std::vector<WatchMessage> messages = slow.ToTheEnd();
  EXPECT_OK(slow.reader->Finish());
  EXPECT_EQ(FinishedIn(messages).size(), 20'000u);
  EXPECT_EQ(DistinctOf(FinishedIn(messages)), 20'000u);
}

// The point has 10,000 states. A slow reader does not get a state that a newer one has replaced.
TEST_F(WatchTest, ASlowReaderSkipsStatesOfUnfinishedPoints) {
  RunningServer& server = Start(10'000);
  const std::string name = server.Submit(Equilibrium(1, 20'000));
  WatchStream slow(server, name);
  ASSERT_TRUE(slow.Next());
  gate_.AwaitWaiting(2);
  int messages = 0;
  slow.Until([&](const WatchMessage& message) {
    ++messages;
    return HasPoints(message) &&
           message.snapshot().points(0).samples() == 10'000 * kFakeSamplesPerBlock;
  });
  EXPECT_LT(messages, 10'000);
}

// ---- ends ----

TEST_F(WatchTest, AStoppingServerEndsWatchesWithUnavailable) {
  RunningServer& server = Start(5);
  const std::string name = server.Submit(Equilibrium(1, 50));
  WatchStream stream(server, name);
  ASSERT_TRUE(stream.Next());
  std::thread stop([&] { server.Shutdown(kNever); });
  const grpc::Status status = stream.End();
  stop.join();
  EXPECT_THAT(status, IsError(grpc::StatusCode::UNAVAILABLE, "SHUTTING_DOWN"));
}

// Only the end of the time to drain can end these streams: a stop that waited for anything else
// would never end.
TEST_F(WatchTest, AStalledReaderDoesNotDelayAStop) {
  RunningServer& server = StartWith({.connections = kOnlyClosedByAStop});
  const std::string name = server.Succeeded(Equilibrium(20'000, 1));
  TestClient slow(OwnChannel(server.address(), nullptr, SmallWindow()));
  std::vector<std::unique_ptr<WatchStream>> stalled;  // some MB each, which nobody reads
  for (int i = 0; i < 50; ++i) stalled.push_back(std::make_unique<WatchStream>(slow, name));
  server.Shutdown(std::chrono::milliseconds(500));
  for (const auto& reader : stalled) EXPECT_THAT(reader->End(), Not(IsOk()));
}

// ---- many ----

class Listener : public grpc::ClientReadReactor<WatchMessage> {
 public:
  Listener(RunningServer& server, const std::string& name, std::latch& begun, std::latch& done)
      : begun_(begun), done_(done) {
    request_.set_name(name);
    server.ensemble().async()->WatchEnsembleJob(&context_, &request_, this);
    StartRead(&message_);
    StartCall();
  }

  void OnReadDone(bool ok) override {
    if (!ok) return;
    if (messages_++ == 0) begun_.count_down();
    finished_ += message_.snapshot().finished_points_size();
    if (message_.has_job()) state_ = message_.job().state();
    StartRead(&message_);
  }
  void OnDone(const grpc::Status& status) override {
    status_ = status;
    done_.count_down();
  }

  const grpc::Status& status() const { return status_; }
  EnsembleJob::State state() const { return state_; }
  int finished() const { return finished_; }

 private:
  std::latch& begun_;
  std::latch& done_;
  grpc::ClientContext context_;
  v1::WatchEnsembleJobRequest request_;
  WatchMessage message_;
  int messages_ = 0;
  int finished_ = 0;
  EnsembleJob::State state_ = EnsembleJob::STATE_UNSPECIFIED;
  grpc::Status status_;
};

TEST_F(WatchTest, AThousandWatchersAllSeeTheEnd) {
  constexpr int kWatchers = 1000;
  RunningServer& server = Start(0);
  const std::string name = server.Submit(Equilibrium(50, 4));
  std::latch begun(kWatchers), done(kWatchers);
  std::vector<std::unique_ptr<Listener>> listeners;
  for (int i = 0; i < kWatchers; ++i) {
    listeners.push_back(std::make_unique<Listener>(server, name, begun, done));
  }
  begun.wait();
  gate_.Open();
  done.wait();
  for (const auto& listener : listeners) {
    EXPECT_OK(listener->status());
    EXPECT_EQ(listener->state(), EnsembleJob::SUCCEEDED);
    EXPECT_EQ(listener->finished(), 50);
  }
}

}  // namespace
}  // namespace ballpiston::server

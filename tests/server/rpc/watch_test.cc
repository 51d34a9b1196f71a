#include <chrono>
#include <condition_variable>
#include <latch>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/escaping.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
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

// Each permit lets one block be computed.
class Permits {
 public:
  void Give(int count) {
    std::lock_guard lock(mutex_);
    left_ += count;
    given_.notify_all();
  }
  void Take(std::stop_token stop) {
    std::unique_lock lock(mutex_);
    if (given_.wait(lock, stop, [this] { return left_ > 0; })) --left_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable_any given_;
  int left_ = 0;
};

bool HasPoints(const WatchMessage& message) { return message.snapshot().points_size() > 0; }

bool TellsFinished(const WatchMessage& message) {
  return message.snapshot().finished_points_size() > 0;
}

// The finished points that a watch and the watches that resume it have sent. The simulation
// (tests/simulation) compares such chains with the reference model.
class Chain {
 public:
  // Watches until a message meets the condition, or to the end. Later messages are lost.
  template <typename Condition>
  void Watch(RunningServer& server, const std::string& name, Condition is_enough) {
    WatchStream stream(server, name, token_);
    while (const auto message = stream.Next()) {
      EXPECT_FALSE(HasEnded(state_)) << "something came after the terminal state";
      token_ = message->resume_token();
      if (message->has_job()) state_ = message->job().state();
      EXPECT_LE(message->snapshot().finished_points_size(), 100);
      for (const auto& point : message->snapshot().finished_points()) {
        finished_.push_back(point.index());
      }
      if (is_enough(*message)) return stream.Leave();
    }
    EXPECT_OK(stream.reader->Finish());
  }
  void WatchToTheEnd(RunningServer& server, const std::string& name) {
    Watch(server, name, [](const WatchMessage&) { return false; });
  }

  const std::vector<int>& finished() const { return finished_; }
  const std::string& token() const { return token_; }
  EnsembleJob::State state() const { return state_; }  // the last one

 private:
  std::string token_;
  std::vector<int> finished_;
  EnsembleJob::State state_ = EnsembleJob::STATE_UNSPECIFIED;
};

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

  // A block for each permit. With one worker it is merged at once.
  RunningServer& StartWithPermits(int workers = 2) {
    return StartWith({.workers = workers,
                      .factory = FakeExperiments([this](size_t, uint64_t, std::stop_token stop) {
                        permits_.Take(stop);
                      })});
  }

  RunningServer& StartWith(TestServerOptions options) {
    server_.reset();  // first: one at a time
    options.data_dir = folder_.path();
    server_.emplace(options);
    return *server_;
  }

  Gate gate_;
  Permits permits_;
  TemporaryFolder folder_;
  std::optional<RunningServer> server_;
};

TEST_F(WatchTest, ResumesAfterTheLastPointThatWasRead) {
  constexpr int kWatches = 50;
  RunningServer& server = StartWithPermits();
  const std::string name = server.Submit(Equilibrium(2 * kWatches, 1));
  Chain chain;
  for (int i = 0; i < kWatches; ++i) {
    permits_.Give(2);
    const bool at_once = i % 3 == 0;
    chain.Watch(server, name,
                [&](const WatchMessage& message) { return at_once || TellsFinished(message); });
  }
  chain.WatchToTheEnd(server, name);
  EXPECT_EQ(chain.state(), EnsembleJob::SUCCEEDED);
  EXPECT_EQ(chain.finished().size(), 2u * kWatches);
  EXPECT_EQ(DistinctOf(chain.finished()), 2u * kWatches);
  Chain later;  // from the store
  later.WatchToTheEnd(server, name);
  EXPECT_EQ(later.finished(), chain.finished());
}

TEST_F(WatchTest, ResumesAfterARestartToo) {
  constexpr int kLives = 5;
  constexpr int kPointsOfALife = 150;  // more than are kept in memory
  const std::string name = StartWithPermits().Submit(Equilibrium(kLives * kPointsOfALife, 1));
  Chain chain;
  for (int life = 1; life < kLives; ++life) {
    permits_.Give(kPointsOfALife);
    chain.Watch(*server_, name, TellsFinished);
    permits_.Give(10);
    chain.Watch(*server_, name, TellsFinished);
    StartWithPermits();
  }
  permits_.Give(kLives * kPointsOfALife);
  chain.WatchToTheEnd(*server_, name);
  EXPECT_EQ(chain.state(), EnsembleJob::SUCCEEDED);
  EXPECT_EQ(chain.finished().size(), 1u * kLives * kPointsOfALife);
  EXPECT_EQ(DistinctOf(chain.finished()), 1u * kLives * kPointsOfALife);
}

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

TEST_F(WatchTest, WithTheLastTokenOnlyTheEndIsSent) {
  RunningServer& server = Start();
  const std::string name = server.Submit(Equilibrium(1, 5));
  Chain chain;
  chain.WatchToTheEnd(server, name);
  WatchStream stream(server, name, chain.token());
  const std::vector<WatchMessage> messages = stream.ToTheEnd();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].job().state(), EnsembleJob::SUCCEEDED);
  EXPECT_OK(stream.reader->Finish());
}

TEST_F(WatchTest, WithoutAValidTokenAllIsSent) {
  RunningServer& server = Start();
  const std::string name = server.Submit(Equilibrium(3, 1));
  const std::string other = server.Submit(Equilibrium(3, 1));
  Chain chain;
  chain.WatchToTheEnd(server, other);
  server.AwaitEnd(name);
  std::string text;
  ASSERT_TRUE(absl::WebSafeBase64Unescape(chain.token(), &text));
  std::vector<std::string> tokens = {chain.token(), "nonsense", "%", std::string(10'000, 'A')};
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
  RunningServer& server = Start();
  const std::string name = server.Submit(Equilibrium(3, 1));
  Chain chain;
  chain.WatchToTheEnd(server, name);
  EXPECT_EQ(chain.finished().size(), 3u);
  server_.reset();
  ChangeStore(folder_.File("store.sqlite3"),
              "UPDATE jobs SET state = 2, engine_version = '0.0.1'");  // RUNNING
  WatchStream stream(Start(), name, chain.token());
  std::set<int> told;
  for (const WatchMessage& message : stream.ToTheEnd()) {
    for (const auto& point : message.snapshot().finished_points()) told.insert(point.index());
  }
  EXPECT_EQ(told.size(), 3u);
}

TEST_F(WatchTest, AQuietJobHasAHeartbeat) {
  RunningServer& server = Start(0, std::chrono::milliseconds(20));
  WatchStream stream(server, server.Submit(Equilibrium(1, 100)));
  int beats = 0;
  stream.Until(
      [&](const WatchMessage& message) { return message.has_heartbeat() && ++beats == 3; });
  EXPECT_EQ(beats, 3);
}

TEST_F(WatchTest, WithATokenOnlyNewerStateIsSent) {
  RunningServer& server = Start(7, std::chrono::milliseconds(20));
  const std::string name = server.Submit(Equilibrium(1, 100));
  gate_.AwaitWaiting(2);  // seven blocks are done; the others wait
  std::string token;
  {
    WatchStream stream(server, name);
    // All seven blocks are sent; then there is nothing new.
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
  WatchStream unknown(server, name,
                      "b3RoZXI6MTox");  // of another server: all is sent
  unknown.Until(HasPoints);
}

TEST_F(WatchTest, ASlowReaderGetsEveryFinishedPoint) {
  RunningServer& server = Start();
  // Many points, far more than a stalled stream can hold.
  const std::string name = server.Submit(Equilibrium(20'000, 1));
  WatchStream slow(server, name);
  ASSERT_TRUE(slow.Next());
  EXPECT_EQ(server.AwaitEnd(name).progress().points_done(), 20'000);  // not held up
  std::vector<int> told;
  EnsembleJob last;
  while (const auto message = slow.Next()) {
    EXPECT_LT(message->ByteSizeLong(), 1u << 20);
    for (const auto& point : message->snapshot().finished_points()) told.push_back(point.index());
    last = message->job();
  }
  EXPECT_OK(slow.reader->Finish());
  EXPECT_EQ(told.size(), 20'000u);
  EXPECT_EQ(DistinctOf(told), 20'000u);
  EXPECT_EQ(last.state(), EnsembleJob::SUCCEEDED);
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

// ---- limits ----

TEST_F(WatchTest, APrincipalsStreamsAreLimited) {
  RunningServer& server =
      StartWith({.factory = GatedExperiments(gate_), .limits = {.max_streams_per_principal = 2}});
  const std::string name = server.Submit(Equilibrium(1, 5));
  auto first = std::make_unique<WatchStream>(server, name);
  WatchStream second(server, name);
  ASSERT_TRUE(first->Next());
  ASSERT_TRUE(second.Next());
  WatchStream third(server, name);
  EXPECT_FALSE(third.Next());
  const grpc::Status refused = third.reader->Finish();
  EXPECT_THAT(refused, IsError(grpc::StatusCode::RESOURCE_EXHAUSTED, "TOO_MANY_STREAMS"));
  EXPECT_THAT(refused.error_message(),
              testing::HasSubstr("permits 2 (--max-streams-per-principal)"));
  first->context.TryCancel();
  first.reset();
  // Then the server knows that the watch has ended.
  AwaitThat([&] { return WatchStream(server, name).Next().has_value(); });
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
  RunningServer& server = StartWithPermits();
  const std::string name = server.Submit(Equilibrium(50, 4));
  std::latch begun(kWatchers), done(kWatchers);
  std::vector<std::unique_ptr<Listener>> listeners;
  for (int i = 0; i < kWatchers; ++i) {
    listeners.push_back(std::make_unique<Listener>(server, name, begun, done));
  }
  begun.wait();
  permits_.Give(200);
  done.wait();
  for (const auto& listener : listeners) {
    EXPECT_OK(listener->status());
    EXPECT_EQ(listener->state(), EnsembleJob::SUCCEEDED);
    EXPECT_EQ(listener->finished(), 50);
  }
}

}  // namespace
}  // namespace ballpiston::server

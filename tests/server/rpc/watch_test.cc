
#include "server/rpc/request_check.h"
#include "tests/server/preamble.h"
#include "tests/server/rpc/message_stream.h"

namespace ballpiston::server {
namespace {

bool HasPoints(const WatchMessage& message) { return message.snapshot().points_size() > 0; }

// The finished points in the messages, in their order.
std::vector<int> FinishedIn(const std::vector<WatchMessage>& messages) {
  std::vector<int> points;
  for (const WatchMessage& message : messages) {
    EXPECT_LE(message.snapshot().finished_points_size(), 100);
    for (const auto& point : message.snapshot().finished_points()) points.push_back(point.index());
  }
  return points;
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

TEST_F(WatchTest, WithoutAValidTokenAllIsSent) {
  RunningServer& server = Start();
  const std::string name = server.Succeeded(Equilibrium(3, 1));
  const auto sent = [&](const std::string& token) {
    return FinishedIn(WatchStream(server, name, token).ToTheEnd()).size();
  };
  storage::ResumeToken valid =
      *ParseToken<storage::ResumeToken>(WatchStream(server, name).ToTheEnd().back().resume_token());
  valid.set_finished(1);
  ASSERT_EQ(sent(TokenText(valid)), 2u);

  std::vector<storage::ResumeToken> invalid(5, valid);
  invalid[0].set_job("another");
  invalid[1].set_restarts(1);
  invalid[2].set_restarts(-1);
  invalid[3].set_finished(4);  // the job has three points
  invalid[4].set_finished(-1);
  for (const storage::ResumeToken& token : invalid) {
    EXPECT_EQ(sent(TokenText(token)), 3u) << token.ShortDebugString();
  }
  for (const std::string& text : {std::string("nonsense"), std::string("%"),
                                  std::string(10'000, 'A'), TokenText(valid).substr(1)}) {
    EXPECT_EQ(sent(text), 3u) << text;
  }
}

// Also if this engine computed the job at first, and another engine later.
TEST_F(WatchTest, AfterARestartForAnotherEngineAllIsSentAgain) {
  const std::string name = Start().Succeeded(Equilibrium(3, 1));
  const std::string token = WatchStream(*server_, name).ToTheEnd().back().resume_token();
  server_.reset();
  ChangeJobs(folder_.File("store.sqlite3"), [](EnsembleJob& job) {
    job.set_state(EnsembleJob::RUNNING);
    job.set_engine_version("0.0.1");
  });
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

}  // namespace
}  // namespace ballpiston::server

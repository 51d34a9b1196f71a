#include <limits>
#include <optional>
#include <set>
#include <thread>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/running_server.h"
#include "tests/server/temporary_folder.h"

namespace ballpiston::server {
namespace {

using v1::EnsembleJob;
using Message = v1::WatchEnsembleJobResponse;

class WatchTest : public testing::Test {
 protected:
  ~WatchTest() override { gate_.Open(); }

  RunningServer& Start(uint64_t held_from = std::numeric_limits<uint64_t>::max(),
                       std::chrono::milliseconds heartbeat = std::chrono::seconds(10)) {
    ServerOptions options;
    options.data_dir = folder_.File("data");
    options.workers = 2;
    options.factory =
        FakeExperiments([this, held_from](size_t, uint64_t block, std::stop_token stop) {
          if (block >= held_from) gate_.Pass(stop);
        });
    options.watch = {std::chrono::milliseconds(2), heartbeat};
    server_.emplace(options);
    return *server_;
  }

  struct Stream {
    Stream(RunningServer& server, const std::string& name, const std::string& token = "") {
      v1::WatchEnsembleJobRequest request;
      request.set_name(name);
      request.set_resume_token(token);
      reader = server.ensemble().WatchEnsembleJob(&context, request);
    }
    std::optional<Message> Next() {
      Message message;
      if (!reader->Read(&message)) return std::nullopt;
      return message;
    }
    // Reads on until a message is like that.
    template <typename Condition>
    Message Until(Condition condition) {
      while (auto message = Next()) {
        if (condition(*message)) return *message;
      }
      ADD_FAILURE() << "the stream ended: " << reader->Finish().error_message();
      return {};
    }
    std::vector<Message> ToTheEnd() {
      std::vector<Message> messages;
      while (auto message = Next()) messages.push_back(*message);
      return messages;
    }

    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReader<Message>> reader;
  };

  static bool HasPoints(const Message& message) { return message.snapshot().points_size() > 0; }

  Gate gate_;
  TemporaryFolder folder_;
  std::optional<RunningServer> server_;
};

TEST_F(WatchTest, FirstTheJobThenSnapshotsThenItsEndAndOk) {
  RunningServer& server = Start(30);
  const std::string name = server.Submit(Equilibrium(2, 100));
  Stream stream(server, name);
  const Message first = *stream.Next();
  ASSERT_TRUE(first.has_job());
  EXPECT_EQ(first.job().name(), name);
  const Message snapshot = stream.Until(HasPoints);
  EXPECT_GT(snapshot.snapshot().progress().samples(), 0);
  EXPECT_EQ(snapshot.snapshot().points(0).estimates(0).name(), "mean");
  gate_.Open();
  const std::vector<Message> rest = stream.ToTheEnd();
  EXPECT_TRUE(stream.reader->Finish().ok());
  ASSERT_FALSE(rest.empty());
  EXPECT_EQ(rest.back().job().state(), EnsembleJob::SUCCEEDED);
  for (const Message& message : rest) EXPECT_FALSE(message.resume_token().empty());
}

TEST_F(WatchTest, EveryChangeOfStateIsTold) {
  RunningServer& server = Start(3);
  const std::string name = server.Submit(Equilibrium(1, 100));
  Stream stream(server, name);
  stream.Until(
      [](const Message& message) { return message.job().state() == EnsembleJob::RUNNING; });
  ASSERT_TRUE(server.Cancel(name).ok());
  const std::vector<Message> rest = stream.ToTheEnd();
  ASSERT_FALSE(rest.empty());
  EXPECT_EQ(rest.back().job().state(), EnsembleJob::CANCELLED);
  EXPECT_TRUE(stream.reader->Finish().ok());
}

TEST_F(WatchTest, AnEndedJobIsToldAtOnce) {
  RunningServer& server = Start();
  const std::string name = server.Submit(Equilibrium(1, 5));
  server.AwaitEnd(name);
  Stream stream(server, name);
  const std::vector<Message> messages = stream.ToTheEnd();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].job().state(), EnsembleJob::SUCCEEDED);
  EXPECT_TRUE(stream.reader->Finish().ok());
}

TEST_F(WatchTest, AQuietJobHasAHeartbeat) {
  RunningServer& server = Start(0, std::chrono::milliseconds(20));
  Stream stream(server, server.Submit(Equilibrium(1, 100)));
  int beats = 0;
  stream.Until([&](const Message& message) { return message.has_heartbeat() && ++beats == 3; });
}

TEST_F(WatchTest, WithATokenOnlyWhatIsNewIsTold) {
  RunningServer& server = Start(7, std::chrono::milliseconds(20));
  const std::string name = server.Submit(Equilibrium(1, 100));
  std::string token;
  {
    Stream stream(server, name);
    // All seven blocks are told, then nothing is new.
    token = stream
                .Until([](const Message& message) {
                  return HasPoints(message) &&
                         message.snapshot().points(0).samples() == 7 * kFakeSamplesPerBlock;
                })
                .resume_token();
    stream.context.TryCancel();
  }
  Stream again(server, name, token);
  EXPECT_TRUE(again.Next()->has_job());
  again.Until([](const Message& message) {
    EXPECT_FALSE(HasPoints(message));
    return message.has_heartbeat();
  });
  Stream unknown(server, name, "b3RoZXI6MTox");  // another server's: everything
  unknown.Until(HasPoints);
}

TEST_F(WatchTest, ASlowReaderMissesSnapshotsAndNeverTheNewest) {
  RunningServer& server = Start();
  // Points enough that all their snapshots would be far more than a stalled stream takes in.
  const std::string name = server.Submit(Equilibrium(20'000, 1));
  Stream slow(server, name);
  ASSERT_TRUE(slow.Next());
  server.AwaitEnd(name);  // another watcher, not held up
  const std::vector<Message> rest = slow.ToTheEnd();
  EXPECT_TRUE(slow.reader->Finish().ok());
  std::set<int> told;
  for (const Message& message : rest) {
    EXPECT_LE(message.snapshot().points_size(), 100);
    for (const auto& point : message.snapshot().points()) told.insert(point.index());
  }
  EXPECT_EQ(rest.back().job().state(), EnsembleJob::SUCCEEDED);
  EXPECT_EQ(rest.back().job().progress().points_done(), 20'000);
  EXPECT_LT(told.size(), 20'000u);
}

TEST_F(WatchTest, DroppingAWatchLeavesTheJobAlone) {
  RunningServer& server = Start(5);
  const std::string name = server.Submit(Equilibrium(1, 50));
  {
    Stream stream(server, name);
    ASSERT_TRUE(stream.Next());
    stream.context.TryCancel();
    stream.reader->Finish();
  }
  gate_.Open();
  EXPECT_EQ(server.AwaitEnd(name).state(), EnsembleJob::SUCCEEDED);
}

TEST_F(WatchTest, AStoppingServerEndsWatchesWithUnavailable) {
  RunningServer& server = Start(5);
  const std::string name = server.Submit(Equilibrium(1, 50));
  Stream stream(server, name);
  ASSERT_TRUE(stream.Next());
  std::thread stop([&] { server.server().Shutdown(std::chrono::seconds(10)); });
  stream.ToTheEnd();
  const grpc::Status status = stream.reader->Finish();
  stop.join();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(DetailsOf(status).reason, "SHUTTING_DOWN");
}

TEST_F(WatchTest, AReaderThatHasStalledDoesNotHoldUpAStop) {
  RunningServer& server = Start(std::numeric_limits<uint64_t>::max());
  v1::EnsembleSpec large = Equilibrium(0, 1);
  for (int i = 0; i < 90'000; ++i) large.mutable_grid()->add_delta(0.1 + 1e-7 * i);
  const std::string name = server.Submit(large);
  std::vector<std::unique_ptr<Stream>> stalled;  // nobody reads 720 kB each
  for (int i = 0; i < 20; ++i) stalled.push_back(std::make_unique<Stream>(server, name));
  const auto start = std::chrono::steady_clock::now();
  server.server().Shutdown(std::chrono::milliseconds(300));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

}  // namespace
}  // namespace ballpiston::server

#include "server/api/rpc_executor.h"

#include <atomic>
#include <future>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/fake_experiments.h"

namespace ballpiston::server {
namespace {

constexpr int kThreads = 4;  // for calls that read; the same number for calls that write
constexpr int kStreamThreads = kThreads / 2;

class RpcExecutorTest : public testing::Test {
 protected:
  ~RpcExecutorTest() override { gate_.Open(); }

  RpcExecutor::Task Stuck() {
    return [this] { gate_.Pass(std::stop_token()); };
  }

  // Posts one more task with `post`, and returns when it has run.
  template <typename Post>
  void AwaitAnother(Post post) {
    std::promise<void> run;
    post([&run] { run.set_value(); });
    run.get_future().wait();
  }

  Gate gate_;
  RpcExecutor executor_{kThreads};
};

TEST_F(RpcExecutorTest, CallsDoNotWaitForStreams) {
  for (const char* principal : {"ann", "bob"}) {
    for (int i = 0; i < 10 * kThreads; ++i) executor_.PostOfStream(principal, Stuck());
  }
  gate_.AwaitWaiting(kStreamThreads);
  AwaitAnother([this](RpcExecutor::Task task) { executor_.Post("ann", std::move(task)); });
  EXPECT_EQ(gate_.waiting(), kStreamThreads);
}

TEST_F(RpcExecutorTest, StreamsDoNotWaitForCalls) {
  for (const char* principal : {"ann", "bob"}) {
    for (int i = 0; i < 10 * kThreads; ++i) executor_.Post(principal, Stuck());
  }
  gate_.AwaitWaiting(kThreads);
  AwaitAnother([this](RpcExecutor::Task task) { executor_.PostOfStream("ann", std::move(task)); });
  EXPECT_EQ(gate_.waiting(), kThreads);
}

// A disk that hangs holds up all calls that write.
TEST_F(RpcExecutorTest, CallsThatReadDoNotWaitForThoseThatWrite) {
  for (int i = 0; i < 10 * kThreads; ++i) executor_.PostOfWrite("ann", Stuck());
  gate_.AwaitWaiting(kThreads);
  AwaitAnother([this](RpcExecutor::Task task) { executor_.Post("ann", std::move(task)); });
  EXPECT_EQ(gate_.waiting(), kThreads);
}

TEST_F(RpcExecutorTest, ReadsOfAPrincipalUseAtMostHalfOfTheThreads) {
  for (int i = 0; i < 10 * kThreads; ++i) executor_.Post("ann", Stuck());
  gate_.AwaitWaiting(kThreads / 2);
  AwaitAnother([this](RpcExecutor::Task task) { executor_.Post("bob", std::move(task)); });
  EXPECT_EQ(gate_.waiting(), kThreads / 2);
}

TEST_F(RpcExecutorTest, PrincipalsTakeTurnsAndEachKeepsItsOrder) {
  RpcExecutor executor(1);
  std::vector<std::string> begun;
  executor.Post("ann", Stuck());
  gate_.AwaitWaiting(1);
  for (int i = 0; i < 5; ++i) {
    executor.Post("ann", [&begun, i] { begun.push_back("ann" + std::to_string(i)); });
  }
  for (const char* principal : {"bob", "eve", "bob"}) {
    executor.Post(principal, [&begun, principal] { begun.push_back(principal); });
  }
  gate_.Open();
  executor.Stop();
  EXPECT_THAT(begun,
              testing::ElementsAre("ann0", "bob", "eve", "ann1", "bob", "ann2", "ann3", "ann4"));
}

TEST_F(RpcExecutorTest, PostedTasksAreRunBeforeTheStop) {
  std::atomic<int> run = 0;
  const auto post_three = [&] {
    executor_.Post("ann", [&] { ++run; });
    executor_.PostOfWrite("ann", [&] { ++run; });
    executor_.PostOfStream("ann", [&] { ++run; });
  };
  for (int i = 0; i < 100; ++i) post_three();
  executor_.Stop();
  EXPECT_EQ(run, 300);
  post_three();
  EXPECT_EQ(run, 300);
}

}  // namespace
}  // namespace ballpiston::server

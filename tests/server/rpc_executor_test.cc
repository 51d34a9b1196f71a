#include "server/api/rpc_executor.h"

#include <atomic>
#include <future>
#include <stop_token>

#include "gtest/gtest.h"
#include "tests/server/fake_experiments.h"

namespace ballpiston::server {
namespace {

constexpr int kThreads = 4;  // for calls

class RpcExecutorTest : public testing::Test {
 protected:
  ~RpcExecutorTest() override { gate_.Open(); }

  RpcExecutor::Task Stuck() {
    return [this] { gate_.Pass(std::stop_token()); };
  }

  Gate gate_;
  RpcExecutor executor_{kThreads};
};

TEST_F(RpcExecutorTest, StreamsDoNotKeepCallsWaiting) {
  for (int i = 0; i < 10 * kThreads; ++i) executor_.PostOfStream(Stuck());
  gate_.AwaitWaiting(kThreads / 2);
  std::promise<void> answered;
  executor_.Post([&] { answered.set_value(); });
  answered.get_future().get();
}

TEST_F(RpcExecutorTest, NorCallsStreams) {
  for (int i = 0; i < 10 * kThreads; ++i) executor_.Post(Stuck());
  gate_.AwaitWaiting(kThreads);
  std::promise<void> told;
  executor_.PostOfStream([&] { told.set_value(); });
  told.get_future().get();
}

TEST_F(RpcExecutorTest, WhatWasPostedIsRunBeforeTheStop) {
  std::atomic<int> run = 0;
  for (int i = 0; i < 100; ++i) {
    executor_.Post([&] { ++run; });
    executor_.PostOfStream([&] { ++run; });
  }
  executor_.Stop();
  EXPECT_EQ(run, 200);
  executor_.Post([&] { ++run; });
  executor_.PostOfStream([&] { ++run; });
  EXPECT_EQ(run, 200);
}

}  // namespace
}  // namespace ballpiston::server

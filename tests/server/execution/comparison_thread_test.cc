// Whose comparison is next. What a comparison tells is in method_service_test.cc.
#include "server/execution/comparison_thread.h"

#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/server/fake_experiments.h"

namespace ballpiston::server {
namespace {

using ::testing::ElementsAre;
using Admission = ComparisonThread::Admission;

class ComparisonThreadTest : public testing::Test {
 protected:
  ~ComparisonThreadTest() override { gate_.Open(); }

  Admission Begin(const std::string& principal, const std::stop_source& stop = {}) {
    return thread_.Begin({.principal = principal,
                          .spec = {},
                          .stop = stop,
                          .tell = [](const MethodMeasurement&) {},
                          .ended =
                              [this, principal](const absl::Status& status) {
                                std::lock_guard lock(mutex_);
                                ended_.push_back(principal + (status.ok() ? "" : " stopped"));
                              }});
  }

  std::vector<std::string> Ended() {
    std::lock_guard lock(mutex_);
    return ended_;
  }

  std::mutex mutex_;
  std::vector<std::string> ended_;
  Gate gate_;
  ComparisonThread thread_{[this](const auto&, const std::stop_token& stop, const auto&) {
    gate_.Pass(stop);
    return stop.stop_requested() ? absl::CancelledError("stopped") : absl::OkStatus();
  }};
};

TEST_F(ComparisonThreadTest, AnotherPrincipalsComparisonWaitsInTurn) {
  EXPECT_EQ(Begin("ann"), Admission::kBegun);
  gate_.AwaitWaiting(1);
  EXPECT_EQ(Begin("bob"), Admission::kBegun);
  EXPECT_EQ(Begin("eve"), Admission::kBegun);
  EXPECT_EQ(Begin("ann"), Admission::kBusy);
  EXPECT_EQ(Begin("bob"), Admission::kBusy);
  EXPECT_THAT(Ended(), ElementsAre());
  gate_.Open();
  while (Ended().size() < 3) std::this_thread::yield();
  EXPECT_THAT(Ended(), ElementsAre("ann", "bob", "eve"));
}

TEST_F(ComparisonThreadTest, AComparisonStoppedWhileWaitingFreesItsPlace) {
  Begin("ann");
  gate_.AwaitWaiting(1);
  std::stop_source stop;
  EXPECT_EQ(Begin("bob", stop), Admission::kBegun);
  stop.request_stop();
  EXPECT_EQ(Begin("bob"), Admission::kBegun);
  EXPECT_THAT(Ended(), ElementsAre("bob stopped"));
}

TEST_F(ComparisonThreadTest, AStopEndsWaitingComparisonsToo) {
  for (const char* principal : {"ann", "bob", "eve"}) Begin(principal);
  thread_.Stop();
  EXPECT_THAT(Ended(), ElementsAre("ann stopped", "bob stopped", "eve stopped"));
  EXPECT_EQ(Begin("ann"), Admission::kStopped);
}

}  // namespace
}  // namespace ballpiston::server

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "gtest/gtest.h"
#include "server/observability/health.h"
#include "tests/support/await.h"

namespace ballpiston::server {
namespace {

// Records the states. Like gRPC's own, it ignores SERVING after Shutdown.
class FakeHealth : public grpc::HealthCheckServiceInterface {
 public:
  void SetServingStatus(const std::string& name, bool serving) override {
    std::lock_guard lock(mutex_);
    serving_[name] = serving && !shut_down_;
    changed_.notify_all();
  }
  void SetServingStatus(bool) override { ADD_FAILURE() << "each service has a state of its own"; }
  void Shutdown() override {
    std::lock_guard lock(mutex_);
    shut_down_ = true;
    for (auto& [name, serving] : serving_) serving = false;
  }

  bool IsServing(const std::string& name) {
    std::lock_guard lock(mutex_);
    return serving_.at(name);
  }
  void Await(const std::string& name, bool serving) {
    std::unique_lock lock(mutex_);
    AwaitNotified(changed_, lock, [&] { return serving_.at(name) == serving; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, bool> serving_ = {{"", true}};
  bool shut_down_ = false;
};

class HealthStates : public testing::Test {
 protected:
  FakeHealth answers_;
  std::atomic<bool> store_fails_ = false;
  Health health_{answers_,
                 {.all = {"jobs", "formulas"}, .with_store = {"jobs"}},
                 [this] { return store_fails_.load(); },
                 std::chrono::milliseconds(1)};
};

TEST_F(HealthStates, EachServiceServesByItsNameFromTheStart) {
  EXPECT_TRUE(answers_.IsServing("jobs"));
  EXPECT_TRUE(answers_.IsServing("formulas"));
}

TEST_F(HealthStates, OnlyServicesThatNeedTheStoreStopServingWhileItFails) {
  store_fails_ = true;
  answers_.Await("jobs", false);
  EXPECT_TRUE(answers_.IsServing("formulas"));
  EXPECT_TRUE(answers_.IsServing(""));
  store_fails_ = false;
  answers_.Await("jobs", true);
}

TEST_F(HealthStates, AStoppingServerServesNothing) {
  store_fails_ = true;
  answers_.Await("jobs", false);
  health_.Drain();
  store_fails_ = false;
  for (const char* name : {"", "jobs", "formulas"}) EXPECT_FALSE(answers_.IsServing(name));
}

}  // namespace
}  // namespace ballpiston::server

// Watches that are cut, while the server is stopped and killed.
#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/library/client.h"
#include "tests/fault/torture/connected_server.h"
#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/questions.h"
#include "tests/fault/torture/sizes.h"
#include "tests/fault/torture/watch_chain.h"
#include "tests/support/await.h"

namespace ballpiston::torture {
namespace {

constexpr int kChains = 24;
constexpr int kClientWatches = 4;
constexpr int kMostMessages = 4;

// The job that is watched now. When it has ended, a new job replaces it.
class WatchedJob {
 public:
  explicit WatchedJob(ConnectedServer& server) : client_(server.NewClient()) { Next(""); }

  std::string Now() {
    const std::lock_guard lock(mutex_);
    return name_;
  }

  // The first thread that sees the end of `ended` creates the next job.
  void Next(const std::string& ended) {
    const std::lock_guard lock(mutex_);
    if (name_ != ended) return;
    v1::EnsembleSpec spec = ManyPoints(60, 20'000);
    spec.set_seed(seed_++);
    while (true) {
      const auto job = client_.Create(spec);
      if (job.ok()) name_ = job->name();
      if (job.ok() || !absl::IsUnavailable(job.status())) return;
      std::this_thread::sleep_for(kPauseBeforeRepeating);
    }
  }

 private:
  const client::Client client_;
  std::mutex mutex_;
  uint64_t seed_ = 0;
  std::string name_;
};

class Watches : public testing::Test {
 protected:
  void CutAgainAndAgain(uint64_t seed) {
    const auto stub = v1::EnsembleService::NewStub(server_.Connect());
    std::mt19937_64 random(seed);
    while (!enough_) {
      WatchChain chain(watched_->Now(), life_, findings_);
      while (!chain.ended()) {
        const int messages = std::uniform_int_distribution<int>(1, kMostMessages)(random);
        if (!chain.Attach(*stub, messages)) std::this_thread::sleep_for(kPauseBeforeRepeating);
      }
      chain.CheckFinishedPoints(*stub);
      watched_->Next(chain.job());
    }
  }

  // For the client library a restart is a pause.
  void FollowToTheEnd() {
    const client::Client client = server_.NewClient();
    while (!enough_) {
      const std::string name = watched_->Now();
      int ends = 0;
      client::WatchCallbacks callbacks;
      callbacks.on_job = [&](const v1::EnsembleJob& job) {
        ends += client::HasEnded(job.state()) ? 1 : 0;
      };
      callbacks.on_disconnect = [&](const absl::Status&, absl::Duration) {
        findings_.Count("pauses in client library's watches");
      };
      client::WatchOptions options;
      options.max_backoff = absl::Milliseconds(500);
      options.give_up_after = absl::FromChrono(kPatience);
      const auto ended = client.Watch(name, callbacks, options);
      findings_.Count("client library's watches to the end");
      if (!ended.ok()) findings_.Wrong(absl::StrCat("WatchJob: ", ended.status().ToString()));
      if (ends != 1) findings_.Wrong(absl::StrCat("WatchJob told ", ends, " terminal states"));
      watched_->Next(name);
    }
  }

  // kill -9 and SIGTERM in turn, until there were enough restarts and cuts.
  void Restart(int restarts, int cuts) {
    std::mt19937_64 random(4);
    for (int i = 0; i < restarts || findings_.count("watches cut") < cuts; ++i) {
      const int life = std::uniform_int_distribution<int>(0, HoldsToTimes() ? 1'500 : 300)(random);
      std::this_thread::sleep_for(std::chrono::milliseconds(life));
      server_.Signal(i % 2 == 0 ? SIGKILL : SIGTERM);
      const int code = server_.AwaitEnd();
      if (code != (i % 2 == 0 ? 128 + SIGKILL : 0)) {
        findings_.Wrong(absl::StrCat("ended with ", code, ": ", server_.log()));
      }
      ++life_;
      server_.Start();
      findings_.Count("restarts");
    }
  }

  Findings findings_{"cut watches"};
  ConnectedServer server_;
  std::atomic<int> life_ = 0;
  std::atomic<bool> enough_ = false;
  std::unique_ptr<WatchedJob> watched_;
};

TEST_F(Watches, SendEverythingOnceThroughCutsAndRestarts) {
  server_.Start();
  watched_ = std::make_unique<WatchedJob>(server_);
  std::vector<std::thread> threads;
  for (uint64_t i = 0; i < kChains; ++i) threads.emplace_back([this, i] { CutAgainAndAgain(i); });
  for (int i = 0; i < kClientWatches; ++i) threads.emplace_back([this] { FollowToTheEnd(); });
  Restart(Size(4, 100), Size(200, 10'000));
  enough_ = true;
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(findings_.Report(), "");
  EXPECT_GT(findings_.count("chains heard to the end"), 0);
  EXPECT_GE(findings_.count("watches that begin with points of an ended job"), Size(0, 1));
}

}  // namespace
}  // namespace ballpiston::torture

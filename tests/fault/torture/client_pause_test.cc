// For the client library a restart of the server is a short pause of a watch.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "absl/strings/str_format.h"
#include "client/library/channel.h"
#include "client/library/client.h"
#include "tests/fault/torture/connected_server.h"
#include "tests/fault/torture/findings.h"
#include "tests/fault/torture/questions.h"
#include "tests/fault/torture/sizes.h"
#include "tests/support/await.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::torture {
namespace {

using Clock = std::chrono::steady_clock;

// The longest pause between two attempts of the test's watch.
constexpr absl::Duration kMostBackoff = absl::Milliseconds(500);
// The longest time from a ready server to the watch's first message, without that pause.
constexpr double kMostSecondsToHear = 1;

// Counts the watch's reports of the job: one at first, and one after each restart.
class Told {
 public:
  void Add() {
    const std::lock_guard lock(mutex_);
    ++count_;
    news_.notify_all();
  }
  void End() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    news_.notify_all();
  }
  // False if the watch has ended.
  bool Await(int count) {
    std::unique_lock lock(mutex_);
    AwaitNotified(news_, lock, [&] { return ended_ || count_ >= count; });
    return count_ >= count;
  }
  int Count() {
    const std::lock_guard lock(mutex_);
    return count_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable news_;
  int count_ = 0;
  bool ended_ = false;
};

TEST(ClientLibrary, WatchesAgainSoonAfterARestart) {
  Findings findings("client's pause");
  ConnectedServer server;
  server.Start();
  // The library's own channel: nothing else in this process hurries it.
  ASSERT_OK_AND_ASSIGN(const auto channel, client::OpenChannel(server.address()));
  const client::Client client(channel, absl::FromChrono(kPatience));
  ASSERT_OK_AND_ASSIGN(const v1::EnsembleJob job, client.Create(Endless()));
  Told told;
  client::WatchCallbacks callbacks;
  callbacks.on_job = [&](const v1::EnsembleJob&) { told.Add(); };
  client::WatchOptions options;
  options.max_backoff = kMostBackoff;
  options.give_up_after = absl::FromChrono(kPatience);
  absl::StatusOr<v1::EnsembleJob> ended;
  std::thread watch([&] {
    ended = client.Watch(job.name(), callbacks, options);
    told.End();
  });
  told.Await(1);
  double longest = 0;
  for (int i = 0; i < Size(2, 20); ++i) {
    const int before = told.Count();
    server.Signal(i % 2 == 0 ? SIGKILL : SIGTERM);
    server.AwaitEnd();
    server.Start();
    const auto ready = Clock::now();
    EXPECT_TRUE(told.Await(before + 1)) << "the watch has ended";
    if (testing::Test::HasFailure()) break;
    longest = std::max(longest, std::chrono::duration<double>(Clock::now() - ready).count());
    findings.Count("restarts");
  }
  findings.Note("longest, seconds from ready to heard", absl::StrFormat("%.2f", longest));
  EXPECT_OK(client.Cancel(job.name()));
  watch.join();
  EXPECT_OK(ended);
  if (HoldsToTimes()) {
    EXPECT_LT(longest, absl::ToDoubleSeconds(kMostBackoff) + kMostSecondsToHear);
  }
}

}  // namespace
}  // namespace ballpiston::torture

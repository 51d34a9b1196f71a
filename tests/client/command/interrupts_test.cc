#include "client/command/interrupts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

namespace ballpiston::client {
namespace {

using ::testing::ElementsAre;

// If one thread does not block SIGINT, the signal ends the program. The mask is set before main, so
// that all threads inherit it, those of the time limit and of gRPC too. The client constructs
// Interrupts before it starts a thread.
[[maybe_unused]] const bool kSigintIsBlocked = [] {
  sigset_t sigint;
  sigemptyset(&sigint);
  sigaddset(&sigint, SIGINT);
  return pthread_sigmask(SIG_BLOCK, &sigint, nullptr) == 0;
}();

void PressCtrlC() { kill(getpid(), SIGINT); }

// Records the calls of the reactions, in order.
class Events {
 public:
  InterruptReactions Of(const std::string& scope) {
    return {.on_first = [this, scope] { Add(scope + ": first"); },
            .on_second = [this, scope] { Add(scope + ": second"); },
            .on_no_second = [this, scope] { Add(scope + ": no second"); }};
  }

  // Waits until there are `count` events, and returns all.
  std::vector<std::string> Await(size_t count) {
    std::unique_lock lock(mutex_);
    news_.wait(lock, [&] { return events_.size() >= count; });
    return events_;
  }

 private:
  void Add(const std::string& event) {
    const std::lock_guard lock(mutex_);
    events_.push_back(event);
    news_.notify_one();
  }

  std::mutex mutex_;
  std::condition_variable news_;
  std::vector<std::string> events_;
};

TEST(Interrupts, PressesAreFirstAndSecondInTurn) {
  Interrupts interrupts(absl::Minutes(5));
  Events events;
  const Interrupts::Scope scope(interrupts, events.Of("job"));
  for (size_t presses = 1; presses <= 3; ++presses) {
    PressCtrlC();
    events.Await(presses);
  }
  EXPECT_THAT(events.Await(3), ElementsAre("job: first", "job: second", "job: first"));
}

TEST(Interrupts, AfterATimeoutTheNextPressIsAFirstPress) {
  Interrupts interrupts(absl::Milliseconds(10));
  Events events;
  const Interrupts::Scope scope(interrupts, events.Of("job"));
  for (size_t presses = 1; presses <= 2; ++presses) {
    PressCtrlC();
    events.Await(2 * presses);
  }
  EXPECT_THAT(events.Await(4),
              ElementsAre("job: first", "job: no second", "job: first", "job: no second"));
}

// A first press for one job does not count for the next job.
TEST(Interrupts, TheEndOfAScopeForgetsTheFirstPress) {
  Interrupts interrupts(absl::Minutes(5));
  Events events;
  for (const char* job : {"a", "b"}) {
    const Interrupts::Scope scope(interrupts, events.Of(job));
    PressCtrlC();
    events.Await(job[0] == 'a' ? 1 : 2);
  }
  EXPECT_THAT(events.Await(2), ElementsAre("a: first", "b: first"));
}

TEST(InterruptsDeathTest, OutsideOfScopesAPressEndsTheProgram) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        Interrupts interrupts;
        { const Interrupts::Scope ended(interrupts, {}); }
        PressCtrlC();
        pause();
      },
      ::testing::ExitedWithCode(130), "");
}

TEST(Interrupts, LeavesTheSignalMaskAsItWas) {
  sigset_t sigint, mask;
  sigemptyset(&sigint);
  sigaddset(&sigint, SIGINT);
  pthread_sigmask(SIG_UNBLOCK, &sigint, &mask);
  { const Interrupts interrupts; }
  sigset_t after;
  pthread_sigmask(SIG_SETMASK, &mask, &after);
  EXPECT_FALSE(sigismember(&after, SIGINT));
}

}  // namespace
}  // namespace ballpiston::client

#include "client/command/interrupts.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <future>

namespace ballpiston::client {
namespace {

// gRPC's threads of other tests in this program inherit the mask; one that did not block SIGINT
// would be killed by it. In the client itself Interrupts comes before them.
class BlockSigint : public ::testing::Environment {
 public:
  void SetUp() override {
    sigset_t sigint;
    sigemptyset(&sigint);
    sigaddset(&sigint, SIGINT);
    pthread_sigmask(SIG_BLOCK, &sigint, nullptr);
  }
};
[[maybe_unused]] const auto* const kBlockSigint =
    ::testing::AddGlobalTestEnvironment(new BlockSigint);

void PressCtrlC() { kill(getpid(), SIGINT); }

struct Reactions {
  std::promise<void> first, second, none;

  InterruptReactions Get() {
    return {.on_first = [this] { first.set_value(); },
            .on_second = [this] { second.set_value(); },
            .on_no_second = [this] { none.set_value(); }};
  }
};

TEST(Interrupts, ASecondPressInTimeIsASecondPress) {
  Interrupts interrupts(absl::Minutes(5));
  Reactions reactions;
  const Interrupts::Scope scope(interrupts, reactions.Get());
  PressCtrlC();
  reactions.first.get_future().wait();
  PressCtrlC();
  reactions.second.get_future().wait();
}

TEST(Interrupts, WithoutASecondPressTheTimeRunsOut) {
  Interrupts interrupts(absl::Milliseconds(10));
  Reactions reactions;
  const Interrupts::Scope scope(interrupts, reactions.Get());
  PressCtrlC();
  reactions.first.get_future().wait();
  reactions.none.get_future().wait();
}

// A press that was meant for one job says nothing about the next.
TEST(Interrupts, TheEndOfAScopeForgetsTheFirstPress) {
  Interrupts interrupts(absl::Minutes(5));
  Reactions reactions[2];
  for (Reactions& each : reactions) {
    const Interrupts::Scope scope(interrupts, each.Get());
    PressCtrlC();
    each.first.get_future().wait();
  }
}

TEST(InterruptsDeathTest, WithoutReactionsTheProgramEnds) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        Interrupts interrupts;
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

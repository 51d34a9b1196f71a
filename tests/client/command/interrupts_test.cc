// tests/end_to_end/interrupt_test.cc sends each of the signals to the whole program.
#include "client/command/interrupts.h"

#include <latch>

#include "client/output/new_file.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

sigset_t Signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
  return signals;
}

// If one thread does not block a signal, the signal ends the program. The mask is set before main,
// so that all threads inherit it, also the threads of gRPC. The client constructs Interrupts before
// it starts a thread.
[[maybe_unused]] const bool kSignalsAreBlocked = [] {
  // In the background of a shell or under nohup they are ignored.
  for (const int ignored : {SIGINT, SIGTERM, SIGHUP}) signal(ignored, SIG_DFL);
  const sigset_t signals = Signals();
  return pthread_sigmask(SIG_BLOCK, &signals, nullptr) == 0;
}();

void Send(int signal) { kill(getpid(), signal); }

void SleepForEver() {
  while (true) pause();
}

// Expects that a signal ends the process while `act` runs. `output`: of standard error.
void ExpectInterrupted(const std::function<void()>& act,
                       const testing::Matcher<const std::string&>& output = testing::_) {
  EXPECT_EXIT(act(), testing::ExitedWithCode(130), output);
}

TEST(InterruptsDeathTest, TheInnermostFarewellRuns) {
  ExpectInterrupted(
      [] {
        Interrupts interrupts;
        const Interrupts::Scope outer(&interrupts, [] { std::cerr << "outer"; });
        const Interrupts::Scope inner(&interrupts, [] { std::cerr << "inner"; });
        {
          const Interrupts::Scope ended(&interrupts, [] { std::cerr << "ended"; });
        }
        Send(SIGINT);
        SleepForEver();
      },
      AllOf(HasSubstr("inner"), Not(HasSubstr("outer")), Not(HasSubstr("ended"))));
}

TEST(InterruptsDeathTest, TheProgramEndsDuringAHangingFarewell) {
  ExpectInterrupted([] {
    Interrupts interrupts;
    const Interrupts::Scope scope(&interrupts, [] { SleepForEver(); });
    Send(SIGTERM);
    SleepForEver();
  });
}

// No thread can start, because no stack is so large.
TEST(InterruptsDeathTest, TheProgramEndsWhenNoThreadIsLeft) {
  ExpectInterrupted(
      [] {
        Interrupts interrupts;
        const Interrupts::Scope scope(&interrupts, [] {
          std::cerr << "farewell";
          SleepForEver();
        });
        pthread_attr_t attributes;
        pthread_attr_init(&attributes);
        pthread_attr_setstacksize(&attributes, size_t{1} << 60);
        pthread_setattr_default_np(&attributes);
        Send(SIGINT);
        SleepForEver();
      },
      HasSubstr("farewell"));
}

TEST(InterruptsDeathTest, NoPartOfAFileIsLeft) {
  const DeathTestFolder folder;
  ExpectInterrupted([&] {
    Interrupts interrupts;
    NewFile file("--save", folder.path() + "/result.csv");
    file.out() << "half";
    Send(SIGINT);
    SleepForEver();
  });
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

// After the scope its owner destroys objects that the farewell uses.
TEST(InterruptsDeathTest, TheEndOfAScopeWaitsForItsFarewell) {
  ExpectInterrupted([] {
    Interrupts interrupts;
    std::latch begun(1);
    {
      const Interrupts::Scope scope(&interrupts, [&] {
        begun.count_down();
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
      });
      Send(SIGINT);
      begun.wait();
    }
    _exit(0);
  });
}

bool IsBlocked(int signal) {
  sigset_t mask;
  pthread_sigmask(SIG_BLOCK, nullptr, &mask);
  return sigismember(&mask, signal) == 1;
}

class InterruptsTest : public ::testing::Test {
 protected:
  InterruptsTest() {
    const sigset_t signals = Signals();
    pthread_sigmask(SIG_UNBLOCK, &signals, &old_);
  }
  ~InterruptsTest() override { pthread_sigmask(SIG_SETMASK, &old_, nullptr); }

  sigset_t old_;
};

TEST_F(InterruptsTest, LeavesTheSignalMaskAsItWas) {
  {
    const Interrupts interrupts;
    EXPECT_TRUE(IsBlocked(SIGINT) && IsBlocked(SIGTERM) && IsBlocked(SIGHUP));
  }
  EXPECT_FALSE(IsBlocked(SIGINT) || IsBlocked(SIGTERM) || IsBlocked(SIGHUP));
}

TEST_F(InterruptsTest, AnIgnoredSignalStaysIgnored) {
  const auto old = signal(SIGHUP, SIG_IGN);
  {
    const Interrupts interrupts;
    EXPECT_FALSE(IsBlocked(SIGHUP));
    EXPECT_TRUE(IsBlocked(SIGINT));
    Send(SIGHUP);
  }
  signal(SIGHUP, old);
}

}  // namespace
}  // namespace ballpiston::client

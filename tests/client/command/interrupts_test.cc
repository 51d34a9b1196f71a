// tests/end_to_end/interrupt_test.cc sends each of the signals to the whole program.
#include "client/command/interrupts.h"

#include <latch>

#include "client/output/output_file.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

// If one thread does not block a signal, the signal ends the program. The mask is set before main,
// so that all threads inherit it, also the threads of gRPC. The client listens for interrupts
// before it starts a thread.
[[maybe_unused]] const bool kSignalsAreBlocked = [] {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal_of_user : {SIGINT, SIGTERM, SIGHUP}) {
    signal(signal_of_user, SIG_DFL);  // in the background of a shell or under nohup it is ignored
    sigaddset(&signals, signal_of_user);
  }
  return pthread_sigmask(SIG_BLOCK, &signals, nullptr) == 0;
}();

void SleepForEver() {
  while (true) pause();
}

// The program gets the signal while it listens.
void InterruptWith(int signal) {
  ListenForInterrupts();
  kill(getpid(), signal);
  SleepForEver();
}

// Expects that a signal ends the process while `act` runs. `output`: of standard error.
void ExpectInterrupted(const std::function<void()>& act,
                       const testing::Matcher<const std::string&>& output = testing::_) {
  EXPECT_EXIT(act(), testing::ExitedWithCode(130), output);
}

TEST(InterruptsDeathTest, TheInnermostFarewellRuns) {
  ExpectInterrupted(
      [] {
        const OnInterrupt outer([] { std::cerr << "outer"; });
        const OnInterrupt inner([] { std::cerr << "inner"; });
        {
          const OnInterrupt ended([] { std::cerr << "ended"; });
        }
        InterruptWith(SIGINT);
      },
      AllOf(HasSubstr("inner"), Not(HasSubstr("outer")), Not(HasSubstr("ended"))));
}

TEST(InterruptsDeathTest, TheProgramEndsDuringAHangingFarewell) {
  ExpectInterrupted([] {
    const OnInterrupt scope([] { SleepForEver(); });
    InterruptWith(SIGTERM);
  });
}

// No thread can start, because no stack is so large.
TEST(InterruptsDeathTest, TheProgramEndsWhenNoThreadIsLeft) {
  ExpectInterrupted(
      [] {
        const OnInterrupt scope([] {
          std::cerr << "farewell";
          SleepForEver();
        });
        ListenForInterrupts();
        pthread_attr_t attributes;
        pthread_attr_init(&attributes);
        pthread_attr_setstacksize(&attributes, size_t{1} << 60);
        pthread_setattr_default_np(&attributes);
        kill(getpid(), SIGINT);
        SleepForEver();
      },
      HasSubstr("farewell"));
}

TEST(InterruptsDeathTest, NoPartOfAFileIsLeft) {
  const DeathTestFolder folder;
  ExpectInterrupted([&] {
    NewFile file("--save", folder.path() + "/result.csv");
    file.out() << "half";
    InterruptWith(SIGINT);
  });
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

// After the scope its owner destroys objects that the farewell uses.
TEST(InterruptsDeathTest, TheEndOfAScopeWaitsForItsFarewell) {
  ExpectInterrupted([] {
    ListenForInterrupts();
    std::latch begun(1);
    {
      const OnInterrupt scope([&] {
        begun.count_down();
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
      });
      kill(getpid(), SIGINT);
      begun.wait();
    }
    _exit(0);
  });
}

TEST(InterruptsDeathTest, AnIgnoredSignalStaysIgnored) {
  ExpectInterrupted(
      [] {
        signal(SIGHUP, SIG_IGN);
        const OnInterrupt scope([] {
          sigset_t mask;
          pthread_sigmask(SIG_BLOCK, nullptr, &mask);
          std::cerr << "blocked: " << sigismember(&mask, SIGHUP) << sigismember(&mask, SIGTERM);
        });
        const sigset_t none{};
        pthread_sigmask(SIG_SETMASK, &none, nullptr);
        ListenForInterrupts();
        kill(getpid(), SIGHUP);
        kill(getpid(), SIGTERM);
        SleepForEver();
      },
      HasSubstr("blocked: 01"));
}

}  // namespace
}  // namespace ballpiston::client

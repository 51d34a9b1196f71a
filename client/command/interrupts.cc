#include "client/command/interrupts.h"

#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "client/command/exit_code.h"
#include "client/output/output_file.h"

namespace ballpiston::client {
namespace {

constexpr std::chrono::milliseconds kLongestFarewell(150);

struct Farewell {
  std::mutex mutex;
  const std::function<void()>* function = nullptr;  // of the innermost scope
};

Farewell& TheFarewell() {
  static auto* const farewell = new Farewell;
  return *farewell;
}

sigset_t SignalsNotIgnored() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler != SIG_IGN) sigaddset(&signals, signal);
  }
  return signals;
}

// Runs no destructors, because other threads may still use the objects.
[[noreturn]] void EndProgram() {
  RemoveUnfinishedFiles();
  std::_Exit(static_cast<int>(ExitCode::kInterrupted));
}

void Listen(const sigset_t& signals) {
  int received = 0;
  while (sigwait(&signals, &received) != 0) {
  }
  // A stopped terminal (Ctrl-S) or a full pipe must not keep the program from ending.
  try {
    std::thread([] {
      std::this_thread::sleep_for(kLongestFarewell);
      EndProgram();
    }).detach();
  } catch (const std::system_error&) {
    // No thread is left. A signal handler may not remove files, so this is done before.
    RemoveUnfinishedFiles();
    signal(SIGALRM, [](int) { _exit(static_cast<int>(ExitCode::kInterrupted)); });
    ualarm(static_cast<useconds_t>(kLongestFarewell / std::chrono::microseconds(1)), 0);
  }
  const std::lock_guard lock(TheFarewell().mutex);
  if (TheFarewell().function != nullptr) (*TheFarewell().function)();
  EndProgram();
}

}  // namespace

void ListenForInterrupts() {
  const sigset_t signals = SignalsNotIgnored();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread([signals] { Listen(signals); }).detach();
}

OnInterrupt::OnInterrupt(std::function<void()> farewell) : farewell_(std::move(farewell)) {
  const std::lock_guard lock(TheFarewell().mutex);
  outer_ = std::exchange(TheFarewell().function, &farewell_);
}

OnInterrupt::~OnInterrupt() {
  const std::lock_guard lock(TheFarewell().mutex);
  TheFarewell().function = outer_;
}

absl::StatusOr<int> RunInterruptible(const ChildProcess& child,
                                     const std::function<void(pid_t)>& stop) {
  absl::StatusOr<pid_t> pid;
  std::mutex mutex;
  std::unique_lock starting(mutex);  // an interruption waits until the child's id is known
  const OnInterrupt scope([&] {
    const std::lock_guard started(mutex);
    if (pid.ok()) stop(*pid);
  });
  pid = StartChild(child);
  starting.unlock();
  return pid.ok() ? WaitForChild(*pid) : pid.status();
}

}  // namespace ballpiston::client

#include "client/command/interrupts.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "client/command/exit_code.h"
#include "client/output/new_file.h"

namespace ballpiston::client {
namespace {

constexpr std::chrono::milliseconds kLongestFarewell(150);

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

}  // namespace

Interrupts::Interrupts() : signals_(SignalsNotIgnored()) {
  pthread_sigmask(SIG_BLOCK, &signals_, &old_mask_);
  signal_file_ = signalfd(-1, &signals_, SFD_CLOEXEC);
  quit_file_ = eventfd(0, EFD_CLOEXEC);
  thread_ = std::thread([this] { Listen(); });
}

Interrupts::~Interrupts() {
  eventfd_write(quit_file_, 1);
  thread_.join();
  close(signal_file_);
  close(quit_file_);
  pthread_sigmask(SIG_SETMASK, &old_mask_, nullptr);
}

void Interrupts::Listen() {
  pollfd files[] = {{signal_file_, POLLIN, 0}, {quit_file_, POLLIN, 0}};
  while (poll(files, 2, -1) < 0) {
  }
  if (files[0].revents == 0) return;
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
  const std::lock_guard lock(mutex_);
  if (farewell_ != nullptr) (*farewell_)();
  EndProgram();
}

Interrupts::Scope::Scope(Interrupts* interrupts, std::function<void()> farewell)
    : interrupts_(interrupts), farewell_(std::move(farewell)) {
  if (interrupts_ == nullptr) return;
  const std::lock_guard lock(interrupts_->mutex_);
  outer_ = std::exchange(interrupts_->farewell_, &farewell_);
}

Interrupts::Scope::~Scope() {
  if (interrupts_ == nullptr) return;
  const std::lock_guard lock(interrupts_->mutex_);
  interrupts_->farewell_ = outer_;
}

absl::StatusOr<int> RunInterruptible(const ChildProcess& child, Interrupts* interrupts,
                                     const std::function<void(pid_t)>& stop) {
  absl::StatusOr<pid_t> pid;
  std::mutex mutex;
  std::unique_lock starting(mutex);  // an interruption waits until the child's id is known
  const Interrupts::Scope scope(interrupts, [&] {
    const std::lock_guard started(mutex);
    if (pid.ok()) stop(*pid);
  });
  pid = StartChild(child);
  starting.unlock();
  return pid.ok() ? WaitForChild(*pid) : pid.status();
}

}  // namespace ballpiston::client

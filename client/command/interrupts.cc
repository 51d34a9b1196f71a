#include "client/command/interrupts.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <utility>

#include "absl/time/clock.h"
#include "client/command/exit_code.h"

namespace ballpiston::client {
namespace {

sigset_t JustSigint() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  return signals;
}

// No destructors: other threads may be anywhere.
[[noreturn]] void EndProgram() { std::_Exit(static_cast<int>(ExitCode::kInterrupted)); }

}  // namespace

Interrupts::Interrupts(absl::Duration second_press) : second_press_(second_press) {
  const sigset_t sigint = JustSigint();
  pthread_sigmask(SIG_BLOCK, &sigint, &old_mask_);
  signals_ = signalfd(-1, &sigint, SFD_CLOEXEC);
  quit_ = eventfd(0, EFD_CLOEXEC);
  thread_ = std::thread([this] { Listen(); });
}

Interrupts::~Interrupts() {
  eventfd_write(quit_, 1);
  thread_.join();
  close(signals_);
  close(quit_);
  pthread_sigmask(SIG_SETMASK, &old_mask_, nullptr);
}

void Interrupts::Listen() {
  pollfd files[] = {{signals_, POLLIN, 0}, {quit_, POLLIN, 0}};
  while (true) {
    const int ready = poll(files, 2, MillisecondsToTimeout());
    if (files[1].revents != 0) return;
    if (ready == 0) OnTimeout();
    if (ready > 0) OnSignal();
  }
}

int Interrupts::MillisecondsToTimeout() {
  const std::lock_guard lock(mutex_);
  if (deadline_ == absl::InfiniteFuture()) return -1;
  const absl::Duration left = std::max(deadline_ - absl::Now(), absl::ZeroDuration());
  return static_cast<int>(absl::ToInt64Milliseconds(left)) + 1;
}

void Interrupts::OnSignal() {
  signalfd_siginfo info;
  if (read(signals_, &info, sizeof(info)) != sizeof(info)) return;
  const std::lock_guard lock(mutex_);
  if (reactions_ == nullptr) EndProgram();
  const bool first = deadline_ == absl::InfiniteFuture();
  deadline_ = first ? absl::Now() + second_press_ : absl::InfiniteFuture();
  first ? reactions_->on_first() : reactions_->on_second();
}

void Interrupts::OnTimeout() {
  const std::lock_guard lock(mutex_);
  if (absl::Now() < deadline_ || reactions_ == nullptr) return;
  deadline_ = absl::InfiniteFuture();
  reactions_->on_no_second();
}

Interrupts::Scope::Scope(Interrupts& interrupts, InterruptReactions reactions)
    : interrupts_(interrupts), reactions_(std::move(reactions)) {
  const std::lock_guard lock(interrupts_.mutex_);
  interrupts_.reactions_ = &reactions_;
}

Interrupts::Scope::~Scope() {
  const std::lock_guard lock(interrupts_.mutex_);
  interrupts_.reactions_ = nullptr;
  interrupts_.deadline_ = absl::InfiniteFuture();
}

}  // namespace ballpiston::client

#include "server/fatal_signals.h"

#include <unistd.h>

#include <array>
#include <cstddef>

namespace ballpiston::server {
namespace {

constexpr std::array kFatalSignals = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
// More than the kernel's frame with the largest vector registers (some 11 kB).
constexpr size_t kSignalStackBytes = size_t{64} << 10;

void (*note_death)(int) = nullptr;
std::array<struct sigaction, kFatalSignals.size()> actions_before;

// The signal is blocked here, so it arrives again, with its earlier effect, when this returns.
void OnFatalSignal(int signal, siginfo_t* info, void*) {
  const bool is_fault = info->si_code > 0;
  if (is_fault || info->si_pid == getpid()) note_death(signal);
  for (size_t i = 0; i < kFatalSignals.size(); ++i) {
    if (kFatalSignals[i] == signal) sigaction(signal, &actions_before[i], nullptr);
  }
  raise(signal);
}

}  // namespace

void NoteFatalSignals(void (*note)(int signal)) {
  note_death = note;
  struct sigaction action {};
  action.sa_sigaction = OnFatalSignal;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  for (size_t i = 0; i < kFatalSignals.size(); ++i) {
    sigaction(kFatalSignals[i], &action, &actions_before[i]);
  }
}

SignalStack::SignalStack() : memory_(std::make_unique<char[]>(kSignalStackBytes)) {
  const stack_t stack = {.ss_sp = memory_.get(), .ss_flags = 0, .ss_size = kSignalStackBytes};
  sigaltstack(&stack, &before_);
}

SignalStack::~SignalStack() { sigaltstack(&before_, nullptr); }

}  // namespace ballpiston::server

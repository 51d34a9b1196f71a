#include "tests/support/thread_stacks.h"

#include <execinfo.h>
#include <signal.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "absl/debugging/symbolize.h"
#include "absl/strings/str_cat.h"

namespace ballpiston {
namespace {

constexpr int kMaxDepth = 64;
constexpr std::chrono::seconds kPatience(1);

// The stack of the thread that handled the signal last. Only one thread gets the signal at a time.
std::array<void*, kMaxDepth> frames;
std::atomic<int> depth = 0;

void RecordStack(int) { depth = backtrace(frames.data(), kMaxDepth); }

std::string NameOf(pid_t thread) {
  std::string name;
  std::getline(std::ifstream(absl::StrCat("/proc/self/task/", thread, "/comm")), name);
  return name;
}

// False if the thread did not answer in time.
bool Record(pid_t thread) {
  depth = 0;
  if (syscall(SYS_tgkill, getpid(), thread, SIGRTMAX) != 0) return false;
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (depth == 0 && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
  return depth > 0;
}

std::string RecordedStack() {
  std::string text;
  char name[512];
  for (int i = 0; i < depth; ++i) {
    // A return address is after the call. If the call is the function's last instruction, the
    // return address is outside the function; therefore the 1 is subtracted.
    const void* const call = static_cast<char*>(frames[static_cast<size_t>(i)]) - 1;
    absl::StrAppend(&text, "    ", absl::Symbolize(call, name, sizeof(name)) ? name : "?", "\n");
  }
  return text;
}

}  // namespace

std::string ThreadStacks() {
  backtrace(frames.data(), 1);  // loads the unwinder; a signal handler must not load it
  struct sigaction action = {};
  action.sa_handler = &RecordStack;
  action.sa_flags = SA_RESTART;  // interrupted system calls continue
  sigaction(SIGRTMAX, &action, nullptr);
  std::string text;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
    const pid_t thread = std::stoi(entry.path().filename());
    if (thread == static_cast<pid_t>(syscall(SYS_gettid))) continue;
    absl::StrAppend(&text, "  thread ", thread, " (", NameOf(thread), ")\n");
    absl::StrAppend(&text, Record(thread) ? RecordedStack() : "    does not answer\n");
  }
  return text;
}

}  // namespace ballpiston

#include "tests/support/thread_stacks.h"

#include <execinfo.h>
#include <signal.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <list>
#include <string>
#include <thread>

#include "absl/debugging/symbolize.h"
#include "absl/strings/str_cat.h"

namespace ballpiston {
namespace {

constexpr int kMaxDepth = 64;
constexpr std::chrono::seconds kPatience(10);

pid_t ThisThread() { return static_cast<pid_t>(syscall(SYS_gettid)); }

// Never freed, because a thread may answer after the time limit. `requests` keeps them reachable
// for the leak sanitizer.
struct Request {
  pid_t thread = 0;
  std::array<void*, kMaxDepth> frames = {};
  std::atomic<int> depth = 0;
};

std::atomic<Request*> asked = nullptr;
std::list<Request>& requests = *new std::list<Request>;

void RecordStack(int) {
  const int error = errno;
  Request* const request = asked.load();
  if (request != nullptr && request->thread == ThisThread()) {
    request->depth = backtrace(request->frames.data(), kMaxDepth);
  }
  errno = error;
}

std::string NameOf(pid_t thread) {
  std::string name;
  std::getline(std::ifstream(absl::StrCat("/proc/self/task/", thread, "/comm")), name);
  return name;
}

// False if the thread did not answer in time.
bool Record(Request& request) {
  asked = &request;
  if (syscall(SYS_tgkill, getpid(), request.thread, SIGRTMAX) != 0) return false;
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (request.depth == 0 && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::yield();
  }
  return request.depth > 0;
}

std::string StackOf(const Request& request) {
  std::string text;
  char name[512];
  for (int i = 0; i < request.depth; ++i) {
    // The return address is behind the call, which may be the function's last instruction.
    const void* const call = static_cast<char*>(request.frames[static_cast<size_t>(i)]) - 1;
    absl::StrAppend(&text, "    ", absl::Symbolize(call, name, sizeof(name)) ? name : "?", "\n");
  }
  return text;
}

void Write(int descriptor, const std::string& text) {
  [[maybe_unused]] const ssize_t written = write(descriptor, text.data(), text.size());
}

}  // namespace

void WriteThreadStacks(int descriptor) {
  void* frame = nullptr;
  backtrace(&frame, 1);  // loads the unwinder, which no signal handler may do
  struct sigaction action = {};
  action.sa_handler = &RecordStack;
  action.sa_flags = SA_RESTART;  // interrupted system calls continue
  sigaction(SIGRTMAX, &action, nullptr);
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
    Request& request = requests.emplace_back();
    request.thread = std::stoi(entry.path().filename());
    if (request.thread == ThisThread()) continue;
    Write(descriptor,
          absl::StrCat("  thread ", request.thread, " (", NameOf(request.thread), ")\n"));
    Write(descriptor, Record(request) ? StackOf(request) : "    does not answer\n");
  }
}

}  // namespace ballpiston

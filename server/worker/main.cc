// ballpiston-worker: computes leases from a shared folder. It uses files only, so it runs on
// machines without network access to the server.
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <limits>
#include <random>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "core/engine_version.h"
#include "server/fatal_signals.h"
#include "server/machine_limits.h"
#include "server/number_range.h"
#include "server/process_start.h"
#include "server/worker/worker.h"

namespace ballpiston::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kExitFailed = 1;
constexpr int kExitOtherVersion = 3;  // of the engine

// A batch system sends SIGUSR1 a minute or more before it kills the worker. If the chunk is not
// complete after this time, it is dropped.
constexpr double kSecondsForAChunk = 50;
// Of --for, for the end.
constexpr double kSecondsToEnd = 5;

struct CommandLine {
  std::string folder;
  double for_seconds = std::numeric_limits<double>::infinity();
  WorkerOptions worker;
};

void Say(absl::string_view line) {
  const std::string text = absl::StrCat("ballpiston-worker: ", line, "\n");
  std::fputs(text.c_str(), stderr);
}

// When the worker has to end: at a signal, or when its time is over. SIGTERM and SIGINT mean now,
// SIGUSR1 after the chunk. The signals are blocked; the worker takes them when it asks or sleeps.
class Ending {
 public:
  explicit Ending(double for_seconds)
      : last_(std::max(for_seconds - kSecondsToEnd, 0.5 * for_seconds)),
        after_chunk_(std::max(last_ - kSecondsForAChunk, 0.5 * last_)) {
    sigemptyset(&signals_);
    for (const int signal : {SIGUSR1, SIGTERM, SIGINT}) sigaddset(&signals_, signal);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  }

  EndOfWork Get() {
    AwaitSignal(0);
    const double seconds = SecondsSinceStart();
    told_ = seconds >= last_          ? EndOfWork::kNow
            : seconds >= after_chunk_ ? EndOfWork::kAfterChunk
                                      : EndOfWork::kNotYet;
    return told_;
  }

  // Returns early when Get would return something else than at its last call. A signal may move
  // both times.
  void Sleep(std::chrono::duration<double> time) {
    const double end = SecondsSinceStart() + time.count();
    const auto next_end = [&] { return told_ == EndOfWork::kNotYet ? after_chunk_ : last_; };
    const auto left = [&] { return std::min(end, next_end()) - SecondsSinceStart(); };
    while (left() > 0) AwaitSignal(left());
  }

 private:
  double SecondsSinceStart() const {
    return std::chrono::duration<double>(Clock::now() - start_).count();
  }

  void AwaitSignal(double most_seconds) {
    const timespec time = absl::ToTimespec(absl::Seconds(std::max(most_seconds, 0.0)));
    const int signal = sigtimedwait(&signals_, nullptr, &time);
    if (signal < 0) return;
    const double now = SecondsSinceStart();
    after_chunk_ = std::min(after_chunk_, now);
    last_ = std::min(last_, signal == SIGUSR1 ? now + kSecondsForAChunk : now);
  }

  const Clock::time_point start_ = Clock::now();
  double last_, after_chunk_;            // seconds since the start
  EndOfWork told_ = EndOfWork::kNotYet;  // what Get returned last
  sigset_t signals_;
};

// ---- if the engine kills this process ----

std::array<char, PATH_MAX> file_of_lease = {};  // empty: none
std::array<char, PATH_MAX> file_after_crash = {};

// SIGBUS does not prove a crash: on NFS it comes when the server has replaced the program's file.
void MoveFileOfLease(int signal) {
  if (signal != SIGBUS) rename(file_of_lease.data(), file_after_crash.data());
}

void SetPath(const std::string& path, std::array<char, PATH_MAX>& text) {
  text = {};
  if (path.size() < text.size()) path.copy(text.data(), path.size());
}

// ---- this machine ----

// Bytes that the machine has for this process, and that Slurm gives it. Slurm says 0 for no limit.
double WorkerMemory() {
  double bytes = MachineMemory();
  for (const char* name : {"SLURM_MEM_PER_CPU", "SLURM_MEM_PER_NODE"}) {
    const char* const text = std::getenv(name);
    double mib = 0;
    const bool is_limit = text != nullptr && absl::SimpleAtod(text, &mib) && mib > 0;
    if (is_limit) bytes = std::min(bytes, mib * (1 << 20));
  }
  return bytes;
}

// The machine's name without characters that have a meaning, and a random number.
std::string WorkerName(uint64_t random) {
  std::array<char, 65> host = {};
  gethostname(host.data(), host.size() - 1);
  std::string name = host.data();
  std::erase_if(name, [](unsigned char c) { return std::isalnum(c) == 0 && c != '-'; });
  return absl::StrCat(name, "-", getpid(), "-", absl::Hex(random, absl::kZeroPad16));
}

uint64_t RandomBits() {
  static std::random_device& device = *new std::random_device;
  return uint64_t{device()} << 32 | device();
}

int Compute(const CommandLine& line) {
  NoteFatalSignals(MoveFileOfLease);
  const SignalStack stack;
  Ending ending(line.for_seconds);
  FolderFiles files(line.folder);
  const WorkerHost host = {.now = [] { return Clock::now(); },
                           .sleep = [&](auto time) { ending.Sleep(time); },
                           .random_bits = RandomBits,
                           .end = [&] { return ending.Get(); },
                           .report = Say,
                           .lease_begins =
                               [&](const std::string& from, const std::string& to) {
                                 SetPath(files.PathOf(from), file_of_lease);
                                 SetPath(files.PathOf(to), file_after_crash);
                               }};
  const absl::Status status = Work(files, line.worker, host);
  if (status.ok()) return 0;
  Say(status.message());
  return absl::IsUnimplemented(status) ? kExitOtherVersion : kExitFailed;
}

void AddFlags(CLI::App& app, CommandLine& line) {
  constexpr double kLeast = 1e-3, kMost = 1e9;  // seconds
  app.add_option("folder", line.folder, "the folder that the server has as --cluster-folder")
      ->required()
      ->check([](const std::string& path) { return std::string(path.empty() ? "is empty" : ""); });
  app.add_option("--for", line.for_seconds,
                 "seconds after which the worker ends; default: no limit")
      ->transform(Between<double>(kLeast, kMost));
  app.add_option("--idle-seconds", line.worker.idle_seconds,
                 "the worker ends if it has found nothing to do for this time")
      ->transform(Between<double>(0, kMost))
      ->capture_default_str();
  app.add_option("--retry-seconds", line.worker.retry_seconds,
                 "wait before the next attempt if the folder is full or cannot be used")
      ->transform(Between<double>(kLeast, kMost))
      ->capture_default_str();
  app.add_option("--give-up-seconds", line.worker.give_up_seconds,
                 "stop retrying one operation on a lease after this time")
      ->transform(Between<double>(0, kMost))
      ->capture_default_str();
  app.set_version_flag("--version", EngineVersion(), "print the engine version");
}

int Main(int argc, char** argv) {
  StartProcess();
  CommandLine line;
  line.worker.memory = WorkerMemory();
  line.worker.name = WorkerName(RandomBits());
  CLI::App app("Computes work of a ballpistond that shares a folder with this machine.",
               "ballpiston-worker");
  AddFlags(app, line);
  try {
    app.parse(argc, argv);
    return Compute(line);
  } catch (const CLI::ParseError& error) {
    constexpr int kExitUsage = 2;
    return app.exit(error) == 0 ? 0 : kExitUsage;
  } catch (const std::exception& error) {
    Say(error.what());
    return kExitFailed;
  }
}

}  // namespace
}  // namespace ballpiston::server

int main(int argc, char** argv) { return ballpiston::server::Main(argc, argv); }

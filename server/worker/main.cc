// ballpiston-worker: computes one task of a job array. It uses files only, so it runs on machines
// without network access to the server.
#include <signal.h>
#include <sys/stat.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stop_token>
#include <string>
#include <thread>

#include "absl/status/status.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "core/engine_version.h"
#include "server/fatal_signals.h"
#include "server/machine_memory.h"
#include "server/worker/crash_mark.h"
#include "server/worker/task_file.h"
#include "server/worker/task_run.h"

namespace ballpiston::server {
namespace {

constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;
constexpr int kExitOtherVersion = 3;  // of the engine or of the files

struct CommandLine {
  std::string task_file;
  size_t task = 0;
  TaskRunOptions run;
};

void Say(absl::string_view line) {
  const std::string text = absl::StrCat("ballpiston-worker: ", line, "\n");
  std::fputs(text.c_str(), stderr);
}

// Requests a stop at the first SIGUSR1, SIGTERM or SIGINT. The signals must be blocked in all
// threads, so this is made before any other thread.
class SignalWatch {
 public:
  explicit SignalWatch(const std::stop_source& stop) {
    sigemptyset(&signals_);
    for (const int signal : {SIGUSR1, SIGTERM, SIGINT}) sigaddset(&signals_, signal);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    thread_ = std::thread([this, stop] {
      int signal = 0;
      sigwait(&signals_, &signal);
      std::stop_source(stop).request_stop();
    });
  }
  // Wakes the thread if no signal came.
  ~SignalWatch() {
    pthread_kill(thread_.native_handle(), SIGUSR1);
    thread_.join();
  }
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

 private:
  sigset_t signals_;
  std::thread thread_;
};

void AddFlags(CLI::App& app, CommandLine& line) {
  app.add_option("--task-file", line.task_file, "the tasks of the job array")->required();
  app.add_option("--task", line.task, "the index of the task to compute")->required();
  app.add_option("--out", line.run.folder, "the folder for the files with chunks")->required();
  app.add_option("--flush-seconds", line.run.flush_seconds,
                 "processor time between two files with complete chunks")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--retry-seconds", line.run.retry_seconds,
                 "wait before the next attempt if the folder is full or cannot be used")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--give-up-seconds", line.run.give_up_seconds, "the sum of these waits")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.set_version_flag("--version", std::string(kEngineVersion), "print the engine version");
}

int Fail(const absl::Status& status) {
  Say(status.message());
  if (absl::IsUnimplemented(status)) return kExitOtherVersion;
  return absl::IsInvalidArgument(status) ? kExitUsage : kExitFailed;
}

// Bytes that the machine has for this task, and that Slurm gives it. Slurm says 0 for no limit.
double TaskMemory() {
  double bytes = MachineMemory();
  for (const char* name : {"SLURM_MEM_PER_CPU", "SLURM_MEM_PER_NODE"}) {
    const char* const text = std::getenv(name);
    double mib = 0;
    const bool is_limit = text != nullptr && absl::SimpleAtod(text, &mib) && mib > 0;
    if (is_limit) bytes = std::min(bytes, mib * (1 << 20));
  }
  return bytes;
}

int Compute(const CommandLine& line) {
  NoteFatalSignals(LeaveCrashMark);
  const SignalStack stack;
  std::stop_source stop;
  const SignalWatch watch(stop);
  const absl::StatusOr<ArrayTask> task = ReadTask(line.task_file, line.task);
  if (!task.ok()) return Fail(task.status());
  const absl::Status status = RunTask(*task, line.run, stop, Say);
  if (status.ok()) return 0;
  Say(status.message());
  return kExitFailed;
}

int Main(int argc, char** argv) {
  umask(0077);
  signal(SIGXFSZ, SIG_IGN);  // a file at its size limit is an error like a full disk
  CommandLine line;
  line.run.memory = TaskMemory();
  CLI::App app("Computes one task of a job array of ballpistond.", "ballpiston-worker");
  AddFlags(app, line);
  try {
    app.parse(argc, argv);
    return Compute(line);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kExitUsage;
  } catch (const std::exception& error) {
    Say(error.what());
    return kExitFailed;
  }
}

}  // namespace
}  // namespace ballpiston::server

int main(int argc, char** argv) { return ballpiston::server::Main(argc, argv); }

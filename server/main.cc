// ballpistond: starts the server, waits for a signal or for idleness, stops it.
#include <malloc.h>
#include <signal.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <system_error>
#include <thread>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "grpc/support/log.h"
#include "server/ballpiston_server.h"
#include "server/command_line/command_line.h"
#include "server/compute/crash_record.h"
#include "server/door/new_token.h"
#include "server/fatal_signals.h"
#include "server/process_start.h"
#include "server/status/failpoint.h"
#include "server/status/log.h"
#include "server/store/backup.h"
#include "server/store/check_store.h"
#include "server/store/data_directory.h"
#include "server/version.h"

namespace ballpiston::server {
namespace {

constexpr int kExitTryAgain = 1;
constexpr int kExitUsage = 2;
constexpr int kExitNotPermitted = 6;
constexpr timespec kLookInterval{0, 200'000'000};  // at idleness
// The time for stopping the workers and closing the store, after the time to drain.
constexpr std::chrono::milliseconds kGrace(800);

// Blocks the signals before the first thread starts, so that they are blocked in all threads.
sigset_t BlockSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGHUP);
  sigprocmask(SIG_BLOCK, &signals, nullptr);
  signal(SIGPIPE, SIG_IGN);
  return signals;
}

// Each connection needs a descriptor. When there is none left, gRPC 1.51 stops listening for good.
void UseAllDescriptors() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

std::atomic<bool> has_stopped_listening = false;

// The only message of gRPC that the log contains.
void NoteEndOfListening(gpr_log_func_args* message) {
  const bool is_end = absl::StartsWith(message->message, "Failed accept");
  if (!is_end || has_stopped_listening.exchange(true)) return;
  LogError(
      absl::StrCat("the server can accept no more connections and ends: start it again, with "
                   "a higher limit of open files (",
                   message->message, ")"));
}

void Reload(BallpistonServer& server) {
  const absl::Status status = server.Reload();
  if (status.ok()) return LogInfo(absl::StrCat("reloaded: ", server.door().Description()));
  LogError(status.message());
}

void AwaitEnd(const sigset_t& signals, const CommandLine& line, BallpistonServer& server) {
  while (true) {
    const int signal = sigtimedwait(&signals, nullptr, &kLookInterval);
    if (signal == SIGHUP) Reload(server);
    if (signal == SIGTERM || signal == SIGINT || has_stopped_listening) break;
    if (line.idle_exit.count() > 0 && server.IdleFor() >= line.idle_exit) {
      return LogInfo("the server is idle: stopping");
    }
  }
  LogInfo("stopping");
}

int ExitCode() { return has_stopped_listening ? kExitTryAgain : 0; }

// Ends the process after this time. Everything that was acknowledged is on disk by then.
void ExitAfter(std::chrono::milliseconds limit, const BallpistonServer& server) {
  try {
    std::thread([limit, &server] {
      std::this_thread::sleep_for(limit);
      server.LeaveDataFolder();
      std::_Exit(ExitCode());
    }).detach();
  } catch (const std::system_error&) {  // no thread is left: SIGALRM ends the process
    alarm(static_cast<unsigned>(limit / std::chrono::seconds(1)) + 1);
  }
}

int Fail(const absl::Status& status) {
  std::fputs(LogLine(Severity::kError, status.message()).c_str(), stderr);
  if (absl::IsUnavailable(status) || absl::IsResourceExhausted(status)) return kExitTryAgain;
  return absl::IsPermissionDenied(status) ? kExitNotPermitted : kExitUsage;
}

// Prints to standard output; returns the exit code.
int Print(const std::string& text) {
  const bool printed = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  return printed ? 0 : kExitUsage;
}

// Prints the token and nothing else to standard output. The log does not hold the token.
int PrintNewToken(const CommandLine& line) {
  const absl::StatusOr<TokenRequest> request = ParseTokenRequest(line.new_token);
  if (!request.ok()) return Fail(request.status());
  const auto token =
      IssueToken({"access-file", line.server.door.access_file}, *request, absl::Now());
  return token.ok() ? Print(*token + "\n") : Fail(token.status());
}

// Prints the result of a check or a backup; returns the exit code.
int Report(const absl::StatusOr<StoreSummary>& summary) {
  if (!summary.ok()) return Fail(summary.status());
  const int printed = Print(SummaryText(*summary) + "\n");
  return summary->sound() ? printed : kExitUsage;
}

std::string StoreIn(const CommandLine& line) {
  return absl::StrCat(line.server.data_dir, "/", kStoreFile);
}

int Main(int argc, char** argv) {
  StartProcess();
  mallopt(M_MMAP_THRESHOLD, 1 << 20);  // the memory of a large request returns to the system
  if (std::getenv("GRPC_VERBOSITY") == nullptr) gpr_set_log_function(&NoteEndOfListening);
  const absl::StatusOr<CommandLine> line = ParseCommandLine(argc, argv);
  if (!line.ok()) return Fail(line.status());
  if (!line->page.empty()) return Print(line->page);
  if (!line->new_token.empty()) return PrintNewToken(*line);
  if (line->check) return Report(CheckStore(StoreIn(*line)));
  if (!line->backup.empty()) return Report(BackupStore(StoreIn(*line), line->backup));
  SetLogLevel(line->log_level);
  UseAllDescriptors();
  NoteFatalSignals(CrashRecord::NoteDeath);
  const sigset_t signals = BlockSignals();
  const auto server = BallpistonServer::Start(line->server);
  if (!server.ok()) return Fail(server.status());
  LogInfo((*server)->door().Description());
  if (!(*server)->metrics_address().empty()) {
    LogInfo(absl::StrCat("metrics at http://", (*server)->metrics_address(), "/metrics"));
  }
  CountFailpointsOfReadyServer();
  LogInfo(absl::StrCat("version ", kVersion, " listening on ", (*server)->address()));
  AwaitEnd(signals, *line, **server);
  ExitAfter(line->drain + kGrace, **server);
  (*server)->Shutdown(line->drain);
  (*server)->LeaveDataFolder();
  // Skips the destructors: after large answers gRPC may wait 10 s for one of its threads.
  std::fflush(nullptr);
  std::_Exit(ExitCode());
}

}  // namespace
}  // namespace ballpiston::server

int main(int argc, char** argv) { return ballpiston::server::Main(argc, argv); }

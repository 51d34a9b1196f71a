#include "server/command_line.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/flags/flag.h"
#include "absl/flags/parse.h"
#include "absl/flags/reflection.h"
#include "absl/flags/usage.h"
#include "absl/flags/usage_config.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "server/version.h"

namespace {

constexpr ballpiston::server::Limits kLimits;

int DefaultWorkers() {
  const unsigned cores = std::thread::hardware_concurrency();
  return cores == 0 ? 1 : static_cast<int>(cores);
}

}  // namespace

ABSL_FLAG(
    std::string, listen, "",
    "where to listen: unix:PATH, or HOST:PORT (port 0 takes any); a host that is not loopback "
    "(127.0.0.0/8, [::1], localhost) needs --tls_certificate, --tls_key and --access_file; "
    "empty: the Unix socket `server.socket` in --data_dir");
ABSL_FLAG(std::string, data_dir, ballpiston::server::DataDirectory::Default(),
          "folder that keeps jobs and results, made if it does not exist; one server at a time");
ABSL_FLAG(int32_t, workers, DefaultWorkers(), "threads that compute, 1 to 1024");
ABSL_FLAG(double, idle_exit_seconds, 0,
          "end when no job is active and no call was in progress for so long; 0: never");
ABSL_FLAG(double, drain_seconds, 10,
          "after SIGTERM or SIGINT: time for calls in progress to end, 0 to 3600");
ABSL_FLAG(std::string, access_file, "",
          "who may come in; a line each: token sha256:HEX PRINCIPAL ROLE [EXPIRES], or certificate "
          "COMMON_NAME PRINCIPAL ROLE [EXPIRES]; a ROLE is read, submit or admin; needs TLS; read "
          "again on SIGHUP");
ABSL_FLAG(std::string, new_token, "",
          "PRINCIPAL:ROLE[:DAYS]: make a token, append it, hashed, to --access_file, print it and "
          "end");
ABSL_FLAG(std::string, tls_certificate, "",
          "PEM file of the server's certificate, then those between it and its authority; read "
          "again on SIGHUP, as the next two");
ABSL_FLAG(std::string, tls_key, "", "PEM file of the certificate's key, closed to others");
ABSL_FLAG(
    std::string, tls_client_ca, "",
    "PEM file of the authorities that sign clients' certificates; when given, a client without "
    "one is not let in");
ABSL_FLAG(double, watch_heartbeat_seconds, 10,
          "a watch of a job says that it lives after so long without news, 0.01 to 3600");
ABSL_FLAG(
    std::string, metrics_listen, "",
    "where Prometheus collects, at /metrics: HOST:PORT with a loopback host (port 0 takes any, "
    "and the log says which); empty: nowhere");
ABSL_FLAG(std::string, log_format, "text", "of standard error: text, or json (an object a line)");
ABSL_FLAG(int64_t, max_active_jobs, kLimits.max_active_jobs,
          "jobs of all principals that have not ended; more are refused; 0: no limit");
ABSL_FLAG(int64_t, max_active_jobs_per_principal, kLimits.max_active_jobs_per_principal,
          "the same, of one principal");
ABSL_FLAG(int64_t, max_active_points, kLimits.max_active_points,
          "points of the grids of all jobs that have not ended; 0: no limit");
ABSL_FLAG(int64_t, max_active_points_per_principal, kLimits.max_active_points_per_principal,
          "the same, of one principal");
ABSL_FLAG(int64_t, max_points_per_job, kLimits.max_points_per_job,
          "points of a job's grid; 0: no limit but the engine's, 100,000");
ABSL_FLAG(double, max_samples_per_job, kLimits.max_samples_per_job,
          "samples or collisions of a job, over all its points; 0: no limit");
ABSL_FLAG(int64_t, max_streams, kLimits.max_streams,
          "open watches and comparisons of all principals; 0: no limit");
ABSL_FLAG(int64_t, max_streams_per_principal, kLimits.max_streams_per_principal,
          "the same, of one principal");
ABSL_FLAG(int64_t, max_calls_per_principal, kLimits.max_calls_per_principal,
          "calls in progress of one principal, watches and comparisons not counted; 0: no limit");
ABSL_FLAG(int64_t, max_call_bytes_per_principal, kLimits.max_call_bytes_per_principal,
          "bytes of their requests, and of answers that are not read yet; 0: no limit");
ABSL_FLAG(int64_t, max_message_bytes, kLimits.max_message_bytes, "of a request, 1024 to 268435456");
ABSL_FLAG(int64_t, max_transfer_mib, kLimits.max_transfer_mib,
          "memory for connections and for requests that are being received, of all clients; beyond "
          "it such calls are refused; at least 16 and twice --max_message_bytes, to 1048576; 0: no "
          "limit");
ABSL_FLAG(
    bool, check, false,
    "check the store in --data_dir, page by page and row by row, print what is in it, and end: "
    "with exit code 0 if it is sound; a server may run meanwhile");
ABSL_FLAG(
    std::string, backup, "",
    "copy the store in --data_dir to this file, checked, and end; a server may run meanwhile");
ABSL_FLAG(std::string, log_level, "info", "the least severe lines written: info, warning, error");

namespace ballpiston::server {
namespace {

constexpr char kProgram[] = "ballpistond";
constexpr int kMaxWorkers = 1024;
constexpr double kMaxSeconds = 1e6;
constexpr int64_t kLeastMessage = 1024;
constexpr int64_t kMostMessage = int64_t{256} << 20;
constexpr int64_t kLeastTransferMib = 16;
constexpr int64_t kMostTransferMib = int64_t{1} << 20;

bool parsing = false;
bool help_asked = false;

// Abseil ends a wrong command line, and a --help, with exit code 1; here they are 2 and 0.
void CorrectExitCode(int code, void*) {
  if (!parsing || code == 0) return;
  std::fflush(nullptr);
  _exit(help_asked ? 0 : 2);
}

void Configure() {
  absl::SetProgramUsageMessage(
      "The server of ballpiston: computes ensembles of rarely interacting billiards.\n"
      "  ballpistond --listen=unix:PATH | --listen=127.0.0.1:PORT [--data_dir=DIR] [--workers=N]\n"
      "  ballpistond --listen=0.0.0.0:PORT --tls_certificate=FILE --tls_key=FILE "
      "--access_file=FILE\n"
      "  ballpistond --access_file=FILE --new_token=PRINCIPAL:ROLE[:DAYS]\n"
      "  ballpistond --data_dir=DIR --check | --backup=FILE\n"
      "Exit codes: 0 stopped, 1 the store's disk is full or fails (try again), 2 a wrong flag, "
      "address or data folder in use, or a store that is not sound, 6 data folder not writable.");
  absl::FlagsUsageConfig config;
  const auto of_this_program = [](absl::string_view file) { return file == kProgram; };
  config.contains_helpshort_flags = of_this_program;
  config.contains_help_flags = of_this_program;
  config.contains_helppackage_flags = of_this_program;
  config.normalize_filename = [](absl::string_view file) {
    return absl::EndsWith(file, "server/command_line.cc") ? std::string(kProgram)
                                                          : std::string(file);
  };
  config.version_string = [] { return absl::StrCat("ballpistond ", kVersion, "\n"); };
  absl::SetFlagsUsageConfig(config);
}

std::vector<char*> ParseFlags(int argc, char** argv) {
  help_asked = std::any_of(argv, argv + argc, [](const char* argument) {
    return absl::StartsWith(argument, "-help") || absl::StartsWith(argument, "--help");
  });
  parsing = true;
  on_exit(&CorrectExitCode, nullptr);
  std::vector<char*> positional = absl::ParseCommandLine(argc, argv);
  parsing = false;
  return positional;
}

absl::Status OutOfRange(absl::string_view flag, const std::string& value,
                        const std::string& permitted) {
  return absl::InvalidArgumentError(
      absl::StrCat("--", flag, "=", value, " is out of range; permitted: ", permitted));
}

absl::StatusOr<std::chrono::milliseconds> Seconds(const char* flag, double value, double lower,
                                                  double upper) {
  if (value >= lower && value <= upper) {
    return std::chrono::milliseconds(static_cast<int64_t>(std::ceil(1000 * value)));
  }
  return OutOfRange(flag, absl::StrCat(value), absl::StrCat(lower, " to ", upper));
}

// The value that the flag's text names.
template <typename Value>
absl::StatusOr<Value> Named(const char* flag, const std::string& text,
                            std::initializer_list<std::pair<const char*, Value>> values) {
  std::string permitted;
  for (const auto& [name, value] : values) {
    if (text == name) return value;
    absl::StrAppend(&permitted, permitted.empty() ? "" : ", ", name);
  }
  return absl::InvalidArgumentError(
      absl::StrCat("--", flag, "=", text, " is not known; permitted: ", permitted));
}

absl::StatusOr<LogOptions> ParseLogOptions() {
  const auto format = Named<LogFormat>("log_format", absl::GetFlag(FLAGS_log_format),
                                       {{"text", LogFormat::kText}, {"json", LogFormat::kJson}});
  const auto least = Named<Severity>(
      "log_level", absl::GetFlag(FLAGS_log_level),
      {{"info", Severity::kInfo}, {"warning", Severity::kWarning}, {"error", Severity::kError}});
  if (!format.ok()) return format.status();
  if (!least.ok()) return least.status();
  return LogOptions{.format = *format, .least = *least};
}

// A number from 0, which is no limit.
absl::Status CheckLimit(absl::string_view flag, double value) {
  return value >= 0 ? absl::OkStatus() : OutOfRange(flag, absl::StrCat(value), "0 (none) and more");
}

// Below twice the longest message, two clients could keep each other from ever sending one.
absl::Status CheckTransfer(const Limits& limits) {
  const int64_t least = std::max(kLeastTransferMib, (2 * limits.max_message_bytes) >> 20);
  const int64_t mib = limits.max_transfer_mib;
  if (mib == 0 || (mib >= least && mib <= kMostTransferMib)) return absl::OkStatus();
  return OutOfRange("max_transfer_mib", absl::StrCat(mib),
                    absl::StrCat("0 (none), or ", least, " to ", kMostTransferMib,
                                 " with --max_message_bytes=", limits.max_message_bytes));
}

absl::StatusOr<Limits> LimitFlags() {
  Limits limits;
  absl::Status valid;
  const auto read = [&valid](const auto& flag, auto& limit) {
    limit = absl::GetFlag(flag);
    const auto name = absl::GetFlagReflectionHandle(flag).Name();
    if (valid.ok()) valid = CheckLimit(name, static_cast<double>(limit));
  };
  read(FLAGS_max_active_jobs, limits.max_active_jobs);
  read(FLAGS_max_active_jobs_per_principal, limits.max_active_jobs_per_principal);
  read(FLAGS_max_active_points, limits.max_active_points);
  read(FLAGS_max_active_points_per_principal, limits.max_active_points_per_principal);
  read(FLAGS_max_points_per_job, limits.max_points_per_job);
  read(FLAGS_max_samples_per_job, limits.max_samples_per_job);
  read(FLAGS_max_streams, limits.max_streams);
  read(FLAGS_max_streams_per_principal, limits.max_streams_per_principal);
  read(FLAGS_max_calls_per_principal, limits.max_calls_per_principal);
  read(FLAGS_max_call_bytes_per_principal, limits.max_call_bytes_per_principal);
  if (!valid.ok()) return valid;
  limits.max_message_bytes = absl::GetFlag(FLAGS_max_message_bytes);
  limits.max_transfer_mib = absl::GetFlag(FLAGS_max_transfer_mib);
  if (limits.max_message_bytes < kLeastMessage || limits.max_message_bytes > kMostMessage) {
    return OutOfRange("max_message_bytes", absl::StrCat(limits.max_message_bytes),
                      absl::StrCat(kLeastMessage, " to ", kMostMessage));
  }
  const absl::Status transfer = CheckTransfer(limits);
  if (!transfer.ok()) return transfer;
  return limits;
}

SecurityOptions SecurityFlags() {
  return {.access_file = absl::GetFlag(FLAGS_access_file),
          .tls_certificate = absl::GetFlag(FLAGS_tls_certificate),
          .tls_key = absl::GetFlag(FLAGS_tls_key),
          .tls_client_ca = absl::GetFlag(FLAGS_tls_client_ca)};
}

// Each of them is done instead of everything else.
absl::Status CheckOneMode() {
  std::vector<std::string> given;
  if (absl::GetFlag(FLAGS_check)) given.push_back("--check");
  if (!absl::GetFlag(FLAGS_backup).empty()) given.push_back("--backup");
  if (!absl::GetFlag(FLAGS_new_token).empty()) given.push_back("--new_token");
  if (given.size() <= 1) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      absl::StrJoin(given, " and "), " exclude each other: give one of them, and do one thing"));
}

absl::StatusOr<std::optional<TokenRequest>> NewTokenFlag() {
  const std::string text = absl::GetFlag(FLAGS_new_token);
  if (text.empty()) return std::nullopt;
  if (absl::GetFlag(FLAGS_access_file).empty()) {
    return absl::InvalidArgumentError("--new_token: --access_file is missing, where it is kept");
  }
  return ParseTokenRequest(text);
}

}  // namespace

absl::StatusOr<CommandLine> ParseCommandLine(int argc, char** argv) {
  Configure();
  const std::vector<char*> positional = ParseFlags(argc, argv);
  if (positional.size() > 1) {
    return absl::InvalidArgumentError(
        absl::StrCat("unexpected argument \"", positional[1], "\"; see --help"));
  }
  const auto drain = Seconds("drain_seconds", absl::GetFlag(FLAGS_drain_seconds), 0, 3600);
  const auto idle =
      Seconds("idle_exit_seconds", absl::GetFlag(FLAGS_idle_exit_seconds), 0, kMaxSeconds);
  const auto heartbeat =
      Seconds("watch_heartbeat_seconds", absl::GetFlag(FLAGS_watch_heartbeat_seconds), 0.01, 3600);
  const auto log = ParseLogOptions();
  for (const absl::Status& status :
       {drain.status(), idle.status(), heartbeat.status(), log.status()}) {
    if (!status.ok()) return status;
  }
  if (absl::Status status = CheckOneMode(); !status.ok()) return status;
  const auto new_token = NewTokenFlag();
  if (!new_token.ok()) return new_token.status();
  const auto limits = LimitFlags();
  if (!limits.ok()) return limits.status();
  CommandLine line;
  line.server.limits = *limits;
  line.check = absl::GetFlag(FLAGS_check);
  line.backup = absl::GetFlag(FLAGS_backup);
  line.new_token = *new_token;
  line.server.security = SecurityFlags();
  line.log = *log;
  line.server.metrics_listen = absl::GetFlag(FLAGS_metrics_listen);
  line.server.data_dir = absl::GetFlag(FLAGS_data_dir);
  line.server.listen = absl::GetFlag(FLAGS_listen);
  line.server.workers = absl::GetFlag(FLAGS_workers);
  if (line.server.workers < 1 || line.server.workers > kMaxWorkers) {
    return OutOfRange("workers", absl::StrCat(line.server.workers),
                      absl::StrCat("1 to ", kMaxWorkers));
  }
  line.server.watch.heartbeat = *heartbeat;
  if (idle->count() > 0) line.idle_exit = *idle;
  line.drain = *drain;
  return line;
}

}  // namespace ballpiston::server

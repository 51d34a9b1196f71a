#include "server/command_line/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "server/command_line/flag_file.h"
#include "server/command_line/flag_values.h"
#include "server/command_line/help_page.h"
#include "server/machine_memory.h"
#include "server/version.h"

namespace ballpiston::server {
namespace {

constexpr int64_t kMostWorkers = 1024;
constexpr double kMostSeconds = 1e6;
constexpr int64_t kLeastMessage = 1024;
constexpr int64_t kMostMessage = int64_t{256} << 20;
constexpr int64_t kLeastTransferMib = 16;
constexpr int64_t kMostTransferMib = int64_t{1} << 20;
constexpr int64_t kMostSlurmMinutes = 60 * 24 * 365;
constexpr int64_t kMostSlurmTasks = 1'000'000;

// ---- the flags, by their groups in --help ----

void BeginGroup(CLI::App& app, const std::string& name) { app.option_defaults()->group(name); }

void AddServerFlags(CLI::App& app, CommandLine& line) {
  BeginGroup(app, "Server");
  app.add_option("--listen", line.server.listen,
                 "address of the API: unix:PATH or HOST:PORT (port 0: any free port). A host that "
                 "other machines can reach needs --tls-certificate, --tls-key and --access-file. "
                 "Default: the Unix socket server.socket in the data folder")
      ->type_name("ADDRESS");
  app.add_option("--data-dir,--data_dir", line.server.data_dir,
                 "folder of jobs and results. It is created if it does not exist; one server at a "
                 "time can use it")
      ->type_name("DIR")
      ->capture_default_str();
  AddInteger(app, "workers", line.server.workers, Between(int64_t{1}, kMostWorkers),
             "threads that compute");
  AddSeconds(app, "watch-heartbeat-seconds", line.server.watch.heartbeat, Between(0.01, 3600.0),
             "a watch with nothing new to send sends a heartbeat after this time");
  AddSeconds(app, "idle-exit-seconds", line.idle_exit, Between(0.0, kMostSeconds, " (never)"),
             "the server stops when it has had no active job and no call for this time");
  AddSeconds(app, "drain-seconds", line.drain, Between(0.0, 3600.0),
             "time for calls in progress to end after SIGTERM or SIGINT");
  AddFlagFile(app);
}

void AddLocalAccessFlags(CLI::App& app, SecurityOptions& security) {
  BeginGroup(app, "Users of this machine");
  AddChoice(app, "socket-mode", security.socket_mode,
            {{"0600", mode_t{0600}}, {"0660", mode_t{0660}}, {"0666", mode_t{0666}}},
            "mode of the Unix socket in --listen. 0600: only the server's user and root connect, "
            "as principal local. 0660: also the members of --socket-group. 0666: every user. With "
            "0660 and 0666 each user is a principal of that name, with the role submit; if an "
            "--access-file has lines user UNIX_USER PRINCIPAL ROLE [EXPIRES], only its users are "
            "accepted. The server's user and root are administrators");
  app.add_option("--socket-group", security.socket_group,
                 "group of the Unix socket, by name or number, with --socket-mode=0660. The "
                 "server's user must belong to it")
      ->type_name("GROUP");
  AddChoice(
      app, "loopback-role", security.loopback_role,
      {{RoleName(kLoopbackRole), kLoopbackRole}, {"read", Role::kRead}, {"admin", Role::kAdmin}},
      "role of every user of this machine at a loopback HOST:PORT without --access-file: "
      "read, submit or admin. All of them are the principal local");
}

void AddSecurityFlags(CLI::App& app, SecurityOptions& security) {
  BeginGroup(app, "Security; SIGHUP makes the server read these files again");
  app.add_option("--tls-certificate", security.tls_certificate,
                 "PEM file: the server's certificate, then the intermediate certificates")
      ->type_name("FILE");
  app.add_option("--tls-key", security.tls_key,
                 "PEM file: the certificate's private key, which other users cannot read")
      ->type_name("FILE");
  app.add_option("--tls-client-ca", security.tls_client_ca,
                 "PEM file: the authorities that sign clients' certificates. With it, every client "
                 "needs a certificate")
      ->type_name("FILE");
  app.add_option(
         "--access-file", security.access_file,
         "credentials of the clients; needs TLS, or a Unix socket with --socket-mode (see there). "
         "One line for each credential: token sha256:HEX PRINCIPAL "
         "ROLE [EXPIRES], or certificate COMMON_NAME PRINCIPAL ROLE [EXPIRES]; ROLE is "
         "read, submit or admin")
      ->type_name("FILE");
}

void AddSlurmFlags(CLI::App& app, bool& with_slurm, SlurmOptions& slurm) {
  BeginGroup(app, "Slurm, with --executor=slurm");
  AddChoice(
      app, "executor", with_slurm, {{"threads", false}, {"slurm", true}},
      "threads: only this server's threads compute; slurm: long work also goes to a Slurm cluster");
  app.add_option("--slurm-shared-folder", slurm.shared_folder,
                 "folder that the server and all nodes of the cluster see under this absolute "
                 "path. It belongs to the server's user; other users cannot write it")
      ->type_name("DIR");
  app.add_option("--slurm-partition", slurm.partition, "partition; default: the cluster's default")
      ->type_name("NAME");
  app.add_option("--slurm-account", slurm.account, "account; default: the user's default")
      ->type_name("NAME");
  app.add_option("--slurm-cluster", slurm.cluster,
                 "cluster, where a site has several; needs slurmdbd")
      ->type_name("NAME");
  AddInteger(app, "slurm-time-limit-minutes", slurm.time_limit_minutes,
             Between(int64_t{1}, kMostSlurmMinutes), "time limit of a task");
  app.add_option("--slurm-option", slurm.sbatch_options,
                 "one further word for sbatch, such as --slurm-option=--mem-per-cpu=500M; may be "
                 "given several times")
      ->type_name("WORD")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->expected(1);
  AddInteger(app, "slurm-max-tasks", slurm.max_tasks, Between(int64_t{1}, kMostSlurmTasks),
             "tasks that wait or run at the same time; a task uses one core");
  AddInteger(app, "slurm-max-array-size", slurm.max_array_size,
             Between(int64_t{1}, kMostSlurmTasks),
             "tasks of one job array; less than the cluster's MaxArraySize");
  AddSeconds(app, "slurm-task-seconds", slurm.task_length, Between(1.0, 86400.0),
             "computing time of a task, about; at most half of the time limit is used");
  AddSeconds(app, "slurm-least-seconds", slurm.least_work, Between(0.0, 86400.0),
             "a job that is expected to take less of one core is computed by this server alone");
  AddSeconds(app, "slurm-query-seconds", slurm.query_interval, Between(1.0, 3600.0),
             "time between two queries of Slurm's queue");
  app.add_option("--slurm-worker", slurm.worker,
                 "the program ballpiston-worker, which the server copies into the shared folder; "
                 "default: the one installed with the server")
      ->type_name("FILE");
}

struct LimitFlag {
  const char* flag;
  std::variant<int64_t Limits::*, double Limits::*> limit;
  const char* description;
};

// 0 means no limit.
const LimitFlag kLimitFlags[] = {
    {"max-active-jobs", &Limits::max_active_jobs, "jobs that have not ended, of all principals"},
    {"max-active-jobs-per-principal", &Limits::max_active_jobs_per_principal,
     "jobs that have not ended, of one principal"},
    {"max-active-points", &Limits::max_active_points,
     "grid points of jobs that have not ended, of all principals"},
    {"max-active-points-per-principal", &Limits::max_active_points_per_principal,
     "grid points of jobs that have not ended, of one principal"},
    {"max-points-per-job", &Limits::max_points_per_job,
     "grid points of one job; the engine permits 100,000 at most"},
    {"max-samples-per-job", &Limits::max_samples_per_job,
     "samples or collisions of one job, over all its points"},
    {"max-streams", &Limits::max_streams, "open watches and traces of all principals"},
    {"max-streams-per-principal", &Limits::max_streams_per_principal,
     "open watches and traces of one principal"},
    {"max-calls-per-principal", &Limits::max_calls_per_principal,
     "calls in progress of one principal, without watches"},
    {"max-call-bytes-per-principal", &Limits::max_call_bytes_per_principal,
     "bytes of the requests of these calls and of their unread answers"},
    {"max-transfer-mib", &Limits::max_transfer_mib,
     "MiB for connections and for requests that are being received, of all clients; calls beyond "
     "it are rejected. At least 16 and twice --max-message-bytes, at most 1048576"},
    {"max-memory-mib", &Limits::max_memory_mib,
     "MiB of memory of all points that this server computes at a time, by an upper bound; points "
     "beyond it wait, and a point has as many threads as there is memory for. Default: 80 % of "
     "the memory of this machine or of the server's control group"},
    {"retain-days", &Limits::retain_days,
     "days from the end of a job until its results expire, unless it is pinned; its "
     "specification stays"},
    {"max-store-bytes", &Limits::max_store_bytes,
     "bytes of the store; shortly before it is full, results expire, the oldest first. Active and "
     "pinned jobs may store more than that; then no further job is accepted"},
};

void AddLimitFlags(CLI::App& app, Limits& limits) {
  BeginGroup(app, "Limits; 0 means no limit");
  for (const LimitFlag& row : kLimitFlags) {
    const auto add = [&]<typename Number>(Number Limits::*limit) {
      AddNumber(app, row.flag, limits.*limit, LimitRange<Number>(), row.description);
    };
    std::visit(add, row.limit);
  }
  AddInteger(app, "max-message-bytes", limits.max_message_bytes,
             Between(kLeastMessage, kMostMessage), "bytes of one request");
}

void AddLogFlags(CLI::App& app, CommandLine& line) {
  BeginGroup(app, "Log (on standard error) and metrics");
  AddChoice(app, "log-format", line.log.format,
            {{"text", LogFormat::kText}, {"json", LogFormat::kJson}},
            "text, or json: one object a line");
  AddChoice(
      app, "log-level", line.log.least,
      {{"info", Severity::kInfo}, {"warning", Severity::kWarning}, {"error", Severity::kError}},
      "the least severe lines that are written: info, warning or error");
  app.add_option("--metrics-listen", line.server.metrics_listen,
                 "address of Prometheus metrics, at /metrics: HOST:PORT with a loopback host (port "
                 "0: any free port, which the log names). Default: no metrics")
      ->type_name("ADDRESS");
}

void AddCommands(CLI::App& app, CommandLine& line, std::string& new_token) {
  BeginGroup(app, "Commands; at most one, instead of a server");
  app.option_defaults()->configurable(false);
  app.add_option("--new-token", new_token,
                 "make a token, append its hash to --access-file and print the token")
      ->type_name("PRINCIPAL:ROLE[:DAYS]");
  app.add_flag("--check", line.check,
               "check the whole store in --data-dir and print a summary; the exit code is 0 if "
               "the store is sound. A server may use the store at the same time");
  app.add_option("--backup", line.backup,
                 "copy the store in --data-dir to this file, and check the copy. A server may use "
                 "the store at the same time")
      ->type_name("FILE");
  app.add_option(
         "--verify", line.verify,
         "compute a random point, or a random chunk of samples, of a saved result again and "
         "compare; the exit code is 0 if it is the same")
      ->type_name("FILE");
  // trigger_on_parse: --help prints the help even if another flag is wrong.
  app.add_flag_callback(
         "-h,--help", [] { throw CLI::CallForHelp(); }, "print this page")
      ->trigger_on_parse();
  app.set_version_flag("--version", absl::StrCat("ballpistond ", kVersion), "print the version")
      ->trigger_on_parse();
}

// ---- parsing ----

// The arguments in reverse order, as CLI11 expects them. An empty value, as in --listen=, becomes
// an argument of its own; otherwise CLI11 would use the next flag as the value.
std::vector<std::string> Arguments(int argc, const char* const* argv) {
  std::vector<std::string> arguments;
  for (int i = 1; i < argc; ++i) {
    std::string argument = argv[i];
    const bool is_empty =
        absl::StartsWith(argument, "--") && argument.find('=') == argument.size() - 1;
    if (is_empty) argument.pop_back();
    arguments.push_back(std::move(argument));
    if (is_empty) arguments.emplace_back();
  }
  std::reverse(arguments.begin(), arguments.end());
  return arguments;
}

// The first argument that CLI11 could not use.
std::string Unexpected(const CLI::App& app) {
  for (const std::string& argument : app.remaining()) {
    if (argument == "--") continue;
    if (!absl::StartsWith(argument, "-")) {
      return absl::StrCat("unexpected argument \"", argument, "\"; --help lists the flags");
    }
    const std::string flag = argument.substr(0, argument.find('='));
    const size_t name = std::min(flag.find_first_not_of('-'), flag.size());
    return NoSuchFlag(app, flag.substr(name), flag);
  }
  return "unexpected argument; --help lists the flags";
}

std::string WrongNumberOfValues(const CLI::App& app, const std::string& last_argument) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() > 1) return absl::StrCat(option->get_name(), " is given more than once");
  }
  return absl::StrCat(last_argument, " needs a value");
}

// CLI11 treats an empty text as a missing value.
absl::Status CheckValuesAreGiven(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    const bool takes_value = option->get_items_expected_max() > 0;
    if (!takes_value || option->count() == 0 || !option->results().front().empty()) continue;
    return absl::InvalidArgumentError(absl::StrCat(option->get_name(), " needs a value"));
  }
  return absl::OkStatus();
}

// Sets the flags, or `page`.
absl::Status Parse(CLI::App& app, std::vector<std::string> arguments, std::string& page) {
  const std::string last = arguments.empty() ? "" : arguments.front();
  try {
    app.parse(arguments);
  } catch (const CLI::CallForHelp&) {
    page = app.help();
  } catch (const CLI::CallForVersion& version) {
    page = absl::StrCat(version.what(), "\n");
  } catch (const CLI::ExtrasError&) {
    return absl::InvalidArgumentError(Unexpected(app));
  } catch (const CLI::ArgumentMismatch&) {
    return absl::InvalidArgumentError(WrongNumberOfValues(app, last));
  } catch (const CLI::FileError&) {
    return absl::InvalidArgumentError(absl::StrCat(
        "--config=", app.get_config_ptr()->as<std::string>(), " is not a file that can be read"));
  } catch (const CLI::ParseError& error) {
    return absl::InvalidArgumentError(error.what());
  }
  return CheckValuesAreGiven(app);
}

// ---- combinations of flags ----

// With less memory than two messages of the greatest length, two clients that send such messages
// could block each other for ever.
absl::Status CheckTransfer(const Limits& limits) {
  const int64_t least = std::max(kLeastTransferMib, (2 * limits.max_message_bytes) >> 20);
  const int64_t mib = limits.max_transfer_mib;
  if (mib == 0 || (mib >= least && mib <= kMostTransferMib)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "--max-transfer-mib=", mib, " is out of range; permitted: 0 (no limit), or ", least, " to ",
      kMostTransferMib, " with --max-message-bytes=", limits.max_message_bytes));
}

absl::Status CheckSlurm(const CLI::App& app, bool with_slurm, const SlurmOptions& slurm) {
  if (with_slurm && slurm.shared_folder.empty()) {
    return absl::InvalidArgumentError(
        "--executor=slurm: --slurm-shared-folder is missing, the folder that the server and the "
        "nodes of the cluster share");
  }
  if (with_slurm && !absl::StartsWith(slurm.shared_folder, "/")) {
    return absl::InvalidArgumentError(
        absl::StrCat("--slurm-shared-folder=", slurm.shared_folder, " is not an absolute path"));
  }
  if (with_slurm) return absl::OkStatus();
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() == 0 || !absl::StartsWith(option->get_name(), "--slurm-")) continue;
    return absl::InvalidArgumentError(absl::StrCat(option->get_name(), " needs --executor=slurm"));
  }
  return absl::OkStatus();
}

absl::Status CheckOneCommand(const CommandLine& line, const std::string& new_token) {
  std::vector<std::string> given;
  if (line.check) given.push_back("--check");
  if (!line.backup.empty()) given.push_back("--backup");
  if (!line.verify.empty()) given.push_back("--verify");
  if (!new_token.empty()) given.push_back("--new-token");
  if (given.size() <= 1) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(absl::StrJoin(given, " and "), " exclude each other; give one of them"));
}

absl::Status SetNewToken(const std::string& text, CommandLine& line) {
  if (text.empty()) return absl::OkStatus();
  if (line.server.security.access_file.empty()) {
    return absl::InvalidArgumentError(
        "--new-token: --access-file is missing, the file that keeps the token's hash");
  }
  absl::StatusOr<TokenRequest> request = ParseTokenRequest(text);
  if (request.ok()) line.new_token = *std::move(request);
  return request.status();
}

int DefaultWorkers() {
  const auto cores = int64_t{std::thread::hardware_concurrency()};
  return static_cast<int>(std::clamp(cores, int64_t{1}, kMostWorkers));
}

int64_t DefaultMemoryMib() {
  constexpr double kShare = 0.8;
  return static_cast<int64_t>(kShare * MachineMemory() / (1 << 20));
}

}  // namespace

absl::StatusOr<CommandLine> ParseCommandLine(int argc, const char* const* argv) {
  CommandLine line;
  line.server.workers = DefaultWorkers();
  line.server.limits.max_memory_mib = DefaultMemoryMib();
  std::string new_token;
  CLI::App app("", "ballpistond");
  app.set_help_flag();  // AddCommands adds its own help flag
  SetHelpPage(app);
  AddServerFlags(app, line);
  AddLocalAccessFlags(app, line.server.security);
  AddSecurityFlags(app, line.server.security);
  bool with_slurm = false;
  SlurmOptions slurm;
  AddSlurmFlags(app, with_slurm, slurm);
  AddLimitFlags(app, line.server.limits);
  AddLogFlags(app, line);
  AddCommands(app, line, new_token);
  absl::Status parsed = Parse(app, Arguments(argc, argv), line.page);
  if (!parsed.ok()) return parsed;
  if (!line.page.empty()) return line;
  for (const absl::Status& status :
       {CheckTransfer(line.server.limits), CheckOneCommand(line, new_token),
        SetNewToken(new_token, line), CheckSlurm(app, with_slurm, slurm)}) {
    if (!status.ok()) return status;
  }
  if (with_slurm) line.server.slurm = std::move(slurm);
  return line;
}

}  // namespace ballpiston::server

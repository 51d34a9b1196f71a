#include "server/command_line/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <istream>
#include <memory>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "server/machine_limits.h"
#include "server/number_range.h"
#include "server/version.h"

namespace ballpiston::server {
namespace {

constexpr char kDescription[] =
    "The server of ballpiston: computes ensembles of rarely interacting billiards.";
constexpr char kExitCodes[] =
    "Exit codes: 0 stopped (SIGTERM, SIGINT, idle) or done; 1 the disk of the store is full or\n"
    "fails, an address cannot be used, or no descriptor is left for a connection, retry later;\n"
    "2 a wrong flag, an unsafe combination of flags, a folder in use, or a store that is not\n"
    "sound; 6 a data folder that is not writable, or that other users can enter and the server\n"
    "may not close.";
constexpr int kHelpIndentation = 8;

constexpr int kMostWorkers = 1024;
constexpr double kMostSeconds = 1e6;
constexpr double kDaySeconds = 86400;
constexpr double kMostLimit = 1e15;
// A smaller limit is a mistake in its unit, and would expire all results at once.
constexpr double kLeastDays = 1e-3, kLeastStoreBytes = 1e6;
constexpr int64_t kMostSlurmMinutes = 60 * 24 * 365;
constexpr int64_t kMostSlurmWorkers = 1'000'000;

// Shown instead of a default that depends on the machine, because the man page is made from --help.
constexpr char kOfThisMachine[] = "";

// Values of flags that are converted after all flags were read.
struct Words {
  std::string executor = "threads";
  std::string log_level = "info";
  ClusterOptions cluster;
  SlurmOptions slurm;
};

// ---- values ----

std::string Text(double number) { return absl::StrFormat("%.15g", number); }

template <typename Number>
CLI::Option* AddNumber(CLI::App& app, const std::string& flag, Number& value, double least,
                       double most, const std::string& description, bool permits_zero = false) {
  return app.add_option(flag, value, description)
      ->transform(Between<Number>(least, most, permits_zero))
      ->type_name("N")
      ->capture_default_str();
}

void AddSeconds(CLI::App& app, const std::string& flag, std::chrono::milliseconds& time,
                double least, double most, const std::string& description) {
  const auto set = [&time](double seconds) {
    time = std::chrono::milliseconds(static_cast<int64_t>(std::ceil(1000 * seconds)));
  };
  app.add_option_function<double>(flag, set, description)
      ->transform(Between<double>(least, most))
      ->type_name("SECONDS")
      ->default_str(Text(std::chrono::duration<double>(time).count()));
}

// An unset variable of a shell gives an empty text.
CLI::Option* AddText(CLI::App& app, const std::string& flag, std::string& text,
                     const std::string& type, const std::string& description) {
  const auto refuse_empty = [](const std::string& given) {
    return std::string(given.empty() ? "needs a value" : "");
  };
  return app.add_option(flag, text, description)->check(refuse_empty)->type_name(type);
}

void AddWord(CLI::App& app, const std::string& flag, std::string& word,
             const std::vector<std::string>& words, const std::string& description) {
  app.add_option(flag, word, description)
      ->check(CLI::IsMember(words))
      ->type_name("NAME")
      ->capture_default_str();
}

// ---- the file of --config ----

// Reads lines FLAG = VALUE and sets the flags that the command line does not have; a line that
// begins with # is a comment. With CLI11's own reader, the server would start without some of the
// flags in the file: the reader ignores what follows [SECTION], and it ignores the second of two
// lines of a flag unless they are adjacent.
class FlagFile : public CLI::Config {
 public:
  explicit FlagFile(CLI::App& app) : app_(app) {}

  // Sets each flag while the number of its line is known, and returns none to CLI11.
  std::vector<CLI::ConfigItem> from_config(std::istream& file) const override {
    int number = 0;
    for (std::string line; std::getline(file, line);) {
      ++number;
      absl::StripAsciiWhitespace(&line);
      if (line.empty() || line.front() == '#') continue;
      try {
        Set(line);
      } catch (const CLI::ParseError& error) {
        const auto path = app_.get_config_ptr()->as<std::string>();
        throw CLI::ConfigError(absl::StrCat(path, ":", number, ": ", error.what()));
      }
    }
    return {};
  }

  std::string to_config(const CLI::App*, bool, bool, std::string) const override { return ""; }

 private:
  void Set(const std::string& line) const {
    const std::pair<std::string, std::string> parts = absl::StrSplit(line, absl::MaxSplits('=', 1));
    const std::string flag(absl::StripAsciiWhitespace(parts.first));
    CLI::Option* const option = app_.get_option_no_throw("--" + flag);
    if (option == nullptr) throw CLI::ExtrasError(std::vector<std::string>{flag});
    if (!option->get_configurable()) throw CLI::ConfigError::NotConfigurable(flag);
    const bool is_on_command_line = option->count() > 0 && !option->get_callback_run();
    if (is_on_command_line) return;  // CLI11 sets such flags after this file
    option->add_result(std::string(absl::StripAsciiWhitespace(parts.second)))->run_callback();
  }

  CLI::App& app_;
};

// ---- the flags, by their groups in --help ----

void BeginGroup(CLI::App& app, const std::string& name) { app.option_defaults()->group(name); }

void AddServerFlags(CLI::App& app, CommandLine& line) {
  BeginGroup(app, "Server");
  AddText(app, "--listen", line.server.listen, "ADDRESS",
          "address of the API: unix:PATH or HOST:PORT (port 0: any free port). A host that other\n"
          "machines can reach needs --tls-certificate, --tls-key and --access-file.\n"
          "Default: the Unix socket server.socket in the data folder");
  AddText(app, "--data-dir,--data_dir", line.server.data_dir, "DIR",
          "folder of jobs and results, created if it does not exist; one server at a time uses\n"
          "it. Default: ~/.local/state/ballpiston; XDG_STATE_HOME replaces ~/.local/state");
  AddNumber(app, "--workers", line.server.workers, 1, kMostWorkers,
            "threads that compute; by default one for each core that the affinity and the control\n"
            "group (cgroup) of this process permit")
      ->default_str(kOfThisMachine);
  AddWord(app, "--device", line.server.device, {kProcessor, kGpu},
          "what computes the flights of pairs for these threads; results do not depend on it. gpu\n"
          "needs a program that was built with CUDA, and a device");
  AddSeconds(app, "--watch-heartbeat-seconds", line.server.watch.heartbeat, 0.01, 3600,
             "a watch with nothing new to send sends a heartbeat after this time");
  AddSeconds(app, "--idle-exit-seconds", line.idle_exit, 0, kMostSeconds,
             "stop after this time without active jobs and calls (0: never)");
  AddSeconds(app, "--drain-seconds", line.drain, 0, 3600,
             "time for calls in progress to end after SIGTERM or SIGINT");
  app.config_formatter(std::make_shared<FlagFile>(app));
  app.set_config("--config", "",
                 "file of flags, one a line: FLAG = VALUE, without the dashes. A line that begins\n"
                 "with # is a comment. A flag of the command line takes precedence")
      ->option_text("FILE");
}

void AddDoorFlags(CLI::App& app, DoorOptions& door) {
  BeginGroup(app, "Security; SIGHUP makes the server read these files again");
  AddText(app, "--tls-certificate", door.tls_certificate, "FILE",
          "PEM file: the server's certificate, then the intermediate certificates");
  AddText(app, "--tls-key", door.tls_key, "FILE",
          "PEM file: the certificate's private key, which other users cannot read");
  AddText(app, "--access-file", door.access_file, "FILE",
          "tokens of the clients, one line each: token sha256:HEX PRINCIPAL ROLE [EXPIRES]; ROLE\n"
          "is read, submit or admin. Without TLS this server's user needs none");
}

void AddClusterFlags(CLI::App& app, Words& words) {
  ClusterOptions& cluster = words.cluster;
  BeginGroup(app, "Other machines, with --executor=folder or --executor=slurm");
  AddWord(app, "--executor", words.executor, {"threads", "folder", "slurm"},
          "threads: only this server's threads compute; folder: workers that you start also take\n"
          "long work, from a shared folder; slurm: the server starts such workers with Slurm");
  AddText(app, "--cluster-folder", cluster.folder, "DIR",
          "folder that the server and all workers see under this absolute path. It belongs to the\n"
          "server's user; other users cannot write it");
  AddSeconds(app, "--cluster-least-seconds", cluster.least_work, 0, kDaySeconds,
             "a job that takes less of one core is computed by this server alone");
  AddSeconds(app, "--cluster-lease-seconds", cluster.lease, 1, kDaySeconds,
             "computing time of a lease, about; longer if there are more than 600 workers");
  AddSeconds(app, "--cluster-timeout-seconds", cluster.timeout, 1, kDaySeconds,
             "a lease is given to another worker if its file does not change for this time");
  AddText(app, "--cluster-worker", cluster.worker, "FILE",
          "the program ballpiston-worker, which the server copies into the folder for Slurm;\n"
          "default: the one installed with the server");
  SlurmOptions& slurm = words.slurm;
  BeginGroup(app, "Slurm, with --executor=slurm");
  AddNumber(app, "--slurm-workers", slurm.workers, 1, kMostSlurmWorkers,
            "workers that wait or run at the same time; each uses one core");
  AddText(app, "--slurm-partition", slurm.partition, "NAME",
          "partition; default: the cluster's default");
  AddText(app, "--slurm-account", slurm.account, "NAME", "account; default: the user's default");
  AddText(app, "--slurm-cluster", slurm.cluster, "NAME",
          "cluster, where a site has several; needs slurmdbd");
  AddNumber(app, "--slurm-time-limit-minutes", slurm.time_limit_minutes, 1, kMostSlurmMinutes,
            "time limit of a worker");
  app.add_option("--slurm-option", slurm.sbatch_options,
                 "one further word for sbatch, such as --slurm-option=--mem-per-cpu=500M; may be\n"
                 "given several times")
      ->type_name("WORD")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  AddNumber(app, "--slurm-max-array-size", slurm.max_array_size, 1, kMostSlurmWorkers,
            "tasks of one job array; less than the cluster's MaxArraySize");
  AddSeconds(app, "--slurm-query-seconds", slurm.query_interval, 1, 3600,
             "time between two queries of Slurm's queue");
}

void AddLimitFlags(CLI::App& app, Limits& limits) {
  BeginGroup(app, "Limits; 0 means no limit");
  const auto add = [&app](const char* flag, auto& limit, const char* description,
                          double least = 0) {
    return AddNumber(app, flag, limit, least, kMostLimit, description, /*permits_zero=*/true);
  };
  add("--max-active-jobs-per-principal", limits.max_active_jobs_per_principal,
      "jobs that have not ended, of one principal");
  add("--max-active-points-per-principal", limits.max_active_points_per_principal,
      "grid points of jobs that have not ended, of one principal");
  add("--max-points-per-job", limits.max_points_per_job,
      "grid points of one job; the engine permits 100,000 at most");
  AddNumber(app, "--max-streams", limits.max_streams, 0, kMostStreams,
            "open watches and traces of all principals; 0 counts as 32768");
  add("--max-streams-per-principal", limits.max_streams_per_principal,
      "open watches and traces of one principal");
  add("--max-memory-mib", limits.max_memory_mib,
      "MiB of memory of all points that this server computes at a time, by an upper bound.\n"
      "By default 80 % of the memory of this machine or of the server's control group")
      ->default_str(kOfThisMachine);
  add("--retain-days", limits.retain_days,
      "days from the end of a job until its results expire, unless it is pinned", kLeastDays);
  add("--max-store-bytes", limits.max_store_bytes,
      "bytes of the store; above 95 % the oldest results of the principal that stores most\n"
      "expire; if it has none left, its oldest expired jobs are deleted",
      kLeastStoreBytes);
}

void AddLogFlags(CLI::App& app, CommandLine& line, Words& words) {
  BeginGroup(app, "Log (on standard error) and metrics");
  AddWord(app, "--log-level", words.log_level, {"info", "warning", "error"},
          "the least severe lines that are written");
  AddText(
      app, "--metrics-listen", line.server.metrics_listen, "ADDRESS",
      "address of Prometheus metrics, at /metrics: HOST:PORT with the host 127.0.0.1, [::1] or\n"
      "localhost (port 0: any free port, which the log names). Default: no metrics");
}

void AddCommands(CLI::App& app, CommandLine& line) {
  BeginGroup(app, "Commands; at most one, instead of a server");
  app.option_defaults()->configurable(false);  // not in the file of --config
  AddText(app, "--new-token", line.new_token, "PRINCIPAL:ROLE[:DAYS]",
          "make a token, append its hash to --access-file and print the token")
      ->needs("--access-file");
  app.add_flag(
      "--check", line.check,
      "check the whole store in --data-dir and print a summary; the exit code is 0 if the\n"
      "store is sound. A server may use the store at the same time");
  AddText(app, "--backup", line.backup, "FILE",
          "copy the store in --data-dir to this file, and check the copy. A server may use the\n"
          "store at the same time");
  app.get_option("--backup")->excludes("--check")->excludes("--new-token");
  app.get_option("--check")->excludes("--new-token");
  app.set_help_flag("-h,--help", "print this page");
  app.set_version_flag("--version", absl::StrCat("ballpistond ", kVersion), "print the version");
}

// ---- parsing ----

// CLI11 would take the next argument for the missing value.
void CheckValues(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    const absl::string_view argument = argv[i];
    if (!absl::StartsWith(argument, "--") || argument.find('=') != argument.size() - 1) continue;
    throw CLI::ValidationError(std::string(argument.substr(0, argument.size() - 1)),
                               "needs a value");
  }
}

// Sets the flags, or `page`.
absl::Status Parse(CLI::App& app, int argc, const char* const* argv, std::string& page) {
  try {
    CheckValues(argc, argv);
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    page = app.help();
  } catch (const CLI::CallForVersion& version) {
    page = absl::StrCat(version.what(), "\n");
  } catch (const CLI::ParseError& error) {
    return absl::InvalidArgumentError(error.what());
  }
  return absl::OkStatus();
}

// ---- combinations of flags ----

absl::Status SetCluster(Words& words, CommandLine& line) {
  const std::string& folder = words.cluster.folder;
  if (words.executor == "threads") {
    if (folder.empty()) return absl::OkStatus();
    return absl::InvalidArgumentError(
        "--cluster-folder needs --executor=folder or --executor=slurm");
  }
  if (!absl::StartsWith(folder, "/")) {
    return absl::InvalidArgumentError(
        absl::StrCat("--cluster-folder: \"", folder,
                     "\" is not an absolute path, which --executor=", words.executor, " needs"));
  }
  line.server.cluster = std::move(words.cluster);
  if (words.executor == "slurm") line.server.slurm = std::move(words.slurm);
  return absl::OkStatus();
}

void SetDefaults(CommandLine& line) {
  constexpr double kShareOfMemory = 0.8;
  line.server.workers = std::min(MachineCores(), kMostWorkers);
  line.server.limits.max_memory_mib =
      static_cast<int64_t>(kShareOfMemory * MachineMemory() / (1 << 20));
}

}  // namespace

absl::StatusOr<CommandLine> ParseCommandLine(int argc, const char* const* argv) {
  CommandLine line;
  Words words;
  SetDefaults(line);
  CLI::App app(kDescription, "ballpistond");
  app.get_formatter()->column_width(kHelpIndentation);
  app.footer(kExitCodes);
  AddServerFlags(app, line);
  AddDoorFlags(app, line.server.door);
  AddClusterFlags(app, words);
  AddLimitFlags(app, line.server.limits);
  AddLogFlags(app, line, words);
  AddCommands(app, line);
  const absl::Status parsed = Parse(app, argc, argv, line.page);
  if (!parsed.ok()) return parsed;
  if (!line.page.empty()) return line;
  line.log_level = words.log_level == "info"      ? Severity::kInfo
                   : words.log_level == "warning" ? Severity::kWarning
                                                  : Severity::kError;
  const absl::Status cluster = SetCluster(words, line);
  if (!cluster.ok()) return cluster;
  return line;
}

}  // namespace ballpiston::server

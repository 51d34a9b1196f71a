#include "server/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <istream>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "server/version.h"

namespace ballpiston::server {
namespace {

constexpr int64_t kMostWorkers = 1024;
constexpr double kMostSeconds = 1e6;
constexpr int64_t kLeastMessage = 1024;
constexpr int64_t kMostMessage = int64_t{256} << 20;
constexpr int64_t kLeastTransferMib = 16;
constexpr int64_t kMostTransferMib = int64_t{1} << 20;

constexpr char kDescription[] =
    "The server of ballpiston: computes ensembles of rarely interacting billiards.";
constexpr char kUsage[] =
    "\nUsage:\n"
    "  ballpistond --listen unix:PATH | --listen 127.0.0.1:PORT [--data-dir DIR] [--workers N]\n"
    "  ballpistond --listen 0.0.0.0:PORT --tls-certificate FILE --tls-key FILE --access-file FILE\n"
    "  ballpistond --access-file FILE --new-token PRINCIPAL:ROLE[:DAYS]\n"
    "  ballpistond --data-dir DIR --check | --backup FILE\n\n";
constexpr char kExitCodes[] =
    "Exit codes: 0 stopped or done; 1 the disk of the store is full or fails, try again; 2 a "
    "wrong\n"
    "flag, an address or a data folder in use, or a store that is not sound; 6 a data folder that\n"
    "is not writable.";

// ---- values ----

// Throws an error that Parse catches. `value` is the text of the command line or the file.
[[noreturn]] void Refuse(const std::string& flag, const std::string& value, const std::string& why,
                         const std::string& permitted) {
  throw CLI::ValidationError(
      absl::StrCat("--", flag, "=", value, " ", why, "; permitted: ", permitted));
}

std::string Text(double number) { return absl::StrFormat("%.15g", number); }
std::string Text(int64_t number) { return absl::StrCat(number); }

template <typename Number>
struct Range {
  Number least;
  Number most;
  std::string text;
};

template <typename Number>
Range<Number> Between(Number least, Number most, const std::string& meaning_of_least = "") {
  const char* const kind = std::is_integral_v<Number> ? "whole numbers from " : "";
  return {least, most, absl::StrCat(kind, Text(least), meaning_of_least, " to ", Text(most))};
}

// The greatest permitted number is the largest finite one.
template <typename Number>
Range<Number> LimitRange() {
  return Between<Number>(0, std::numeric_limits<Number>::max(), " (no limit)");
}

bool Read(const std::string& text, double& number) { return absl::SimpleAtod(text, &number); }

// Accepts 1e6 too. Rejects nan, and numbers like 1e16 beyond 2^53, where a double is not exact.
bool Read(const std::string& text, int64_t& number) {
  if (absl::SimpleAtoi(text, &number)) return true;
  double real = 0;
  if (!absl::SimpleAtod(text, &real) || !(std::fabs(real) <= 0x1p53)) return false;
  number = static_cast<int64_t>(real);
  return static_cast<double>(number) == real;
}

// CLI11 is not used to read numbers: it reads 010 as 8, an empty text as 0, and 1e30 as the
// greatest integer.
template <typename Number>
Number NumberOf(const std::string& flag, const std::string& text, const Range<Number>& range) {
  Number number{};
  if (Read(text, number) && number >= range.least && number <= range.most) return number;
  double any = 0;
  const bool is_number = Read(text, any) && !std::isnan(any);
  Refuse(flag, text, is_number ? "is out of range" : "is not a number", range.text);
}

template <typename Value, typename Number>
void AddNumber(CLI::App& app, const std::string& flag, Value& value, const Range<Number>& range,
               const std::string& description) {
  const auto set = [&value, flag, range](const std::string& text) {
    value = static_cast<Value>(NumberOf(flag, text, range));
  };
  app.add_option_function<std::string>("--" + flag, set, description)
      ->type_name("N")
      ->default_str(Text(Number{value}));
}

void AddSeconds(CLI::App& app, const std::string& flag, std::chrono::milliseconds& time,
                const Range<double>& range, const std::string& description) {
  const auto set = [&time, flag, range](const std::string& text) {
    const double seconds = NumberOf(flag, text, range);
    time = std::chrono::milliseconds(static_cast<int64_t>(std::ceil(1000 * seconds)));
  };
  app.add_option_function<std::string>("--" + flag, set, description)
      ->type_name("SECONDS")
      ->default_str(Text(std::chrono::duration<double>(time).count()));
}

template <typename Value>
using Choices = std::vector<std::pair<std::string, Value>>;

// The first choice is the default.
template <typename Value>
void AddChoice(CLI::App& app, const std::string& flag, Value& value, const Choices<Value>& choices,
               const std::string& description) {
  const auto set = [&value, flag, choices](const std::string& text) {
    const auto chosen = std::find_if(choices.begin(), choices.end(),
                                     [&](const auto& choice) { return choice.first == text; });
    if (chosen != choices.end()) {
      value = chosen->second;
      return;
    }
    const auto name = [](std::string* out, const auto& choice) { out->append(choice.first); };
    Refuse(flag, text, "is unknown", absl::StrJoin(choices, ", ", name));
  };
  app.add_option_function<std::string>("--" + flag, set, description)
      ->type_name("NAME")
      ->default_str(choices.front().first);
}

// ---- the flags, by their groups in --help ----

void BeginGroup(CLI::App& app, const std::string& name) { app.option_defaults()->group(name); }

void AddServerFlags(CLI::App& app, CommandLine& line) {
  BeginGroup(app, "Server");
  app.add_option("--listen", line.server.listen,
                 "address of the API: unix:PATH or HOST:PORT (port 0: any free one). A host that "
                 "other machines can reach needs --tls-certificate, --tls-key and --access-file. "
                 "Default: the Unix socket server.socket in the data folder")
      ->type_name("ADDRESS");
  app.add_option("--data-dir,--data_dir", line.server.data_dir,
                 "folder of jobs and results. It is created if it does not exist; one server at a "
                 "time can use it")
      ->type_name("DIR")
      ->capture_default_str();
  AddNumber(app, "workers", line.server.workers, Between(int64_t{1}, kMostWorkers),
            "threads that compute, 1 to 1024");
  AddSeconds(app, "watch-heartbeat-seconds", line.server.watch.heartbeat, Between(0.01, 3600.0),
             "a watch without news sends a message after this time, 0.01 to 3600");
  AddSeconds(app, "idle-exit-seconds", line.idle_exit, Between(0.0, kMostSeconds),
             "the server stops when no job was active and no call in progress for this time, 0 to "
             "1000000; 0: never");
  AddSeconds(app, "drain-seconds", line.drain, Between(0.0, 3600.0),
             "time for calls in progress to end after SIGTERM or SIGINT, 0 to 3600");
  app.set_config("--config", "",
                 "file of flags, read at the start: a line each, FLAG = VALUE, without the dashes. "
                 "A flag of the command line takes precedence")
      ->type_name("FILE");
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
  app.add_option("--access-file", security.access_file,
                 "who may call; needs TLS. A line for each credential: token sha256:HEX PRINCIPAL "
                 "ROLE [EXPIRES], or certificate COMMON_NAME PRINCIPAL ROLE [EXPIRES]; ROLE is "
                 "read, submit or admin")
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
    {"max-streams", &Limits::max_streams, "open watches and comparisons of all principals"},
    {"max-streams-per-principal", &Limits::max_streams_per_principal,
     "open watches and comparisons of one principal"},
    {"max-calls-per-principal", &Limits::max_calls_per_principal,
     "calls in progress of one principal, without watches and comparisons"},
    {"max-call-bytes-per-principal", &Limits::max_call_bytes_per_principal,
     "bytes of the requests of these calls and of their answers that were not read yet"},
    {"max-transfer-mib", &Limits::max_transfer_mib,
     "MiB for connections and for requests that are being received, of all clients; calls beyond "
     "it are refused. At least 16 and twice --max-message-bytes, at most 1048576"},
};

void AddLimitFlags(CLI::App& app, Limits& limits) {
  BeginGroup(app, "Limits; 0 means no limit");
  for (const LimitFlag& row : kLimitFlags) {
    const auto add = [&]<typename Number>(Number Limits::*limit) {
      AddNumber(app, row.flag, limits.*limit, LimitRange<Number>(), row.description);
    };
    std::visit(add, row.limit);
  }
  AddNumber(app, "max-message-bytes", limits.max_message_bytes,
            Between(kLeastMessage, kMostMessage),
            "bytes of one request, 1024 to 268435456; always limited");
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
                 "0: any free one, which the log names). Default: no metrics")
      ->type_name("ADDRESS");
}

void AddCommands(CLI::App& app, CommandLine& line, std::string& new_token) {
  BeginGroup(app, "Commands; at most one, instead of a server");
  app.option_defaults()->configurable(false);
  app.add_option("--new-token", new_token,
                 "make a token, append its hash to --access-file and print the token")
      ->type_name("PRINCIPAL:ROLE[:DAYS]");
  app.add_flag("--check", line.check,
               "check all of the store in --data-dir and print a summary; the exit code is 0 if "
               "the store is sound. A server may use it at the same time");
  app.add_option("--backup", line.backup,
                 "copy the store in --data-dir to this file, and check the copy. A server may use "
                 "the store at the same time")
      ->type_name("FILE");
  // trigger_on_parse: --help prints the help even if another flag is wrong.
  app.add_flag_callback(
         "-h,--help", [] { throw CLI::CallForHelp(); }, "print this page")
      ->trigger_on_parse();
  app.set_version_flag("--version", absl::StrCat("ballpistond ", kVersion), "print the version")
      ->trigger_on_parse();
}

// ---- help ----

// `text` with line breaks between words, so that no line is longer than `width` if words permit.
std::string Wrapped(const std::string& text, size_t width) {
  std::string lines;
  size_t column = 0;
  for (const std::string& word : std::vector<std::string>(absl::StrSplit(text, ' '))) {
    const bool fits = column + 1 + word.size() <= width;
    if (column > 0) lines += fits ? ' ' : '\n';
    column = (column > 0 && fits ? column + 1 : 0) + word.size();
    lines += word;
  }
  return lines;
}

// Prints each flag on a line of its own and its description below it. CLI11's default layout has
// two columns, which are too narrow for long names and long descriptions.
class HelpPage : public CLI::Formatter {
 public:
  HelpPage() { column_width(kIndentation); }

  std::string make_usage(const CLI::App*, std::string) const override { return kUsage; }
  // Removes the second of two blank lines between groups.
  std::string make_group(std::string name, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    return Formatter::make_group(std::move(name), is_positional, std::move(options)).substr(1);
  }
  std::string make_option_opts(const CLI::Option* option) const override {
    return option->get_items_expected_max() == 0 ? "" : absl::StrCat(" ", option->get_type_name());
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    const std::string value = option->get_default_str();
    const std::string text = value.empty() ? "" : absl::StrCat("; default: ", value);
    return Wrapped(option->get_description() + text, kWidth - kIndentation);
  }

 private:
  static constexpr size_t kIndentation = 8;
  static constexpr size_t kWidth = 96;
};

// ---- the file of --config ----

// The error for an unknown flag. `flag` is its name without dashes.
std::string NoSuchFlag(const CLI::App& app, const std::string& flag, const std::string& written) {
  const std::string dashed = "--" + absl::StrReplaceAll(flag, {{"_", "-"}});
  const bool is_known = app.get_option_no_throw(dashed) != nullptr;
  return absl::StrCat(written, " is not a flag; ",
                      is_known ? absl::StrCat("it is spelled ", dashed) : "--help lists them");
}

// Reads lines FLAG = VALUE or FLAG = "VALUE", and comments, which begin with #. CLI11's own reader
// is not used: it reads [::1]:50051 as the beginning of a list, cuts "a#b" at the #, and ignores
// the second value of a key.
class FlagFile : public CLI::Config {
 public:
  explicit FlagFile(const CLI::App& app) : app_(app) {}

  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::vector<CLI::ConfigItem> items;
    std::set<const CLI::Option*> given;
    int number = 0;
    for (std::string line; std::getline(input, line);) {
      ++number;
      absl::StripAsciiWhitespace(&line);
      if (line.empty() || line.front() == '#') continue;
      CLI::ConfigItem item = ItemOf(line, number);
      if (!given.insert(app_.get_option("--" + item.name)).second) {
        throw Error(number, absl::StrCat(item.name, " is given twice"));
      }
      items.push_back(std::move(item));
    }
    return items;
  }

  std::string to_config(const CLI::App*, bool, bool, std::string) const override { return ""; }

 private:
  CLI::ConfigItem ItemOf(const std::string& line, int number) const {
    const std::vector<std::string> parts = absl::StrSplit(line, absl::MaxSplits('=', 1));
    CLI::ConfigItem item;
    item.name = std::string(absl::StripAsciiWhitespace(parts.front()));
    const CLI::Option* flag = app_.get_option_no_throw("--" + item.name);
    if (flag == nullptr) throw Error(number, NoSuchFlag(app_, item.name, item.name));
    if (!flag->get_configurable()) {
      throw Error(number, item.name + " is permitted on the command line only");
    }
    const auto value = parts.size() == 2 ? ValueOf(parts[1]) : std::nullopt;
    if (!value) throw Error(number, absl::StrCat("write ", item.name, " = \"VALUE\""));
    item.inputs = {*value};
    return item;
  }

  // `text` is VALUE or "VALUE", optionally followed by a comment.
  static std::optional<std::string> ValueOf(const std::string& text) {
    const std::string value(absl::StripAsciiWhitespace(text));
    if (!absl::StartsWith(value, "\"")) {
      return std::string(absl::StripAsciiWhitespace(value.substr(0, value.find('#'))));
    }
    const size_t end = value.find('"', 1);
    if (end == std::string::npos) return std::nullopt;
    const std::string rest(absl::StripAsciiWhitespace(value.substr(end + 1)));
    if (!rest.empty() && rest.front() != '#') return std::nullopt;
    return value.substr(1, end - 1);
  }

  CLI::ConfigError Error(int line, const std::string& what) const {
    const auto path = app_.get_config_ptr()->as<std::string>();
    return CLI::ConfigError(absl::StrCat("--config=", path, ", line ", line, ": ", what));
  }

  const CLI::App& app_;
};

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

// Sets the flags; for --help and --version sets `page` instead.
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
  return absl::OkStatus();
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

absl::Status CheckOneCommand(const CommandLine& line, const std::string& new_token) {
  std::vector<std::string> given;
  if (line.check) given.push_back("--check");
  if (!line.backup.empty()) given.push_back("--backup");
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

}  // namespace

absl::StatusOr<CommandLine> ParseCommandLine(int argc, const char* const* argv) {
  CommandLine line;
  line.server.workers = DefaultWorkers();
  std::string new_token;
  CLI::App app(kDescription, "ballpistond");
  app.set_help_flag();  // removes CLI11's; AddCommands adds one as the last group
  app.footer(kExitCodes);
  app.formatter(std::make_shared<HelpPage>());
  app.config_formatter(std::make_shared<FlagFile>(app));
  AddServerFlags(app, line);
  AddSecurityFlags(app, line.server.security);
  AddLimitFlags(app, line.server.limits);
  AddLogFlags(app, line);
  AddCommands(app, line, new_token);
  absl::Status parsed = Parse(app, Arguments(argc, argv), line.page);
  if (!parsed.ok()) return parsed;
  if (!line.page.empty()) return line;
  for (const absl::Status& status :
       {CheckTransfer(line.server.limits), CheckOneCommand(line, new_token),
        SetNewToken(new_token, line)}) {
    if (!status.ok()) return status;
  }
  return line;
}

}  // namespace ballpiston::server

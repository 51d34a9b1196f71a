#include "tests/support/server_process.h"

#include <system_error>

#include "tests/support/preamble.h"

namespace ballpiston {
namespace {

constexpr char kReady[] = "listening on ";

}  // namespace

std::map<std::string, std::string> CleanEnvironment(const TemporaryFolder& home) {
  return {{"HOME", home.path()},         {"XDG_STATE_HOME", ""},
          {"BALLPISTON_SERVER", ""},     {"BALLPISTON_CA", ""},
          {"BALLPISTON_TLS", ""},        {"BALLPISTON_TOKEN", ""},
          {"BALLPISTON_TOKEN_FILE", ""}, {"BALLPISTON_SERVER_PROGRAM", ""},
          {"BALLPISTON_FAILPOINT", ""},  {"XDG_CONFIG_HOME", ""},
          {"BALLPISTON_CONFIG", ""},     {"BALLPISTON_PROGRESS", ""},
          {"BALLPISTON_QUIET", ""},      {"BALLPISTON_VERBOSE", ""}};
}

ProcessOptions ServerCommand(const TemporaryFolder& home, std::vector<std::string> flags) {
  flags.insert(flags.begin(), ServerProgram());
  return {.command = std::move(flags), .environment = CleanEnvironment(home)};
}

ProcessResult RunServer(const TemporaryFolder& home, std::vector<std::string> flags) {
  return RunProgram(ServerCommand(home, std::move(flags)));
}

ServerProcess::ServerProcess(ServerSetUp set_up)
    : set_up_(std::move(set_up)),
      address_(set_up_.listen.empty() ? "unix:" + folder_.File("socket") : set_up_.listen) {}

void ServerProcess::Spawn(const std::string& failpoint) {
  std::vector<std::string> flags = {"--listen", address_,    "--data_dir",
                                    data_dir(), "--workers", std::to_string(set_up_.workers)};
  flags.insert(flags.end(), set_up_.flags.begin(), set_up_.flags.end());
  ProcessOptions options = ServerCommand(folder_, std::move(flags));
  options.command.insert(options.command.begin(), set_up_.launcher.begin(), set_up_.launcher.end());
  options.environment["BALLPISTON_FAILPOINT"] = failpoint;
  ended_log_ = log();
  process_ = std::make_unique<Process>(options);
}

bool ServerProcess::AwaitReady() {
  const std::string line = process_->WaitForErrLine(
      [](const std::string& text) { return text.find(kReady) != std::string::npos; });
  if (line.empty()) return false;
  if (!set_up_.listen.empty()) address_ = line.substr(line.rfind(' ') + 1);
  return true;
}

void ServerProcess::Start() {
  Spawn();
  if (!AwaitReady()) throw std::runtime_error("the server did not start: " + log());
}

std::optional<int> ServerProcess::AwaitEnd(std::chrono::milliseconds limit) {
  if (!process_->EndsWithin(limit)) return std::nullopt;
  return AwaitEnd();
}

int ServerProcess::AwaitEnd() { return process_->Wait().exit_code; }

int ServerProcess::Stop() {
  Signal(SIGTERM);
  return AwaitEnd();
}

void ServerProcess::KillHard() {
  Signal(SIGKILL);
  AwaitEnd();
}

std::string ServerProcess::log() const {
  return process_ == nullptr ? "" : ended_log_ + process_->Output();
}

double ServerProcess::ResidentMiB() const {
  return MiBOf(std::to_string(process_->pid()), "VmRSS:");
}

double ServerProcess::PeakMiB() const { return MiBOf(std::to_string(process_->pid()), "VmHWM:"); }

double ServerProcess::ProcessorSeconds() const {
  double nanoseconds = 0;
  const std::string tasks = "/proc/" + std::to_string(process_->pid()) + "/task";
  std::error_code gone;  // a thread that ends meanwhile
  for (const auto& task : std::filesystem::directory_iterator(tasks, gone)) {
    double ran = 0;
    std::ifstream(task.path() / "schedstat") >> ran;
    nanoseconds += ran;
  }
  return 1e-9 * nanoseconds;
}

}  // namespace ballpiston

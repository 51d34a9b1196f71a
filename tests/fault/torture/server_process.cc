#include "tests/fault/torture/server_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace ballpiston::torture {
namespace {

constexpr int kLookMilliseconds = 2;

std::vector<char*> Pointers(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

// The test's own, with the failpoint.
std::vector<std::string> Environment(const std::string& failpoint) {
  std::vector<std::string> variables;
  for (char** entry = environ; *entry != nullptr; ++entry) variables.emplace_back(*entry);
  if (!failpoint.empty()) variables.push_back("BALLPISTON_FAILPOINT=" + failpoint);
  return variables;
}

pid_t SpawnWithLog(std::vector<std::string> command, std::vector<std::string> environment,
                   const std::string& log) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, log.c_str(),
                                   O_WRONLY | O_CREAT | O_APPEND, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  pid_t pid = 0;
  const int error = posix_spawn(&pid, command[0].c_str(), &actions, nullptr,
                                Pointers(command).data(), Pointers(environment).data());
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::runtime_error("cannot start " + command[0]);
  return pid;
}

std::string TextOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

int RunMortal(char** command) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  execv(command[0], command);
  return 127;
}

ServerProcess::ServerProcess(ServerSetUp set_up) : set_up_(std::move(set_up)) {
  std::string pattern = (std::filesystem::temp_directory_path() / "torture_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no folder at " + pattern);
  folder_ = pattern;
}

ServerProcess::~ServerProcess() {
  if (pid_file_ >= 0) KillHard();
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void ServerProcess::Spawn(const std::string& failpoint) {
  std::vector<std::string> command = {
      "/proc/self/exe", kMortal,     BALLPISTON_SERVER_BINARY,
      "--listen",       address(),   "--data-dir",
      data_dir(),       "--workers", std::to_string(set_up_.workers)};
  command.insert(command.end(), set_up_.flags.begin(), set_up_.flags.end());
  log_start_ = log().size();
  pid_ = SpawnWithLog(std::move(command), Environment(failpoint), folder_ + "/log");
  pid_file_ = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  if (pid_file_ < 0) throw std::runtime_error("pidfd_open failed");
}

bool ServerProcess::HasListened() const {
  return log().find("listening on", log_start_) != std::string::npos;
}

bool ServerProcess::AwaitReady() {
  while (!HasListened()) {
    if (AwaitEnd(std::chrono::milliseconds(kLookMilliseconds))) return false;
  }
  HurryConnections();
  return true;
}

// gRPC would go on waiting after its last attempt that failed.
void ServerProcess::HurryConnections() {
  const std::lock_guard lock(mutex_);
  for (const std::weak_ptr<grpc::Channel>& channel : channels_) {
    const auto living = channel.lock();
    if (living) grpc::experimental::ChannelResetConnectionBackoff(living.get());
  }
}

void ServerProcess::Start() {
  Spawn();
  if (!AwaitReady()) throw std::runtime_error("the server did not start: " + log());
}

void ServerProcess::Signal(int signal) const { kill(pid_, signal); }

std::optional<int> ServerProcess::AwaitEnd(std::chrono::milliseconds limit) {
  if (pid_file_ < 0) return exit_code_;
  pollfd ended{pid_file_, POLLIN, 0};
  if (poll(&ended, 1, static_cast<int>(limit.count())) == 0) return std::nullopt;
  return AwaitEnd();
}

int ServerProcess::AwaitEnd() {
  if (pid_file_ < 0) return exit_code_;
  int status = 0;
  waitpid(pid_, &status, 0);
  close(std::exchange(pid_file_, -1));
  exit_code_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return exit_code_;
}

void ServerProcess::KillHard() {
  if (pid_file_ >= 0) Signal(SIGKILL);
  AwaitEnd();
}

std::string ServerProcess::address() const { return "unix:" + folder_ + "/socket"; }

std::string ServerProcess::log() const { return TextOf(folder_ + "/log"); }

double ServerProcess::ResidentMiB() const {
  std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
  for (std::string word; status >> word;) {
    double kib = 0;
    if (word == "VmRSS:" && status >> kib) return kib / 1024;
  }
  return 0;
}

double ServerProcess::ProcessorSeconds() const {
  double nanoseconds = 0;
  const std::string tasks = "/proc/" + std::to_string(pid_) + "/task";
  std::error_code gone;  // a thread that ends meanwhile
  for (const auto& task : std::filesystem::directory_iterator(tasks, gone)) {
    double ran = 0;
    std::ifstream(task.path() / "schedstat") >> ran;
    nanoseconds += ran;
  }
  return 1e-9 * nanoseconds;
}

std::shared_ptr<grpc::Channel> ServerProcess::Connect(grpc::ChannelArguments arguments) {
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 200);
  auto channel =
      grpc::CreateCustomChannel(address(), grpc::InsecureChannelCredentials(), arguments);
  const std::lock_guard lock(mutex_);
  channels_.push_back(channel);
  return channel;
}

}  // namespace ballpiston::torture

// The real server, ballpistond, as a process: started, killed and started again on one data folder.
#pragma once

#include "tests/support/preamble.h"
#include "tests/support/process.h"

namespace ballpiston {

// An environment with `home` as HOME, so that programs do not use the user's files, and without the
// project's variables.
std::map<std::string, std::string> CleanEnvironment(const TemporaryFolder& home);

// `ballpistond FLAGS...`
ProcessOptions ServerCommand(const TemporaryFolder& home, std::vector<std::string> flags);

// Runs the server program until it exits: with flags that it rejects, or with --check, --backup
// etc.
ProcessResult RunServer(const TemporaryFolder& home, std::vector<std::string> flags);

struct ServerSetUp {
  int workers = 2;
  std::vector<std::string> flags = {};     // beside --listen, --data-dir and --workers
  std::string listen = {};                 // empty: a Unix socket in the server's folder
  std::vector<std::string> launcher = {};  // a command that runs the server's command line
};

// One thread starts and stops the server. While it does neither, others may use the const
// functions.
class ServerProcess {
 public:
  explicit ServerProcess(ServerSetUp set_up = {});  // does not start the server
  ~ServerProcess() = default;                       // kills the server
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  void Start();  // returns when the server listens; throws std::runtime_error if it ends instead
  void Spawn(const std::string& failpoint = "");  // NAME:N of server/status/failpoint.h
  bool AwaitReady();                              // false if the server ended instead

  void Signal(int signal) const { process_->Signal(signal); }
  bool AwaitLog(const std::string& text) { return process_->WaitForErr(text); }
  // The exit code, or 128 + signal if a signal killed the server. Empty if it still runs after
  // `limit`.
  std::optional<int> AwaitEnd(std::chrono::milliseconds limit);
  int AwaitEnd();
  int Stop();  // SIGTERM
  void KillHard();

  const std::string& address() const { return address_; }  // with a TCP port once it is ready
  std::string data_dir() const { return folder_.File("data"); }
  const TemporaryFolder& folder() const { return folder_; }
  std::string log() const;  // the logs of all its processes

  double ResidentMiB() const;
  double PeakMiB() const;
  double ProcessorSeconds() const;  // of the living threads

 private:
  const ServerSetUp set_up_;
  const TemporaryFolder folder_;
  std::string address_;
  std::string ended_log_;  // the logs of the earlier processes
  std::unique_ptr<Process> process_;
};

}  // namespace ballpiston

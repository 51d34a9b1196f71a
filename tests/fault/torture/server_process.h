// The real server as a process on a Unix socket: started, killed and started again on one folder.
#ifndef BALLPISTON_TESTS_FAULT_TORTURE_SERVER_PROCESS_H_
#define BALLPISTON_TESTS_FAULT_TORTURE_SERVER_PROCESS_H_

#include <grpcpp/grpcpp.h>
#include <sys/types.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace ballpiston::torture {

// The first argument of this program as a server's launcher: the rest is the server's command. The
// server becomes one that dies with the thread that started it, as when a test is killed.
inline constexpr char kMortal[] = "--mortal";
int RunMortal(char** command);

struct ServerSetUp {
  int workers = 2;
  std::vector<std::string> flags = {};  // further ones
};

// One thread at a time starts and stops; address, pid and what is measured are anybody's.
class ServerProcess {
 public:
  explicit ServerProcess(ServerSetUp set_up = {});  // not started yet
  ~ServerProcess();                                 // killed, its folder removed
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  void Spawn(const std::string& failpoint = "");  // NAME:N, or none
  bool AwaitReady();                              // false if it ended instead
  void Start();                                   // both; throws if it ends

  void Signal(int signal) const;
  // Its exit code, 128 + signal if one killed it; empty if it still runs after `limit`.
  std::optional<int> AwaitEnd(std::chrono::milliseconds limit);
  int AwaitEnd();  // again and again the same, until the next Spawn
  void KillHard();

  std::string address() const;
  std::string data_dir() const { return folder_ + "/data"; }
  std::string log() const;  // all that its processes wrote
  pid_t pid() const { return pid_; }

  double ResidentMiB() const;
  double ProcessorSeconds() const;  // of its living threads

  // With a connection of its own, even beside others to the same server, and made anew as soon as
  // the server is ready again.
  std::shared_ptr<grpc::Channel> Connect(grpc::ChannelArguments arguments = {});

 private:
  bool HasListened() const;
  void HurryConnections();

  const ServerSetUp set_up_;
  std::string folder_;
  pid_t pid_ = 0;
  int pid_file_ = -1;     // of pidfd_open; -1: not running
  int exit_code_ = -1;    // of the last one that ended
  size_t log_start_ = 0;  // of this process in the log
  std::mutex mutex_;
  std::vector<std::weak_ptr<grpc::Channel>> channels_;
};

}  // namespace ballpiston::torture

#endif  // BALLPISTON_TESTS_FAULT_TORTURE_SERVER_PROCESS_H_

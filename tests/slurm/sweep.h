// A Slurm cluster of two nodes on this machine; and a real server with this cluster, and one job
// that is large enough for it.
#pragma once

#include <cstdio>

#include "tests/end_to_end/programs.h"

namespace ballpiston {

// By scripts/test-cluster.sh, which says what its verbs do.
class Cluster {
 public:
  // `parameters`: lines of slurm.conf, as NAME=VALUE. Throws std::runtime_error if it does not
  // start.
  explicit Cluster(const std::vector<std::string>& parameters = {});
  ~Cluster() = default;  // stops the cluster; so does the end of this process, whatever ends it

  // A verb of the script, such as Do("kill-node", "n1"). Throws std::runtime_error if it fails.
  void Do(const std::string& verb, const std::string& node = "") const;

  // sbatch, squeue and so on.
  ProcessResult Tool(std::vector<std::string> words) const;
  // Lines of squeue: tasks of all users and jobs that wait or run.
  std::vector<std::string> Queue() const;

  std::string conf() const { return folder_.File("cluster/slurm.conf"); }
  const TemporaryFolder& folder() const { return folder_; }

 private:
  struct Stop {
    void operator()(std::FILE* pipe) const { pclose(pipe); }
  };

  const TemporaryFolder folder_;
  // A shell that waits for the end of this pipe, and then stops the cluster.
  std::unique_ptr<std::FILE, Stop> keeper_;
};

// Sixteen points; a million samples of each take 20 s of one core.
inline constexpr int kPoints = 16;
Words SweepOf(int samples, int seed = 11);

struct ClusterCounts {
  std::string problem;
  double leases = 0;
  double chunks = 0, lost = 0, refused = 0;
};

struct SweepSetUp {
  Words cluster = {};  // lines of slurm.conf
  Words flags = {};    // of the server
  int lease_seconds = 3;
  int timeout_seconds = 10;  // of a lease
  int samples = 1'000'000;
  int workers = 1;
};

class Sweep {
 public:
  explicit Sweep(SweepSetUp set_up = {});  // the cluster and the server run
  ~Sweep();                                // prints the server's log if the test failed

  const Cluster& cluster() const { return cluster_; }
  TestServer& server() { return *server_; }
  std::string shared_folder() const { return cluster_.folder().File("shared"); }

  void Submit();
  const std::string& job() const { return job_; }
  ClusterCounts Counts() const;
  void AwaitTasks() const;         // until the cluster has tasks of this server
  void AwaitRunningTasks() const;  // until workers run
  void AwaitTakenLease() const;    // until a worker has a lease
  void AwaitProblem(const std::string& text) const;
  std::vector<pid_t> Workers() const;  // that compute
  void KillServer();                   // kill -9, and starts it again on the same data folder

  // Waits for the end. The test fails unless the job succeeded, each point has the number of
  // samples that was asked for, and the bytes are those of a server that has threads alone.
  void ExpectTheSameBytes();

 private:
  const SweepSetUp set_up_;
  const Cluster cluster_;
  std::unique_ptr<TestServer> server_;
  std::string job_;
};

}  // namespace ballpiston

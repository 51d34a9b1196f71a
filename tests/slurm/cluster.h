// A Slurm cluster of two nodes on this machine, by scripts/test-cluster.sh. The script says what
// its verbs do.
#pragma once

#include <sys/types.h>

#include <cstdio>

#include "tests/support/preamble.h"
#include "tests/support/process.h"

namespace ballpiston {

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

// The processes whose command line contains the text.
std::vector<pid_t> ProcessesWith(const std::string& text);

}  // namespace ballpiston

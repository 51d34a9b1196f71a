// Programs in the place of sbatch, squeue and scancel, for tests without Slurm. Each task of an
// array becomes a process on this machine at once, and runs on when the server is killed.
#pragma once

#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace ballpiston {

class StandInSlurm {
 public:
  StandInSlurm();
  ~StandInSlurm();  // ends all tasks
  StandInSlurm(const StandInSlurm&) = delete;
  StandInSlurm& operator=(const StandInSlurm&) = delete;

  // The words before a server's command line, so that it finds the programs.
  std::vector<std::string> Launcher() const;
  std::string shared_folder() const { return folder_.File("shared"); }
  // The number of tasks that were started so far.
  int tasks() const;

 private:
  const TemporaryFolder folder_;
};

}  // namespace ballpiston

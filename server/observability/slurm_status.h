// The work that the server has handed to a Slurm cluster, at one moment.
#pragma once

#include <string>

namespace ballpiston::server {

struct SlurmStatus {
  std::string problem;  // empty: none
  double waiting_tasks = 0;
  double running_tasks = 0;
  double submitted_tasks = 0;  // and not seen in the queue yet
  // Since the start.
  double chunks = 0;
  double lost_tasks = 0;
  double refused_files = 0;
  double queries = 0;
};

}  // namespace ballpiston::server

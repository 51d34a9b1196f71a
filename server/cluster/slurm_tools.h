// Slurm's command-line tools: sbatch, squeue and scancel.
//
// Slurm says when and where a task runs. It proves nothing: acknowledged jobs were lost when
// slurmctld was killed, and a submission that timed out may have succeeded. Thread-safe.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "server/cluster/slurm_queue.h"

namespace ballpiston::server {

struct SlurmOptions {
  std::string shared_folder;
  std::string partition = {};  // these three are empty for the cluster's defaults
  std::string account = {};
  std::string cluster = {};
  int64_t time_limit_minutes = 60;
  std::vector<std::string> sbatch_options = {};    // further words for sbatch
  std::string worker = {};                         // the program; empty: InstalledWorker
  size_t max_tasks = 1000;                         // submitted and not ended
  size_t max_array_size = 1000;                    // Slurm's MaxArraySize, less one
  std::chrono::milliseconds task_length{180'000};  // of computing, about
  std::chrono::milliseconds least_work{60'000};    // a run with less to compute stays here
  std::chrono::milliseconds query_interval{30'000};
  std::chrono::milliseconds collect_interval{1'000};  // between looks for files with chunks
};

// A job array.
struct ArraySubmission {
  std::string name;
  size_t tasks = 0;
  std::string folder;                // for the tasks' logs
  std::vector<std::string> command;  // of a task; its index is $SLURM_ARRAY_TASK_ID
};

class SlurmTools {
 public:
  explicit SlurmTools(const SlurmOptions& options) : options_(options) {}
  virtual ~SlurmTools() = default;

  // OK: Slurm has accepted the array. UNKNOWN: Slurm may have accepted it; the next Query shows it.
  // Any other error: Slurm has rejected it, and the message is Slurm's own.
  virtual absl::Status Submit(const ArraySubmission& array, const std::stop_token& stop);

  // All arrays of this user that have tasks left, whose names have the prefix.
  virtual absl::StatusOr<std::map<std::string, QueuedArray>> Query(absl::string_view prefix,
                                                                   const std::stop_token& stop);

  // Cancels the whole array, or some of its tasks; then `id` is the array's number in a recent
  // Query.
  virtual absl::Status Cancel(const std::string& name, const std::stop_token& stop);
  virtual absl::Status CancelTasks(const std::string& name, const std::string& id,
                                   const std::set<size_t>& tasks, const std::stop_token& stop);

 private:
  std::vector<std::string> Words(absl::string_view tool) const;

  const SlurmOptions options_;
};

// This process's environment without the variables that change what the tools do, and with
// SLURM_BITSTR_LEN=0, or squeue would cut lists of indices.
std::vector<std::string> SlurmEnvironment();

}  // namespace ballpiston::server

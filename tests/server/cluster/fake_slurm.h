// A Slurm cluster in the test's process. It starts, runs, loses and kills tasks when the test says
// so. It outlives the executors that use it. Thread-safe.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/cluster/slurm_tools.h"
#include "server/worker/task_file.h"
#include "server/worker/task_run.h"

namespace ballpiston::server {

class FakeSlurm {
 public:
  std::unique_ptr<SlurmTools> Tools(const SlurmOptions& options);

  // ---- how it behaves from now on ----

  // Sets the status that a submission returns. Slurm accepts the array if `accepts`, also with an
  // error.
  void Answer(const absl::Status& submission, bool accepts);
  void AnswerQuery(const absl::Status& query);
  void SetReason(const std::string& reason);  // why tasks wait
  void SetMemory(double bytes);               // that a task may use

  // ---- what the test does ----

  void Add(const std::string& name, size_t tasks);   // an array that this server did not submit
  void Start(const std::string& name, size_t task);  // the task runs and has left no file yet
  // The task has ended, whatever its files say. Returns the number of queries until then. Without
  // an index, all tasks of all arrays.
  size_t Lose(const std::string& name, size_t task);
  void LoseAll();
  // Computes the task as ballpiston-worker does, and ends it.
  absl::Status Run(const std::string& name, size_t task);
  void RunAll();

  // ---- what it has seen ----

  std::vector<ArraySubmission> submissions() const;  // also refused ones
  std::vector<std::string> cancelled() const;        // names; or NAME_[INDICES]
  size_t queries() const;                            // their number
  size_t QueriesBeforeSubmission(size_t index) const;
  std::map<std::string, std::set<size_t>> queue() const;  // names and tasks that have not ended

 private:
  class FakeTools;
  struct Array {
    std::string id;
    std::string folder;
    std::set<size_t> waiting = {}, running = {};
  };

  void End(const std::string& name, size_t task);  // requires the lock

  mutable std::mutex mutex_;
  absl::Status submission_, query_;
  bool accepts_ = true;
  std::string reason_ = "Priority";
  double memory_ = TaskRunOptions().memory;
  int last_id_ = 0;
  std::map<std::string, Array> arrays_;
  std::vector<ArraySubmission> submissions_;
  std::vector<std::string> cancelled_;
  size_t queries_ = 0;
  std::vector<size_t> queries_before_;  // each submission
};

// The task of an array in this folder, as the server wrote it.
absl::StatusOr<ArrayTask> TaskIn(const std::string& folder, size_t task);

}  // namespace ballpiston::server

#include "tests/server/cluster/fake_slurm.h"

#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"
#include "server/cluster/shared_folder.h"
#include "server/worker/task_run.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {

class FakeSlurm::FakeTools : public SlurmTools {
 public:
  FakeTools(const SlurmOptions& options, FakeSlurm& slurm) : SlurmTools(options), slurm_(slurm) {}

  absl::Status Submit(const ArraySubmission& array, const std::stop_token&) override {
    std::lock_guard lock(slurm_.mutex_);
    slurm_.submissions_.push_back(array);
    slurm_.queries_before_.push_back(slurm_.queries_);
    if (!slurm_.accepts_) return slurm_.submission_;
    Array& taken = slurm_.arrays_[array.name];
    taken = Array();
    taken.id = absl::StrCat(++slurm_.last_id_);
    taken.folder = array.folder;
    for (size_t i = 0; i < array.tasks; ++i) taken.waiting.insert(i);
    return slurm_.submission_;
  }

  absl::StatusOr<std::map<std::string, QueuedArray>> Query(absl::string_view prefix,
                                                           const std::stop_token&) override {
    std::lock_guard lock(slurm_.mutex_);
    ++slurm_.queries_;
    if (!slurm_.query_.ok()) return slurm_.query_;
    std::map<std::string, QueuedArray> queue;
    for (const auto& [name, array] : slurm_.arrays_) {
      if (!absl::StartsWith(name, prefix)) continue;
      QueuedArray& queued = queue[name];
      queued.id = array.id;
      queued.waiting = array.waiting;
      queued.running = array.running;
      if (!array.waiting.empty()) queued.reasons.insert(slurm_.reason_);
    }
    return queue;
  }

  absl::Status Cancel(const std::string& name, const std::stop_token&) override {
    std::lock_guard lock(slurm_.mutex_);
    slurm_.cancelled_.push_back(name);
    slurm_.arrays_.erase(name);
    return absl::OkStatus();
  }

  absl::Status CancelTasks(const std::string& name, const std::string& id,
                           const std::set<size_t>& tasks, const std::stop_token&) override {
    std::lock_guard lock(slurm_.mutex_);
    slurm_.cancelled_.push_back(absl::StrCat(name, "_[", IndicesText(tasks), "]"));
    const auto found = slurm_.arrays_.find(name);
    if (found == slurm_.arrays_.end() || found->second.id != id) return absl::OkStatus();
    for (const size_t task : tasks) slurm_.End(name, task);
    return absl::OkStatus();
  }

 private:
  FakeSlurm& slurm_;
};

std::unique_ptr<SlurmTools> FakeSlurm::Tools(const SlurmOptions& options) {
  return std::make_unique<FakeTools>(options, *this);
}

void FakeSlurm::Answer(const absl::Status& submission, bool accepts) {
  std::lock_guard lock(mutex_);
  submission_ = submission;
  accepts_ = accepts;
}

void FakeSlurm::AnswerQuery(const absl::Status& query) {
  std::lock_guard lock(mutex_);
  query_ = query;
}

void FakeSlurm::SetReason(const std::string& reason) {
  std::lock_guard lock(mutex_);
  reason_ = reason;
}

void FakeSlurm::Add(const std::string& name, size_t tasks) {
  std::lock_guard lock(mutex_);
  Array& array = arrays_[name];
  array.id = absl::StrCat(++last_id_);
  for (size_t i = 0; i < tasks; ++i) array.waiting.insert(i);
}

void FakeSlurm::Start(const std::string& name, size_t task) {
  std::lock_guard lock(mutex_);
  Array& array = arrays_.at(name);
  array.waiting.erase(task);
  array.running.insert(task);
}

void FakeSlurm::End(const std::string& name, size_t task) {
  const auto found = arrays_.find(name);
  if (found == arrays_.end()) return;
  found->second.waiting.erase(task);
  found->second.running.erase(task);
  if (found->second.waiting.empty() && found->second.running.empty()) arrays_.erase(found);
}

void FakeSlurm::SetMemory(double bytes) {
  std::lock_guard lock(mutex_);
  memory_ = bytes;
}

size_t FakeSlurm::Lose(const std::string& name, size_t task) {
  std::lock_guard lock(mutex_);
  End(name, task);
  return queries_;
}

void FakeSlurm::LoseAll() {
  std::lock_guard lock(mutex_);
  arrays_.clear();
}

absl::Status FakeSlurm::Run(const std::string& name, size_t task) {
  TaskRunOptions options = {.retry_seconds = 0, .give_up_seconds = 0};
  {
    std::lock_guard lock(mutex_);
    options.folder = arrays_.at(name).folder;
    options.memory = memory_;
  }
  const absl::StatusOr<ArrayTask> read = TaskIn(options.folder, task);
  const absl::Status run =
      read.ok() ? RunTask(*read, options, std::stop_source(), [](absl::string_view) {})
                : read.status();
  Lose(name, task);
  return run;
}

void FakeSlurm::RunAll() {
  for (const auto& [name, tasks] : queue()) {
    for (const size_t task : tasks) EXPECT_OK(Run(name, task));
  }
}

std::vector<ArraySubmission> FakeSlurm::submissions() const {
  std::lock_guard lock(mutex_);
  return submissions_;
}

std::vector<std::string> FakeSlurm::cancelled() const {
  std::lock_guard lock(mutex_);
  return cancelled_;
}

size_t FakeSlurm::queries() const {
  std::lock_guard lock(mutex_);
  return queries_;
}

size_t FakeSlurm::QueriesBeforeSubmission(size_t index) const {
  std::lock_guard lock(mutex_);
  return queries_before_.at(index);
}

std::map<std::string, std::set<size_t>> FakeSlurm::queue() const {
  std::lock_guard lock(mutex_);
  std::map<std::string, std::set<size_t>> queue;
  for (const auto& [name, array] : arrays_) {
    queue[name] = array.waiting;
    queue[name].insert(array.running.begin(), array.running.end());
  }
  return queue;
}

absl::StatusOr<ArrayTask> TaskIn(const std::string& folder, size_t task) {
  return ReadTask(TaskFileIn(folder), task);
}

}  // namespace ballpiston::server

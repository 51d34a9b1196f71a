#include "server/book/active_jobs.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/sha256.h"

namespace ballpiston::server {

RunName RunOf(const JobRecord& record) {
  const std::string hash = Sha256(absl::StrCat(record.id, " ", record.restarts));
  uint64_t generation = 0;
  for (size_t i = 0; i < 7; ++i) generation = generation << 8 | static_cast<uint8_t>(hash[i]);
  return {record.sequence, static_cast<int64_t>(generation)};
}

std::shared_ptr<Job> ActiveJobs::Add(const JobRecord& record) {
  auto job = std::make_shared<Job>(record);
  MutexLock lock(mutex_);
  jobs_[record.id] = job;
  return job;
}

void ActiveJobs::Remove(const std::string& id) {
  MutexLock lock(mutex_);
  jobs_.erase(id);
}

std::shared_ptr<Job> ActiveJobs::Find(const std::string& id) const {
  MutexLock lock(mutex_);
  const auto found = jobs_.find(id);
  return found == jobs_.end() ? nullptr : found->second;
}

void ActiveJobs::StartRun(const std::shared_ptr<Job>& job, RunRequest request) {
  const JobRecord& row = job->row();
  request.key = row.sequence;
  request.generation = RunOf(row).generation;
  request.principal = row.job.principal();
  request.priority = row.job.priority();
  request.journal = JournalOf(job, request.has_checkpoints);
  scheduler_.Add(std::move(request));
}

std::shared_ptr<JobJournal> ActiveJobs::JournalOf(const std::shared_ptr<Job>& job, bool resumed) {
  return std::make_shared<JobJournal>(job, store_, resumed,
                                      [this](const JobRecord& ended) { OnEnded(ended); });
}

void ActiveJobs::OnEnded(const JobRecord& ended) {
  MutexLock lock(mutex_);
  ++ended_[ended.job.state()];
  jobs_.erase(ended.id);
}

void ActiveJobs::StopWaiting() {
  MutexLock lock(mutex_);
  for (const auto& [id, job] : jobs_) job->StopWaiting();
}

size_t ActiveJobs::size() const {
  MutexLock lock(mutex_);
  return jobs_.size();
}

int64_t ActiveJobs::bytes() const {
  MutexLock lock(mutex_);
  int64_t bytes = 0;
  for (const auto& [id, job] : jobs_) bytes += job->Numbers().bytes;
  return bytes;
}

EndedJobs ActiveJobs::ended() const {
  MutexLock lock(mutex_);
  return ended_;
}

}  // namespace ballpiston::server

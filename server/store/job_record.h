// A row of the jobs table. The row owns the job's state; it changes in committed transactions only
// (job_table.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "ballpiston/v1/ensemble.pb.h"

namespace ballpiston::server {

using JobState = v1::EnsembleJob::State;

inline bool HasEnded(JobState state) {
  return state == v1::EnsembleJob::SUCCEEDED || state == v1::EnsembleJob::FAILED ||
         state == v1::EnsembleJob::CANCELLED;
}

using Labels = std::map<std::string, std::string>;  // key, value; how the owner finds the job again
inline constexpr size_t kMostLabels = 32;           // of a job

// How much of a job is computed.
struct JobNumbers {
  int64_t points_done = 0;  // these are stored
  double samples = 0;
  double work = 0;             // seconds of processor time, in this or the last server process
  int64_t bytes = 0;           // in the store, of the job and its results
  double points_computed = 0;  // with the computed shares of unfinished points

  void Add(const JobNumbers& other) {
    points_done += other.points_done;
    samples += other.samples;
    work += other.work;
    bytes += other.bytes;
    points_computed += other.points_computed;
  }
};

struct JobRecord {
  int64_t sequence = 0;  // assigned by the store; greater for a newer job, never reused
  std::string id;
  // The job as clients see it, without its expire_time. An active job has the numbers from its
  // acceptance; its present numbers are in memory (book/job.h). The specification has no grid if
  // the grid was not read. A damaged row gives a job without a specification.
  v1::EnsembleJob job;
  // The id of the request that made the job, unique for the principal; may be empty. It is written,
  // but not read from the store.
  std::string request_id;
  std::string payload;   // hash of that request without its id and its labels (book/acceptance.h)
  std::string question;  // hash of the question (book/acceptance.h); empty: always compute
  std::string family;    // hash of the question without its target; empty: cannot be continued
  int64_t restarts = 0;  // how often another engine restarted the job
  std::string cancel_request_id;  // of the cancellation, or empty
};

// Without a fraction if a tolerance or a budget ends the points, not a number of samples.
v1::JobProgress ProgressOf(const v1::EnsembleJob& job, const JobNumbers& numbers);

void SetNumbers(const JobNumbers& numbers, v1::EnsembleJob& job);

// The bytes of a job without results in the store, about.
int64_t BytesOfJob(const v1::EnsembleJob& job);

// The job's stored_bytes. 0 if a damaged row has a value that is not a number of bytes.
int64_t StoredBytesOf(const v1::EnsembleJob& job);

// The results of a job that has ended expire after `retain_days`; 0: never.
void SetExpireTime(double retain_days, v1::EnsembleJob& job);

}  // namespace ballpiston::server

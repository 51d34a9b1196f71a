// A row of the jobs table. The row owns the job's state; it changes in committed transactions only
// (job_table.h).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "absl/time/time.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "server/convert/spec.h"

namespace ballpiston::server {

using JobState = v1::EnsembleJob::State;

inline bool HasEnded(JobState state) {
  return state == v1::EnsembleJob::SUCCEEDED || state == v1::EnsembleJob::FAILED ||
         state == v1::EnsembleJob::CANCELLED;
}

// How much of a job is computed.
struct JobNumbers {
  int64_t points_done = 0;  // these are stored
  double samples = 0;
  double work = 0;             // seconds of processor time, in this or the last server process
  int64_t bytes = 0;           // of the specification and the results
  double points_computed = 0;  // with the computed shares of unfinished points; not stored

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
  std::string principal;   // the job's owner
  std::string request_id;  // of the request that made the job, unique for the principal; or empty
  std::string payload;     // hash of that request without its id and its labels (book/acceptance.h)
  int32_t priority = 0;    // among the principal's; higher first
  bool pinned = false;     // its results do not expire
  std::string labels;      // as text (labels.h)
  StoredSpec spec;         // its grid is empty if it was not read
  std::string question;    // hash of the question (book/acceptance.h); empty: always compute
  std::string family;      // hash of the question without its target; empty: cannot be continued
  std::string continues;   // the id of the job whose points this one continues, or empty
  double continued_samples = 0;  // of that job
  JobState state = v1::EnsembleJob::QUEUED;
  absl::Time create_time;
  std::optional<absl::Time> start_time;
  std::optional<absl::Time> end_time;
  std::optional<absl::Time> expired_time;  // its results are gone
  std::string error;                       // serialized google.rpc.Status, empty unless FAILED
  std::string engine_version;
  int64_t restarts = 0;           // how often another engine restarted the job
  std::string cancel_request_id;  // of the cancellation, or empty
  int64_t points = 0;
  JobNumbers numbers;  // of an ended job; of an active job memory has them (book/job.h)
};

}  // namespace ballpiston::server

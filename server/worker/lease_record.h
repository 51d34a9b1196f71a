// Exact conversion between a lease of chunks and its record, which a worker elsewhere gets.
//
// The record has the lease's point as a question: one point, by a sampling model. An experiment
// that is created from the record has the same plan, random numbers and bits as the lease's
// experiment. Pure functions.
//
// A record that can be parsed may still be damaged, or be written by a foreign program. So reading
// checks everything that creating the experiment and merging the blocks require.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "ballpiston/storage/records.pb.h"
#include "core/ensemble/ensemble_spec.h"
#include "server/compute/lease.h"

namespace ballpiston::server {

// The job of a lease, among the jobs of all servers and of all engine versions.
struct JobIdentity {
  std::string server = {};  // the data folder's identity
  int64_t job = 0;          // its sequence in the store
  int64_t generation = 0;   // changes with the job and at a restart by another engine
  std::string engine_version = {};

  friend bool operator==(const JobIdentity&, const JobIdentity&) = default;
};

struct IdentifiedLease {
  JobIdentity job;
  // The spec is a OnePointSpec, `point` is the point's index in the job's grid, and `seconds` is
  // predicted again. The numbers of the lease and of the run are 0.
  Lease lease;
};

// `one_point` is a OnePointSpec by a model that samples, with purpose kAnswer and without a budget.
storage::Question QuestionRecord(const EnsembleSpec& one_point);

// DATA_LOSS with the name of the field, unless the question has no violations.
absl::StatusOr<EnsembleSpec> SpecOfQuestion(const storage::Question& question);

// The lease has chunks of a point, not of a pilot, and its spec has no budget.
storage::Lease LeaseRecord(const Lease& lease, const JobIdentity& job);

// UNIMPLEMENTED with both versions if the lease is of another engine version. DATA_LOSS with
// the name of the field if the question, the chunks or the merged blocks are not possible.
absl::StatusOr<IdentifiedLease> LeaseOfRecord(const storage::Lease& record);

}  // namespace ballpiston::server

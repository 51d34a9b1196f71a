// Exact conversion between a lease of chunks and its record, which a worker elsewhere gets.
//
// The record has the lease's point as a question: one point, by a sampling model. An experiment
// that is created from the record has the same plan, random numbers and bits as the lease's
// experiment. Pure functions.
//
// The file of a lease has a checksum, and the folder belongs to the server's user. So reading
// checks the engine version and the question, but not the chunks and their states.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "ballpiston/storage/records.pb.h"
#include "server/compute/lease.h"

namespace ballpiston::server {

// A lease as its file has it.
struct LeaseFile {
  std::string server;  // the identity of the server's data folder
  // `run` and `generation` name the job, whose engine version is this program's. The spec is a
  // OnePointSpec, and `point` is the point's index in the job's grid. The record does not have the
  // rest, such as numbers and attempts.
  Lease lease;
  double touch_seconds = 20;  // the worker gives the file another time as often as this
};

// The lease has chunks of a point, not of a pilot, and its spec has no budget.
storage::Lease LeaseRecord(const Lease& lease, const std::string& server, double touch_seconds);

// UNIMPLEMENTED with both versions if the lease is of another engine version. DATA_LOSS if this
// engine cannot answer the question.
absl::StatusOr<LeaseFile> LeaseOfRecord(const storage::Lease& record);

}  // namespace ballpiston::server

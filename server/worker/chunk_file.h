// Complete chunks of a lease as a message, which a worker appends to the lease's file. The message
// says for which server, job, engine and point its chunks are.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/ensemble/chunk_fold.h"
#include "server/worker/lease_record.h"

namespace ballpiston::server {

// Complete chunks of one lease.
struct LeaseChunks {
  JobIdentity job = {};
  size_t point = 0;
  int attempt = 1;
  std::vector<ChunkResult> chunks = {};
  double processor_seconds = 0;  // on this lease since the previous message
};

std::string LeaseChunksPayload(const LeaseChunks& chunks);
// DATA_LOSS with the name of the field.
absl::StatusOr<LeaseChunks> LeaseChunksFromPayload(absl::string_view payload);

// DATA_LOSS unless the chunks are of this lease's job and point, lie within the lease, and are
// possible for its experiment. The attempt may be another one: the bits are the same.
absl::Status CheckLeaseChunks(const IdentifiedLease& lease, const LeaseChunks& chunks);

}  // namespace ballpiston::server

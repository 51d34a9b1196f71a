// The results of a task: files with complete chunks, in the array's folder.
//
// A task writes files with the sequence numbers 0, 1, 2, ...; the last one is final. A task that
// was interrupted and starts again reads its files, continues after the greatest number, and
// computes the missing chunks. A checksummed file proves its chunks whatever the job scheduler
// says.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
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
  size_t lease = 0;  // index in the task
  JobIdentity job = {};
  size_t point = 0;
  int attempt = 1;
  std::vector<ChunkResult> chunks = {};
  double processor_seconds = 0;  // on this lease since the task's previous file
};

struct ChunkFile {
  std::string array = {};
  size_t task = 0;
  uint32_t sequence = 0;
  bool is_final = false;  // the task has nothing left to compute
  std::vector<LeaseChunks> leases = {};
  double memory_exceeded =
      0;  // bytes that the task may use, if a lease needs more and was left out
};

struct ChunkFileName {
  size_t task = 0;
  uint32_t sequence = 0;

  std::string Text() const;  // "task-TASK.SEQUENCE.chunks"
};

// Empty if the name is not that of a chunk file: for example a temporary name.
std::optional<ChunkFileName> ParseChunkFileName(absl::string_view name);

// Names of the chunk files in a folder, by task and sequence. UNAVAILABLE if the folder cannot be
// read.
absl::StatusOr<std::vector<ChunkFileName>> ListChunkFiles(const std::string& folder);

// The name follows from task and sequence. Errors are those of WriteCheckedFile.
absl::Status WriteChunkFile(const std::string& folder, const ChunkFile& file);

// Besides the errors of ReadCheckedFile: DATA_LOSS if the message is damaged, or has another task
// or sequence than the name.
absl::StatusOr<ChunkFile> ReadChunkFile(const std::string& folder, const ChunkFileName& name);

std::string ChunkFilePayload(const ChunkFile& file);
// DATA_LOSS with the name of the field.
absl::StatusOr<ChunkFile> ChunkFileFromPayload(absl::string_view payload);

// DATA_LOSS unless the chunks are of this lease's job and point, lie within the lease, and are
// possible for its experiment. The attempt may be another one: the bits are the same.
absl::Status CheckLeaseChunks(const IdentifiedLease& lease, const LeaseChunks& chunks);

}  // namespace ballpiston::server

#include "server/worker/chunk_file.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "ballpiston/storage/records.pb.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/fold_record.h"

namespace ballpiston::server {
namespace {

absl::Status Damaged(absl::string_view field, absl::string_view why) {
  return absl::DataLossError(absl::StrCat("field ", field, " of a message of chunks ", why));
}

void Fill(const LeaseChunks& chunks, storage::LeaseChunks& record) {
  record.set_server(chunks.job.server);
  record.set_job(chunks.job.job);
  record.set_generation(chunks.job.generation);
  record.set_engine_version(chunks.job.engine_version);
  record.set_point(static_cast<int64_t>(chunks.point));
  record.set_attempt(chunks.attempt);
  record.set_processor_seconds(chunks.processor_seconds);
  for (const ChunkResult& chunk : chunks.chunks) {
    storage::Chunk& added = *record.add_chunks();
    added.set_chunk(chunk.chunk);
    FillAccumulators(chunk.result, *added.mutable_result());
  }
}

absl::Status CheckNumbers(const storage::LeaseChunks& record) {
  if (record.point() < 0) return Damaged("point", "is negative");
  if (record.attempt() < 1) return Damaged("attempt", "is less than 1");
  const double seconds = record.processor_seconds();
  if (seconds >= 0 && std::isfinite(seconds)) return absl::OkStatus();
  return Damaged("processor_seconds", "is negative or not finite");
}

LeaseChunks ChunksOf(const storage::LeaseChunks& record) {
  LeaseChunks chunks = {
      .job = {record.server(), record.job(), record.generation(), record.engine_version()},
      .point = static_cast<size_t>(record.point()),
      .attempt = record.attempt(),
      .processor_seconds = record.processor_seconds()};
  for (const storage::Chunk& chunk : record.chunks()) {
    chunks.chunks.push_back({chunk.chunk(), ResultOfAccumulators(chunk.result())});
  }
  return chunks;
}

}  // namespace

std::string LeaseChunksPayload(const LeaseChunks& chunks) {
  storage::LeaseChunks record;
  Fill(chunks, record);
  return DeterministicBytes(record);
}

absl::StatusOr<LeaseChunks> LeaseChunksFromPayload(absl::string_view payload) {
  storage::LeaseChunks record;
  if (!record.ParseFromArray(payload.data(), static_cast<int>(payload.size()))) {
    return absl::DataLossError("a message of chunks cannot be read");
  }
  const absl::Status checked = CheckNumbers(record);
  if (!checked.ok()) return checked;
  return ChunksOf(record);
}

absl::Status CheckLeaseChunks(const IdentifiedLease& lease, const LeaseChunks& chunks) {
  if (chunks.job != lease.job) return Damaged("job", "is not the job of the lease");
  if (chunks.point != lease.lease.point) return Damaged("point", "is not the point of the lease");
  for (const ChunkResult& chunk : chunks.chunks) {
    if (chunk.chunk < lease.lease.start.chunk || chunk.chunk >= lease.lease.end) {
      return Damaged("chunk", absl::StrCat("is ", chunk.chunk, ", which is not in the lease"));
    }
    absl::Status checked = CheckChunk(*lease.lease.experiment, chunk);
    if (!checked.ok()) return checked;
  }
  return absl::OkStatus();
}

}  // namespace ballpiston::server

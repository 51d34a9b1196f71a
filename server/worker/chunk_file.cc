#include "server/worker/chunk_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <tuple>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "ballpiston/storage/records.pb.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/fold_record.h"
#include "server/worker/checked_file.h"

namespace ballpiston::server {
namespace {

constexpr absl::string_view kPrefix = "task-", kSuffix = ".chunks";

absl::Status Damaged(absl::string_view field, absl::string_view why) {
  return absl::DataLossError(absl::StrCat("field ", field, " of a chunk file ", why));
}

void Fill(const LeaseChunks& chunks, storage::LeaseChunks& record) {
  record.set_lease(static_cast<uint32_t>(chunks.lease));
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
      .lease = record.lease(),
      .job = {record.server(), record.job(), record.generation(), record.engine_version()},
      .point = static_cast<size_t>(record.point()),
      .attempt = record.attempt(),
      .processor_seconds = record.processor_seconds()};
  for (const storage::Chunk& chunk : record.chunks()) {
    chunks.chunks.push_back({chunk.chunk(), ResultOfAccumulators(chunk.result())});
  }
  return chunks;
}

// A decimal number as StrCat writes it. Empty if the text is something else.
std::optional<uint32_t> NumberOf(absl::string_view text) {
  uint32_t number = 0;
  if (!absl::SimpleAtoi(text, &number) || absl::StrCat(number) != text) return std::nullopt;
  return number;
}

std::string PathOf(const std::string& folder, const ChunkFileName& name) {
  return absl::StrCat(folder, "/", name.Text());
}

absl::StatusOr<ChunkFile> FileOf(absl::string_view payload, const ChunkFileName& name) {
  absl::StatusOr<ChunkFile> file = ChunkFileFromPayload(payload);
  if (!file.ok()) return file;
  if (file->task != name.task) return Damaged("task", "differs from the file's name");
  if (file->sequence != name.sequence) return Damaged("sequence", "differs from the file's name");
  return file;
}

}  // namespace

std::string ChunkFileName::Text() const {
  return absl::StrCat(kPrefix, task, ".", sequence, kSuffix);
}

std::optional<ChunkFileName> ParseChunkFileName(absl::string_view name) {
  if (!absl::ConsumePrefix(&name, kPrefix) || !absl::ConsumeSuffix(&name, kSuffix)) return {};
  const size_t dot = name.find('.');
  if (dot == absl::string_view::npos) return std::nullopt;
  const std::optional<uint32_t> task = NumberOf(name.substr(0, dot));
  const std::optional<uint32_t> sequence = NumberOf(name.substr(dot + 1));
  if (!task || !sequence) return std::nullopt;
  return ChunkFileName{*task, *sequence};
}

absl::StatusOr<std::vector<ChunkFileName>> ListChunkFiles(const std::string& folder) {
  std::vector<ChunkFileName> names;
  std::error_code error;
  std::filesystem::directory_iterator entry(folder, error);
  while (!error && entry != std::filesystem::directory_iterator()) {
    if (const auto name = ParseChunkFileName(entry->path().filename().string())) {
      names.push_back(*name);
    }
    entry.increment(error);
  }
  if (error) {
    return absl::UnavailableError(
        absl::StrCat("folder ", folder, " cannot be read: ", error.message()));
  }
  std::sort(names.begin(), names.end(), [](const ChunkFileName& a, const ChunkFileName& b) {
    return std::tie(a.task, a.sequence) < std::tie(b.task, b.sequence);
  });
  return names;
}

absl::Status WriteChunkFile(const std::string& folder, const ChunkFile& file) {
  return WriteCheckedFile(PathOf(folder, {file.task, file.sequence}), FileKind::kChunks,
                          ChunkFilePayload(file));
}

absl::StatusOr<ChunkFile> ReadChunkFile(const std::string& folder, const ChunkFileName& name) {
  const std::string path = PathOf(folder, name);
  const absl::StatusOr<std::string> payload = ReadCheckedFile(path, FileKind::kChunks);
  if (!payload.ok()) return payload.status();
  absl::StatusOr<ChunkFile> file = FileOf(*payload, name);
  if (file.ok()) return file;
  return absl::Status(file.status().code(),
                      absl::StrCat("file ", path, ": ", file.status().message()));
}

std::string ChunkFilePayload(const ChunkFile& file) {
  storage::ChunkFile record;
  record.set_array(file.array);
  record.set_task(static_cast<uint32_t>(file.task));
  record.set_sequence(file.sequence);
  record.set_final(file.is_final);
  for (const LeaseChunks& chunks : file.leases) Fill(chunks, *record.add_leases());
  record.set_memory_exceeded(file.memory_exceeded);
  return DeterministicBytes(record);
}

absl::StatusOr<ChunkFile> ChunkFileFromPayload(absl::string_view payload) {
  storage::ChunkFile record;
  if (!record.ParseFromArray(payload.data(), static_cast<int>(payload.size()))) {
    return absl::DataLossError("the message of a chunk file cannot be read");
  }
  ChunkFile file = {.array = record.array(),
                    .task = record.task(),
                    .sequence = record.sequence(),
                    .is_final = record.final(),
                    .memory_exceeded = record.memory_exceeded()};
  for (const storage::LeaseChunks& chunks : record.leases()) {
    const absl::Status checked = CheckNumbers(chunks);
    if (!checked.ok()) return checked;
    file.leases.push_back(ChunksOf(chunks));
  }
  return file;
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

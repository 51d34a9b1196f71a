#include "server/worker/lease_file.h"

#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "ballpiston/storage/records.pb.h"
#include "server/convert/compressed.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/fold_record.h"
#include "server/worker/shared_files.h"

namespace ballpiston::server {
namespace {

constexpr std::pair<Outcome, absl::string_view> kOutcomes[] = {{Outcome::kFinished, "finished"},
                                                               {Outcome::kReturned, "returned"},
                                                               {Outcome::kLost, "lost"},
                                                               {Outcome::kCrashed, "crashed"},
                                                               {Outcome::kNoMemory, "no-memory"}};

absl::Status Unreadable() {
  return absl::DataLossError("a message of a lease's file cannot be read");
}

bool IsDuration(double seconds) { return std::isfinite(seconds) && seconds >= 0; }

template <typename Message>
absl::StatusOr<Message> TakeMessage(absl::string_view& bytes) {
  const absl::StatusOr<std::string> plain = TakeCompressed(bytes, kMaxSharedFile);
  if (!plain.ok()) return plain.status();
  Message message;
  if (message.ParseFromString(*plain)) return message;
  return Unreadable();
}

template <typename Message>
std::string BytesOfMessage(const Message& message) {
  return Compressed(DeterministicBytes(message));
}

}  // namespace

std::string LeaseFileName::Done(Outcome how) const {
  for (const auto& [known, text] : kOutcomes) {
    if (known == how) return absl::StrCat("done/", lease, ".", worker, ".", text);
  }
  return "";
}

std::optional<LeaseFileName> ParseTaken(absl::string_view name) {
  const std::vector<std::string> parts = absl::StrSplit(name, '.');
  if (parts.size() != 2 || parts[0].empty() || parts[1].empty()) return std::nullopt;
  return LeaseFileName{parts[0], parts[1]};
}

std::optional<LeaseFileName> ParseDone(absl::string_view name) {
  const size_t dot = name.rfind('.');
  if (dot == absl::string_view::npos) return std::nullopt;
  std::optional<LeaseFileName> file = ParseTaken(name.substr(0, dot));
  if (!file) return std::nullopt;
  for (const auto& [outcome, text] : kOutcomes) {
    if (text == name.substr(dot + 1)) file->outcome = outcome;
  }
  return file->outcome ? file : std::nullopt;
}

std::string BytesOf(const storage::Lease& lease) { return BytesOfMessage(lease); }

std::string BytesOf(const LeaseReport& report) {
  storage::LeaseChunks record;
  for (const ChunkResult& chunk : report.chunks) FillChunk(chunk, *record.add_chunks());
  record.set_processor_seconds(report.seconds);
  return BytesOfMessage(record);
}

absl::StatusOr<LeaseFile> TakeLease(absl::string_view& bytes) {
  const absl::StatusOr<storage::Lease> record = TakeMessage<storage::Lease>(bytes);
  if (!record.ok()) return record.status();
  if (!IsDuration(record->touch_seconds())) return Unreadable();
  return LeaseOfRecord(*record);
}

absl::StatusOr<LeaseReport> TakeReport(absl::string_view& bytes) {
  const absl::StatusOr<storage::LeaseChunks> record = TakeMessage<storage::LeaseChunks>(bytes);
  if (!record.ok()) return record.status();
  if (!IsDuration(record->processor_seconds())) return Unreadable();
  LeaseReport report = {.seconds = record->processor_seconds()};
  for (const storage::Chunk& chunk : record->chunks()) report.chunks.push_back(ChunkOf(chunk));
  return report;
}

}  // namespace ballpiston::server

#include "server/worker/lease_file.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "ballpiston/storage/records.pb.h"
#include "server/convert/deterministic_bytes.h"
#include "server/worker/checked_file.h"

namespace ballpiston::server {
namespace {

constexpr std::pair<Outcome, absl::string_view> kOutcomes[] = {{Outcome::kFinished, "finished"},
                                                               {Outcome::kReturned, "returned"},
                                                               {Outcome::kLost, "lost"},
                                                               {Outcome::kCrashed, "crashed"},
                                                               {Outcome::kNoMemory, "no-memory"}};

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

std::string BytesOf(const storage::Lease& lease, double touch_seconds) {
  storage::LeaseFile record;
  *record.mutable_lease() = lease;
  record.set_touch_seconds(touch_seconds);
  return FrameOf(FrameKind::kLease, DeterministicBytes(record));
}

std::string BytesOf(const LeaseChunks& chunks) {
  return FrameOf(FrameKind::kChunks, LeaseChunksPayload(chunks));
}

absl::StatusOr<LeaseFile> TakeLease(absl::string_view& bytes) {
  const absl::StatusOr<absl::string_view> payload = TakeFrame(FrameKind::kLease, bytes);
  if (!payload.ok()) return payload.status();
  storage::LeaseFile record;
  const bool is_read = record.ParseFromArray(payload->data(), static_cast<int>(payload->size()));
  const double seconds = record.touch_seconds();
  if (!is_read || !std::isfinite(seconds) || seconds < 0) {
    return absl::DataLossError("the message of a lease's file cannot be read");
  }
  absl::StatusOr<IdentifiedLease> lease = LeaseOfRecord(record.lease());
  if (!lease.ok()) return lease.status();
  return LeaseFile{*std::move(lease), seconds};
}

absl::StatusOr<LeaseChunks> TakeChunks(absl::string_view& bytes) {
  const absl::StatusOr<absl::string_view> payload = TakeFrame(FrameKind::kChunks, bytes);
  if (!payload.ok()) return payload.status();
  return LeaseChunksFromPayload(*payload);
}

}  // namespace ballpiston::server

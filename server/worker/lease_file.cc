#include "server/worker/lease_file.h"

#include <cassert>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/engine_version.h"
#include "core/ensemble/experiment_kind.h"
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

// `one_point` is a OnePointSpec by a model that samples.
void FillQuestion(const EnsembleSpec& one_point, storage::Question& record) {
  assert(!one_point.target.budget_seconds);
  record.set_experiment(static_cast<uint32_t>(one_point.experiment->number));
  for (const Parameter* parameter : kParameters) {
    for (const double value : one_point.grid[*parameter]) {
      (*record.mutable_values())[static_cast<uint32_t>(parameter->index)] = value;
    }
  }
  const Target& target = one_point.target;
  if (target.samples) record.set_samples(*target.samples);
  if (target.collisions) record.set_collisions(*target.collisions);
  if (target.tolerance) record.set_tolerance(*target.tolerance);
  record.set_estimate(target.estimate);
  record.set_seed(one_point.seed);
  record.set_model(static_cast<uint32_t>(one_point.model));
  record.set_single_precision(one_point.precision == Precision::kSingle);
}

Target TargetOf(const storage::Question& record) {
  Target target = {.estimate = record.estimate()};
  if (record.has_samples()) target.samples = record.samples();
  if (record.has_collisions()) target.collisions = record.collisions();
  if (record.has_tolerance()) target.tolerance = record.tolerance();
  return target;
}

// For a spec in single precision AUTO may choose the jump process, although a user may not. So the
// precision of the jump process is not checked.
bool IsPossible(EnsembleSpec spec) {
  if (spec.model == Model::kAuto || !TakesSamples(spec.model)) return false;
  if (!IsABilliard(spec.model)) spec.precision = Precision::kDouble;
  return Violations(spec).empty();
}

// Empty if the question has violations.
std::optional<EnsembleSpec> SpecOf(const storage::Question& record) {
  EnsembleSpec spec = {
      .experiment = FindExperiment(record.experiment()),
      .target = TargetOf(record),
      .seed = record.seed(),
      .model = static_cast<Model>(record.model()),
      .precision = record.single_precision() ? Precision::kSingle : Precision::kDouble};
  for (const auto& [parameter, value] : record.values()) {
    if (parameter >= kParameters.size()) return std::nullopt;
    spec.grid[*kParameters[parameter]] = {value};
  }
  return IsPossible(spec) ? std::optional(std::move(spec)) : std::nullopt;
}

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

storage::Lease LeaseRecord(const Lease& lease, const std::string& server, double touch_seconds) {
  storage::Lease record;
  record.set_server(server);
  record.set_job(lease.run);
  record.set_generation(lease.generation);
  record.set_engine_version(EngineVersion());
  record.set_point(lease.point);
  record.set_touch_seconds(touch_seconds);
  const PointExperiment& experiment = *lease.experiment;
  FillQuestion(OnePointSpec(*lease.spec, experiment.parameters(), experiment.answer().model),
               *record.mutable_question());
  record.set_first_chunk(lease.start.chunk);
  record.set_end_chunk(lease.end);
  record.set_blocks(lease.start.blocks);
  if (lease.start.blocks > 0) FillAccumulators(lease.start.merged, *record.mutable_partial());
  for (const GroupState& group : lease.groups) FillGroup(group, *record.add_groups());
  return record;
}

absl::StatusOr<LeaseFile> LeaseOfRecord(const storage::Lease& record) {
  if (record.engine_version() != EngineVersion()) {
    return absl::UnimplementedError(
        absl::StrCat("a lease is for engine version ", record.engine_version(),
                     "; this program has engine version ", EngineVersion()));
  }
  std::optional<EnsembleSpec> spec = SpecOf(record.question());
  if (!spec) return absl::DataLossError("this engine cannot answer the question of a lease");
  Lease lease = {.run = record.job(), .generation = record.generation()};
  lease.experiment = PointExperiment::Create(*spec, 0);
  lease.spec = std::make_shared<const EnsembleSpec>(*std::move(spec));
  lease.point = record.point();
  lease.start = {record.first_chunk(), record.blocks(), ResultOfAccumulators(record.partial())};
  lease.end = record.end_chunk();
  for (const storage::Group& group : record.groups()) lease.groups.push_back(GroupOf(group));
  return LeaseFile{record.server(), std::move(lease), record.touch_seconds()};
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

// The records of the store, and the file of a lease: damage is DATA_LOSS.
#include "ballpiston/storage/records.pb.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "server/convert/compressed.h"
#include "server/convert/deterministic_bytes.h"
#include "server/convert/errors.h"
#include "server/convert/fold_record.h"
#include "server/convert/point_result.h"
#include "server/convert/spec.h"
#include "server/store/job_record.h"
#include "server/worker/lease_file.h"
#include "tests/core/one_point_spec.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/rules.h"

namespace ballpiston::fuzz {
namespace {

using Experiments = std::vector<std::unique_ptr<const PointExperiment>>;

// At least one experiment for each shape of block. First hits: with both signs of the piston's
// velocity, with one sign, and with a tolerance.
const Experiments& KnownExperiments() {
  const Target samples = {.samples = 1000}, collisions = {.collisions = 1000};
  const GasShape chain = {.columns = 4};
  static Experiments experiments;
  if (!experiments.empty()) return experiments;
  for (const EnsembleSpec& spec :
       {SpecOf(&kEquilibrium, PaperPoint(0.1), collisions),
        SpecOf(&kConditionalMeanFreeTime, PaperPoint(0.1, 0.125), samples),
        SpecOf(&kFirstHit, PaperPoint(0.1, 0.125, 1), samples),
        SpecOf(&kFirstHit, PaperPoint(0.1, 0.375, 5), samples),
        SpecOf(&kFirstHit, PaperPoint(0.1, 0.125, 1), {.tolerance = 0.1}),
        SpecOf(&kEnergyRelaxation, PaperPoint(0.1), samples),
        SpecOf(&kMarkovProperty, PaperPoint(0.1), collisions),
        SpecOf(&kGasEquilibrium, PaperGas(&kGasEquilibrium, 0.1, chain), samples),
        SpecOf(&kGasConduction, PaperGas(&kGasConduction, 0.1, chain), samples)}) {
    experiments.push_back(PointExperiment::Create(spec, 0));
  }
  return experiments;
}

void RequireResumed(const PointExperiment& experiment, const FoldState& state) {
  PointFold fold(experiment);
  fold.Resume(state);
  Require(fold.PlannedSamples() <= experiment.plan().samples(), "not more than was planned");
  if (!fold.HasBlocks()) return;
  const BlockResult merged = fold.Merged();
  Require(merged.samples == state.complete.samples + state.partial.samples, "no sample is lost");
  Require(merged.HasShapeOf(experiment.EmptyResult()), "merging keeps the shape");
  const v1::PointResult result = server::ResultOf(3, experiment, experiment.Summarize(merged));
  Require(server::ResultFromBytes(result.SerializeAsString()).ok(),
          "what was merged can be stored");
}

void RequireStored(const FoldState& state) {
  const std::string stored = server::FoldRecordBytes(state);
  const absl::StatusOr<FoldState> again = server::FoldStateFromBytes(stored);
  Require(again.ok() && server::FoldRecordBytes(*again) == stored, "stored bytes come back");
}

// A checkpoint's record: read, checked against each experiment and, if it fits, resumed and
// summarized.
void CheckStoredFold(const std::string& bytes) {
  const absl::StatusOr<FoldState> state = server::FoldStateFromBytes(bytes);
  if (!state.ok()) return Require(absl::IsDataLoss(state.status()), "damage is DATA_LOSS");
  if (IsOneIn(4, bytes)) RequireStored(*state);
  for (const auto& experiment : KnownExperiments()) {
    const absl::Status fits = server::CheckFoldState(*experiment, *state);
    Require(fits.ok() || absl::IsDataLoss(fits), "damage is DATA_LOSS");
    if (fits.ok()) RequireResumed(*experiment, *state);
  }
}

std::vector<std::string> FoldsOfEach() {
  std::vector<std::string> folds;
  for (const auto& experiment : KnownExperiments()) {
    folds.push_back(server::FoldRecordBytes({.blocks = 1, .partial = experiment->EmptyResult()}));
  }
  return folds;
}

// As ReadShortfall does.
void CheckShortfall(const v1::PointResult& result, const std::string& bytes) {
  constexpr double kTolerance = 0.01;
  const EnsembleSpec spec = {.target = {.tolerance = kTolerance, .budget_seconds = 1.0}};
  const Estimate reached = server::FirstEstimateOf(result);
  if (RelativeError(reached) <= kTolerance) return;
  RequireSendable(server::ToleranceNotReached(spec, 0, reached), bytes);
}

// A finished point's result or its details, as pages of results and a restart read them.
void CheckStoredResult(const std::string& bytes) {
  const absl::StatusOr<v1::PointResult> details = server::DetailsFromBytes(bytes);
  Require(details.ok() || absl::IsDataLoss(details.status()), "damage of details is DATA_LOSS");
  const absl::StatusOr<v1::PointResult> result = server::ResultFromBytes(bytes);
  if (!result.ok()) return Require(absl::IsDataLoss(result.status()), "damage is DATA_LOSS");
  const std::string stored = server::DeterministicBytes(*result);
  const absl::StatusOr<v1::PointResult> again = server::ResultFromBytes(stored);
  Require(again.ok() && server::DeterministicBytes(*again) == stored,
          "reading a stored result gives the message that was stored");
  CheckShortfall(*result, bytes);
  const v1::PointResult told = server::WithDetails({}, *result, kEquilibrium);
  Require(told.histograms_size() == result->histograms_size(), "clients get every histogram");
}

// The message in a job's row, as a list and a restart read it.
void CheckStoredJob(const v1::EnsembleJob& stored, const std::string& bytes) {
  v1::EnsembleJob job = stored;
  server::SetNumbers({.points_done = 1}, job);
  server::SetExpireTime(400, job);
  const int32_t nanos = job.expire_time().nanos();
  Require(nanos >= 0 && nanos < 1'000'000'000, "the expiry time is a valid Timestamp");
  v1::EnsembleJob sent;
  Require(sent.ParseFromString(job.SerializeAsString()), "a row can be sent");
  RequireJudged(job.spec(), bytes);
}

// Merges the chunks that the experiment can have computed, as the scheduler does.
void RequireMerged(const PointExperiment& experiment, const std::vector<ChunkResult>& chunks) {
  PointFold fold(experiment);
  for (const ChunkResult& chunk : chunks) {
    const absl::Status fits = server::CheckChunk(experiment, chunk);
    Require(fits.ok() || absl::IsDataLoss(fits), "damage is DATA_LOSS");
    if (fits.ok()) fold.Add(chunk);
  }
  Require(fold.PlannedSamples() <= experiment.plan().samples(), "not more than was planned");
}

void CheckReport(const std::string& compressed) {
  absl::string_view bytes = compressed;
  const absl::StatusOr<server::LeaseReport> report = server::TakeReport(bytes);
  if (!report.ok()) return;
  const std::string written = server::BytesOf(*report);
  absl::string_view rest = written;
  const absl::StatusOr<server::LeaseReport> again = server::TakeReport(rest);
  Require(again.ok() && server::BytesOf(*again) == written, "written bytes come back");
  for (const auto& experiment : KnownExperiments()) RequireMerged(*experiment, report->chunks);
}

// The chunks that a worker appends to a lease's file. The input is used as compressed bytes, and as
// their contents with a correct checksum. Chunks that fit an experiment are merged.
void CheckChunkFile(const std::string& input) {
  CheckReport(input);
  const std::string compressed = server::Compressed(input);
  Require(server::Uncompressed(compressed) == input, "decompression returns the compressed input");
  CheckReport(compressed);
}

std::vector<std::string> FilesOfEach() {
  std::vector<std::string> files;
  for (const auto& experiment : KnownExperiments()) {
    files.push_back(server::BytesOf(
        server::LeaseReport{.chunks = {{0, experiment->EmptyResult()}}, .seconds = 0.5}));
    files.push_back(*server::Uncompressed(files.back()));
  }
  return files;
}

}  // namespace

std::vector<FuzzTarget> StoredTargets() {
  return {
      {"stored_fold", CheckStoredFold, &storage::Checkpoint::default_instance(), FoldsOfEach},
      {"stored_result", CheckStoredResult, &v1::PointResult::default_instance()},
      OfMessage<v1::EnsembleJob, CheckStoredJob>("stored_job"),
      {"chunk_file", CheckChunkFile, &storage::LeaseChunks::default_instance(), FilesOfEach},
  };
}

}  // namespace ballpiston::fuzz

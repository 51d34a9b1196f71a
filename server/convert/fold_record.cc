#include "server/convert/fold_record.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "server/convert/compressed.h"
#include "server/convert/deterministic_bytes.h"

namespace ballpiston::server {
namespace {

void Fill(const Moments& moments, storage::Moments& record) {
  record.set_count(moments.count);
  record.set_mean(moments.mean);
  record.set_m2(moments.m2);
  record.set_m3(moments.m3);
  record.set_m4(moments.m4);
}

void Fill(const BatchMeans& means, storage::BatchMeans& record) {
  Fill(means.numerator, *record.mutable_numerator());
  record.set_mean_denominator(means.mean_denominator);
  record.set_c_nd(means.c_nd);
  record.set_c_dd(means.c_dd);
}

void Fill(const Histogram& histogram, storage::Counts& record) {
  record.set_lower(histogram.lower);
  record.set_upper(histogram.upper);
  record.mutable_counts()->Assign(histogram.counts.begin(), histogram.counts.end());
}

Moments MomentsOf(const storage::Moments& record) {
  return {record.count(), record.mean(), record.m2(), record.m3(), record.m4()};
}

BatchMeans BatchMeansOf(const storage::BatchMeans& record) {
  return {MomentsOf(record.numerator()), record.mean_denominator(), record.c_nd(), record.c_dd()};
}

Histogram HistogramOf(const storage::Counts& record) {
  return {record.lower(), record.upper(), {record.counts().begin(), record.counts().end()}};
}

// Whether all bins together have at most so many counts. The sum of damaged counts may wrap, so it
// is not computed.
bool HoldsAtMost(uint64_t counts, const Histogram& histogram) {
  for (const uint64_t count : histogram.counts) {
    if (count > counts) return false;
    counts -= count;
  }
  return true;
}

// 10^12 samples of 2 10^6 counts each do not wrap.
bool CountsNoSampleTwice(const PointExperiment& experiment, const BlockResult& result) {
  const uint64_t counts = result.samples * experiment.CountsOfASample();
  return std::all_of(result.histograms.begin(), result.histograms.end(),
                     [&](const Histogram& h) { return HoldsAtMost(counts, h); });
}

// Whether the experiment can have written this result for that number of planned samples. A result
// of 0 planned samples is empty.
bool IsPossible(const PointExperiment& experiment, const BlockResult& result, uint64_t planned) {
  if (planned == 0) return result == BlockResult();
  return result.samples <= planned && result.health.max_energy_error >= 0 &&  // not NaN either
         CountsNoSampleTwice(experiment, result) && result.HasShapeOf(experiment.EmptyResult());
}

// Whether the groups that have a chunk in [first, end) of the plan, and no others, have a state
// with which they can continue.
bool GroupsArePossible(const PointExperiment& experiment, const BlockResult& result, uint64_t first,
                       uint64_t end) {
  for (uint64_t group = 0; group < result.groups.size(); ++group) {
    const uint64_t groups = result.groups.size();
    const uint64_t chunk = first + (group + groups - first % groups) % groups;
    const GroupState& state = result.groups[group];
    if (chunk < end ? !experiment.CanContinue(state) : !state.empty()) return false;
  }
  return true;
}

bool IsPossible(const PointExperiment& experiment, const FoldState& state) {
  const ChunkPlan& plan = experiment.plan();
  const uint64_t chunks = plan.chunks();
  if (!(state.least_error >= 0)) return false;
  if (state.chunk == 0 && state.blocks == 0)
    return false;  // none is written before the first block
  const bool is_in_the_plan = state.chunk < chunks && state.blocks < plan.BlocksIn(state.chunk);
  if (!is_in_the_plan && !(state.chunk == chunks && state.blocks == 0)) return false;
  const uint64_t complete = std::min(plan.FirstSample(state.chunk), plan.samples());
  const uint64_t partial =
      state.blocks == 0 ? 0 : plan.BlockAt(state.chunk, state.blocks).first - complete;
  return IsPossible(experiment, state.complete, complete) &&
         GroupsArePossible(experiment, state.complete, 0, state.chunk) &&
         IsPossible(experiment, state.partial, partial);
}

}  // namespace

void FillGroup(const GroupState& group, storage::Group& record) {
  record.mutable_numbers()->Assign(group.numbers().begin(), group.numbers().end());
}

GroupState GroupOf(const storage::Group& record) {
  if (record.numbers().empty()) return {};
  return GroupState({record.numbers().begin(), record.numbers().end()});
}

void FillAccumulators(const BlockResult& result, storage::Accumulators& record) {
  record.set_samples(result.samples);
  for (const Moments& moments : result.moments) Fill(moments, *record.add_moments());
  for (const BatchMeans& means : result.batch_means) Fill(means, *record.add_batch_means());
  for (const Histogram& histogram : result.histograms) Fill(histogram, *record.add_histograms());
  record.set_escapes(result.health.escapes);
  record.set_max_energy_error(result.health.max_energy_error);
  for (const GroupState& group : result.groups) FillGroup(group, *record.add_groups());
}

BlockResult ResultOfAccumulators(const storage::Accumulators& record) {
  BlockResult result;
  result.samples = record.samples();
  for (const auto& moments : record.moments()) result.moments.push_back(MomentsOf(moments));
  for (const auto& means : record.batch_means()) result.batch_means.push_back(BatchMeansOf(means));
  for (const auto& counts : record.histograms()) result.histograms.push_back(HistogramOf(counts));
  result.health.escapes = record.escapes();
  result.health.max_energy_error = record.max_energy_error();
  for (const storage::Group& group : record.groups()) result.groups.push_back(GroupOf(group));
  return result;
}

void FillChunk(const ChunkResult& chunk, storage::Chunk& record) {
  record.set_chunk(chunk.chunk);
  FillAccumulators(chunk.result, *record.mutable_result());
}

ChunkResult ChunkOf(const storage::Chunk& record) {
  return {.chunk = record.chunk(), .result = ResultOfAccumulators(record.result())};
}

std::string FoldRecordBytes(const FoldState& state, Model model) {
  storage::Checkpoint record;
  record.set_chunk(state.chunk);
  record.set_blocks(state.blocks);
  FillAccumulators(state.complete, *record.mutable_complete());
  FillAccumulators(state.partial, *record.mutable_partial());
  record.set_least_error(state.least_error);
  record.set_model(static_cast<uint32_t>(model));
  return DeterministicBytes(record);
}

absl::StatusOr<StoredState> CheckpointFromBytes(const std::string& bytes) {
  storage::Checkpoint record;
  if (!record.ParseFromString(bytes)) {
    return absl::DataLossError("a stored checkpoint cannot be read");
  }
  return StoredState{static_cast<Model>(record.model()),
                     {.chunk = record.chunk(),
                      .blocks = record.blocks(),
                      .complete = ResultOfAccumulators(record.complete()),
                      .partial = ResultOfAccumulators(record.partial()),
                      .least_error = record.least_error()}};
}

absl::StatusOr<FoldState> FoldStateFromBytes(const std::string& bytes) {
  absl::StatusOr<StoredState> read = CheckpointFromBytes(bytes);
  if (!read.ok()) return read.status();
  return std::move(read->state);
}

std::string EndBytes(const FoldState& state) { return Compressed(FoldRecordBytes(state)); }

absl::StatusOr<FoldState> EndFromBytes(const std::string& bytes) {
  const std::optional<std::string> plain = Uncompressed(bytes);
  if (plain) return FoldStateFromBytes(*plain);
  return absl::DataLossError("the stored final state of a point cannot be read");
}

std::string ChunkRecordBytes(const ChunkResult& chunk, Model model) {
  storage::Chunk record;
  record.set_model(static_cast<uint32_t>(model));
  FillChunk(chunk, record);
  return DeterministicBytes(record);
}

absl::StatusOr<StoredChunk> ChunkFromBytes(const std::string& bytes) {
  storage::Chunk record;
  if (!record.ParseFromString(bytes)) return absl::DataLossError("a stored chunk cannot be read");
  return StoredChunk{static_cast<Model>(record.model()), ChunkOf(record)};
}

absl::Status CheckFoldState(const PointExperiment& experiment, const FoldState& state) {
  if (IsPossible(experiment, state)) return absl::OkStatus();
  return absl::DataLossError("a stored checkpoint does not fit its experiment");
}

bool CanContinueFrom(const PointExperiment& experiment, const FoldState& state) {
  const std::optional<double>& tolerance = experiment.tolerance();
  constexpr double kRounding = 1 + 1e-12;  // of the quotient in least_error
  const bool has_ended_before = tolerance && state.least_error <= *tolerance * kRounding;
  return !has_ended_before && IsPossible(experiment, state);
}

absl::Status CheckChunk(const PointExperiment& experiment, const ChunkResult& chunk) {
  const ChunkPlan& plan = experiment.plan();
  const bool is_possible =
      chunk.chunk < plan.chunks() &&
      IsPossible(experiment, chunk.result, plan.SamplesIn(chunk.chunk)) &&
      GroupsArePossible(experiment, chunk.result, chunk.chunk, chunk.chunk + 1);
  if (is_possible) return absl::OkStatus();
  return absl::DataLossError("a chunk does not fit its experiment");
}

}  // namespace ballpiston::server

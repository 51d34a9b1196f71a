#include "core/ensemble/point_fold.h"

#include <algorithm>
#include <cassert>
#include <memory>
#include <utility>

namespace ballpiston {

PointFold::PointFold(const PointExperiment& experiment)
    : experiment_(experiment), chunks_(experiment.plan().chunks()), finished_(chunks_ == 0) {}

bool PointFold::Needs(uint64_t chunk) const {
  return !finished_ && chunk >= state_.chunk && chunk < chunks_ && !early_.contains(chunk);
}

GroupState PointFold::StartOf(uint64_t chunk) const {
  const uint64_t groups = experiment_.plan().groups();
  if (groups == 0 || chunk < groups) return {};
  const uint64_t group = chunk % groups, previous = chunk - groups;
  if (previous < state_.chunk) return state_.complete.groups[group];
  const auto early = early_.find(previous);
  return early == early_.end() ? GroupState() : early->second.groups[group];
}

bool PointFold::CanStart(uint64_t chunk) const {
  return chunk < experiment_.plan().groups() || experiment_.plan().groups() == 0 ||
         !StartOf(chunk).empty();
}

uint64_t PointFold::Add(ChunkResult chunk) {
  if (!Needs(chunk.chunk)) return 0;
  early_.emplace(chunk.chunk, std::move(chunk.result));
  if (chunk.whole_blocks.blocks > 0) whole_blocks_ = std::move(chunk.whole_blocks);
  uint64_t samples = 0;
  while (const auto next = early_.extract(state_.chunk)) {
    samples += MergeNext(next.mapped());
  }
  return samples;
}

void PointFold::JudgeLast() {
  if (state_.chunk == 0 || !experiment_.plan().IsJudgedAfter(state_.chunk - 1)) return;
  const double error = RelativeError(experiment_.FirstEstimate(state_.complete));
  state_.least_error = std::min(state_.least_error, error);
}

void PointFold::KeepContinuation() {
  before_the_cut_ = state_;
  if (whole_blocks_.blocks <= state_.blocks) return;
  before_the_cut_->blocks = whole_blocks_.blocks;
  before_the_cut_->partial = std::move(whole_blocks_.merged);
}

std::optional<FoldState> PointFold::Continuation() const {
  const bool is_cut = state_.chunk > experiment_.plan().FirstCutChunk();
  return is_cut ? before_the_cut_ : state_;
}

uint64_t PointFold::MergeNext(const BlockResult& chunk) {
  JudgeLast();
  if (state_.chunk == experiment_.plan().FirstCutChunk()) KeepContinuation();
  const uint64_t known = std::exchange(state_.partial, {}).samples;
  state_.complete.Merge(chunk);
  state_.blocks = 0;
  ++state_.chunk;
  if (state_.chunk == chunks_ || ReachesTolerance()) Finish();
  return chunk.samples - known;
}

uint64_t PointFold::AddPartial(const PartialChunk& partial) {
  if (finished_ || partial.chunk != state_.chunk || partial.blocks <= state_.blocks) return 0;
  state_.blocks = partial.blocks;
  const uint64_t known = std::exchange(state_.partial, partial.merged).samples;
  return state_.partial.samples - known;
}

void PointFold::Finish() {
  finished_ = true;
  early_.clear();
}

void PointFold::Resume(FoldState state) {
  state_ = std::move(state);
  const bool at_end_of_chunk = state_.blocks == 0 && state_.chunk > 0;
  if (state_.chunk == chunks_ || (at_end_of_chunk && ReachesTolerance())) Finish();
}

bool PointFold::ReachesTolerance() const {
  return experiment_.plan().IsJudgedAfter(state_.chunk - 1) &&
         experiment_.ReachesTolerance(state_.complete);
}

BlockResult PointFold::Merged() const {
  BlockResult merged = state_.complete;
  if (state_.blocks > 0) merged.Merge(state_.partial);
  return merged;
}

uint64_t PointFold::PlannedSamples() const {
  const ChunkPlan& plan = experiment_.plan();
  if (state_.chunk == chunks_) return plan.samples();
  return plan.BlockAt(state_.chunk, state_.blocks).first;
}

LocalPoint::LocalPoint(const PointExperiment& experiment, uint64_t window)
    : experiment_(experiment),
      fold_(experiment),
      chunks_(experiment.plan(), {}, experiment.plan().chunks(), {}, window) {}

std::optional<Block> LocalPoint::NextBlock() {
  return finished() ? std::nullopt : chunks_.NextBlock();
}

void LocalPoint::Add(const Block& block, BlockResult result) {
  for (ChunkResult& chunk : chunks_.Add(block, std::move(result))) fold_.Add(std::move(chunk));
}

PointFold LocalPoint::Now() const {
  PointFold now = fold_;
  now.AddPartial(chunks_.partial());
  return now;
}

FoldState LocalPoint::State() const { return Now().state(); }

BlockResult LocalPoint::Merged() const { return Now().Merged(); }

namespace {

class QueueOfOne : public BlockQueue {
 public:
  explicit QueueOfOne(const Block& block) : block_(block) {}

  std::optional<Block> Next() override { return std::exchange(block_, std::nullopt); }
  void Done(const Block&, BlockResult result) override { result_ = std::move(result); }
  bool Pause() override { return false; }
  BlockResult& result() { return result_; }

 private:
  std::optional<Block> block_;
  BlockResult result_;
};

}  // namespace

void LocalPoint::Run() {
  const std::unique_ptr<EngineRun> run = experiment_.StartRun(*this);
  while (!finished()) run->Advance();
}

BlockResult FoldPoint(const PointExperiment& experiment) {
  LocalPoint point(experiment);
  point.Run();
  return point.Merged();
}

BlockResult RunBlock(const PointExperiment& experiment, const Block& block) {
  assert(experiment.plan().chunks() > 0);  // else there is no run
  QueueOfOne queue(block);
  experiment.StartRun(queue)->Advance();
  return std::move(queue.result());
}

}  // namespace ballpiston

#include "core/ensemble/point_fold.h"

#include <memory>

namespace ballpiston {

PointFold::PointFold(const PointExperiment& experiment)
    : experiment_(experiment), chunks_(experiment.plan().chunks()), finished_(chunks_ == 0) {}

bool PointFold::HasNextBlock() const {
  return !finished_ && next_.first < chunks_ && handed_out_ < kWindow;
}

std::optional<Block> PointFold::NextBlock() {
  if (!HasNextBlock()) return std::nullopt;
  const ChunkPlan& plan = experiment_.plan();
  const Block block = plan.BlockAt(next_.first, next_.second);
  ++handed_out_;
  if (++next_.second == plan.BlocksIn(next_.first)) next_ = {next_.first + 1, 0};
  return block;
}

uint64_t PointFold::Add(const Block& block, BlockResult result) {
  const Place place = {block.chunk, block.index};
  if (finished_ || place < NextPlace()) return 0;
  early_.emplace(place, std::move(result));
  uint64_t samples = 0;
  while (!finished_ && !early_.empty() && early_.begin()->first == NextPlace()) {
    samples += MergeNext(early_.extract(early_.begin()).mapped());
  }
  return samples;
}

uint64_t PointFold::MergeNext(const BlockResult& result) {
  state_.partial.Merge(result);
  ++state_.blocks;
  if (handed_out_ > 0) --handed_out_;
  if (state_.blocks == experiment_.plan().BlocksIn(state_.chunk)) CompleteChunk();
  return result.samples;
}

void PointFold::CompleteChunk() {
  state_.complete.Merge(std::exchange(state_.partial, {}));
  state_.blocks = 0;
  ++state_.chunk;
  if (state_.chunk == chunks_ || experiment_.ReachesTolerance(state_.complete)) Finish();
}

void PointFold::Finish() {
  finished_ = true;
  early_.clear();
}

void PointFold::Resume(FoldState state) {
  state_ = std::move(state);
  next_ = NextPlace();
  const bool at_end_of_chunk = state_.blocks == 0 && state_.chunk > 0;
  if (state_.chunk == chunks_ ||
      (at_end_of_chunk && experiment_.ReachesTolerance(state_.complete))) {
    Finish();
  }
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

namespace {

class LocalQueue : public BlockQueue {
 public:
  LocalQueue(PointFold& fold, const std::stop_token& stop) : fold_(fold), stop_(stop) {}

  std::optional<Block> Next() override { return fold_.NextBlock(); }
  void Done(const Block& block, BlockResult result) override {
    fold_.Add(block, std::move(result));
  }
  bool Pause() override { return fold_.finished() || stop_.stop_requested(); }
  std::stop_token stop() const override { return stop_; }

 private:
  PointFold& fold_;
  const std::stop_token& stop_;
};

class QueueOfOne : public BlockQueue {
 public:
  QueueOfOne(const Block& block, const std::stop_token& stop) : block_(block), stop_(stop) {}

  std::optional<Block> Next() override { return std::exchange(block_, std::nullopt); }
  void Done(const Block&, BlockResult result) override { result_ = std::move(result); }
  bool Pause() override { return stop_.stop_requested(); }
  std::stop_token stop() const override { return stop_; }
  std::optional<BlockResult>& result() { return result_; }

 private:
  std::optional<Block> block_;
  const std::stop_token& stop_;
  std::optional<BlockResult> result_;
};

}  // namespace

std::optional<BlockResult> FoldPoint(const PointExperiment& experiment,
                                     const std::stop_token& stop) {
  PointFold fold(experiment);
  LocalQueue queue(fold, stop);
  const std::unique_ptr<BlockRun> run = experiment.StartRun(queue);
  while (!fold.finished() && !stop.stop_requested()) run->Advance();
  if (!fold.finished()) return std::nullopt;
  return fold.Merged();
}

std::optional<BlockResult> RunBlock(const PointExperiment& experiment, const Block& block,
                                    const std::stop_token& stop) {
  QueueOfOne queue(block, stop);
  experiment.StartRun(queue)->Advance();
  return std::move(queue.result());
}

}  // namespace ballpiston

#include "server/worker/lease_runner.h"

#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "core/ensemble/block_run.h"
#include "core/ensemble/point_fold.h"
#include "server/processor_time.h"

namespace ballpiston::server {
namespace {

class LeaseRun : private BlockQueue {
 public:
  LeaseRun(size_t index, const LeaseWork& work, const std::stop_token& stop,
           ChunkReceiver& receiver);

  bool Run();

 private:
  // The next chunk that is not known, from this one on; lease.end if there is none.
  uint64_t NextMissing(uint64_t chunk);
  uint64_t NextKnown(uint64_t chunk) const;
  void Compute(uint64_t first, uint64_t end);
  // Keeps the state in which the chunk's group has arrived.
  void Note(const ChunkResult& chunk);
  bool IsOver() const { return judge_ && judge_->finished(); }
  void TellWork();

  std::optional<Block> Next() override { return IsOver() ? std::nullopt : chunks_->NextBlock(); }
  void Done(const Block& block, BlockResult result) override;
  bool Pause() override;
  std::stop_token stop() const override { return stop_; }

  const size_t index_;
  const Lease& lease_;
  const std::stop_token& stop_;
  ChunkReceiver& receiver_;
  std::map<uint64_t, ChunkResult> known_;
  std::vector<GroupState> groups_;  // from which the next chunks start
  std::optional<PointFold> judge_;  // of a lease that begins with chunk 0
  std::optional<ChunkFold> chunks_;
  double worked_ = ThreadSeconds();  // the thread's processor time when it was last told
};

LeaseRun::LeaseRun(size_t index, const LeaseWork& work, const std::stop_token& stop,
                   ChunkReceiver& receiver)
    : index_(index),
      lease_(work.lease),
      stop_(stop),
      receiver_(receiver),
      groups_(work.lease.groups) {
  if (lease_.start.chunk == 0) judge_.emplace(*lease_.experiment);
  for (const ChunkResult& chunk : work.known) {
    known_.emplace(chunk.chunk, chunk);
    if (judge_) judge_->Add(chunk);
  }
}

uint64_t LeaseRun::NextMissing(uint64_t chunk) {
  for (; chunk < lease_.end && known_.contains(chunk); ++chunk) Note(known_.at(chunk));
  return chunk;
}

uint64_t LeaseRun::NextKnown(uint64_t chunk) const {
  const auto known = known_.lower_bound(chunk);
  return known == known_.end() ? lease_.end : known->first;
}

bool LeaseRun::Run() {
  uint64_t chunk = NextMissing(lease_.start.chunk);
  while (chunk < lease_.end && !IsOver() && !stop_.stop_requested()) {
    const uint64_t end = NextKnown(chunk);
    Compute(chunk, end);
    chunk = NextMissing(end);
  }
  return !stop_.stop_requested();
}

void LeaseRun::Compute(uint64_t first, uint64_t end) {
  const bool is_start = first == lease_.start.chunk;
  chunks_.emplace(lease_.experiment->plan(), is_start ? lease_.start : PartialChunk{first}, end,
                  groups_);
  const std::unique_ptr<EngineRun> run = lease_.experiment->StartRun(*this);
  while (!chunks_->finished() && !IsOver() && !stop_.stop_requested()) run->Advance();
  TellWork();
}

void LeaseRun::Note(const ChunkResult& chunk) {
  if (chunk.result.groups.empty()) return;
  groups_.resize(chunk.result.groups.size());
  const uint64_t group = chunk.chunk % groups_.size();
  groups_[group] = chunk.result.groups[group];
}

void LeaseRun::TellWork() {
  const double now = ThreadSeconds();
  receiver_.Worked(index_, now - std::exchange(worked_, now));
}

void LeaseRun::Done(const Block& block, BlockResult result) {
  for (ChunkResult& chunk : chunks_->Add(block, std::move(result))) {
    if (IsOver()) return;
    if (judge_) judge_->Add(chunk);
    Note(chunk);
    receiver_.ChunkDone(index_, std::move(chunk));
    TellWork();
  }
}

bool LeaseRun::Pause() {
  TellWork();
  return IsOver() || stop_.stop_requested();
}

}  // namespace

bool RunLeases(const std::vector<LeaseWork>& work, const std::stop_token& stop,
               ChunkReceiver& receiver) {
  for (size_t i = 0; i < work.size(); ++i) {
    if (!receiver.LeaseBegins(i)) continue;
    if (!LeaseRun(i, work[i], stop, receiver).Run()) return false;
  }
  return !stop.stop_requested();
}

}  // namespace ballpiston::server

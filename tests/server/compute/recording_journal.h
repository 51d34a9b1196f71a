// A journal that remembers everything, for tests of the scheduler.
#pragma once

#include "server/compute/run_journal.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

class RecordingJournal : public RunJournal {
 public:
  void Began() override {}

  absl::StatusOr<StoredPoint> ReadPoint(size_t point) override {
    StoredPoint found;
    if (const auto state = stored.find(point); state != stored.end()) found.state = state->second;
    if (const auto early = stored_chunks.find(point); early != stored_chunks.end()) {
      found.chunks = early->second;
    }
    return found;
  }

  uint64_t Merged(const MergedSamples& news) override {
    std::lock_guard lock(mutex);
    (news.restored ? restored : merged)[news.point] += news.samples;
    return ++changes;
  }

  void Checkpoint(size_t point, const FoldState& state) override {
    std::lock_guard lock(mutex);
    checkpoints[point] = state;
  }

  void ChunkIsEarly(size_t point, const ChunkResult& chunk) override {
    std::lock_guard lock(mutex);
    early[point].push_back(chunk);
  }

  void Worked(double seconds) override {
    std::lock_guard lock(mutex);
    work += seconds;
  }

  void PointFinished(size_t point, const PointExperiment&, const PointFold& fold) override {
    std::lock_guard lock(mutex);
    finished.emplace(point, fold.Merged());
  }

  void Ended(const absl::Status& status) override {
    std::lock_guard lock(mutex);
    outcome = status;
    ++ends;
    changed.notify_all();
  }

  void AwaitRoom() override {}

  absl::Status AwaitEnd() {
    std::unique_lock lock(mutex);
    AwaitNotified(changed, lock, [this] { return outcome.has_value(); });
    return *outcome;
  }

  std::map<size_t, FoldState> stored;  // these two are set before the run
  std::map<size_t, std::vector<ChunkResult>> stored_chunks;
  std::mutex mutex;
  std::condition_variable changed;
  int ends = 0;
  double work = 0;
  uint64_t changes = 0;
  std::map<size_t, uint64_t> merged;    // samples
  std::map<size_t, uint64_t> restored;  // likewise
  std::map<size_t, FoldState> checkpoints;
  std::map<size_t, std::vector<ChunkResult>> early;
  std::map<size_t, BlockResult> finished;
  std::optional<absl::Status> outcome;
};

}  // namespace ballpiston::server

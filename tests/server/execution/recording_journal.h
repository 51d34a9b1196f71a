// A journal that remembers everything, for tests of the worker pool.
#ifndef BALLPISTON_TESTS_SERVER_RECORDING_JOURNAL_H_
#define BALLPISTON_TESTS_SERVER_RECORDING_JOURNAL_H_

#include <atomic>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "server/execution/run_journal.h"

namespace ballpiston::server {

class RecordingJournal : public RunJournal {
 public:
  void Began() override { ++begun; }

  absl::Status ReadStoredBlocks(size_t point, const OnStoredBlock& on_block) override {
    for (const auto& [block, result] : stored[point]) on_block(block, result);
    return absl::OkStatus();
  }

  uint64_t BlockMerged(MergedBlock block) override {
    std::lock_guard lock(mutex);
    (block.restored ? restored : merged)[block.point].push_back(block.block);
    return ++changes;
  }

  void Worked(double seconds) override {
    std::lock_guard lock(mutex);
    work += seconds;
  }

  void PointFinished(size_t point, const PointExperiment&, const BlockResult& result) override {
    std::lock_guard lock(mutex);
    finished.emplace(point, result);
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
    changed.wait(lock, [this] { return outcome.has_value(); });
    return *outcome;
  }

  std::map<size_t, std::map<uint64_t, BlockResult>> stored;  // set before the run
  std::mutex mutex;
  std::condition_variable changed;
  std::atomic<int> begun = 0;
  int ends = 0;
  double work = 0;
  uint64_t changes = 0;
  std::map<size_t, std::vector<uint64_t>> merged;
  std::map<size_t, std::vector<uint64_t>> restored;
  std::map<size_t, BlockResult> finished;
  std::optional<absl::Status> outcome;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_TESTS_SERVER_RECORDING_JOURNAL_H_

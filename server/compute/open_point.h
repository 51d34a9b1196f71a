// A point whose chunks are being computed: which chunks are to be leased, and the fold.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "server/compute/lease.h"
#include "server/compute/run_journal.h"

namespace ballpiston::server {

class OpenPoint {
 public:
  explicit OpenPoint(std::shared_ptr<const PointExperiment> experiment);

  const std::shared_ptr<const PointExperiment>& experiment() const { return experiment_; }
  Model model() const { return experiment_->answer().model; }
  PointFold& fold() { return fold_; }
  const PointFold& fold() const { return fold_; }

  // Continues from what the store has of the point, before any chunk is leased. Drops what another
  // model computed: with a budget, an earlier process may have chosen one. DATA_LOSS if the rest
  // does not fit the experiment.
  absl::Status Resume(StoredPoint stored);

  // The chunks of the next lease, as `start`, `end`, `attempt` and `seconds`; empty if there is
  // none for this capacity now.
  std::optional<Lease> NextChunks(const Capacity& capacity);

  // There is a lease for a local executor, but it takes more memory than the capacity has.
  bool AwaitsMemory(const Capacity& capacity) const;

  // Chunks that were leased and are still needed go out again, as this attempt.
  void Return(uint64_t first, uint64_t end, int attempt, int crashes = 0);

  // Removes chunks that the experiment cannot have computed, or that do not have the point's merged
  // blocks. DATA_LOSS if there are any.
  absl::Status DropImpossible(std::vector<ChunkResult>& chunks) const;

  // Of the point's planned samples.
  double ShareOf(uint64_t samples) const;

  // Expected seconds of the chunks that are not merged, of one core at nominal speed.
  double ExpectedSeconds() const;

  std::stop_token stop() const { return stop_.get_token(); }
  void RequestStop() { stop_.request_stop(); }
  // No more blocks begin.
  void RequestEnd() { ending_.request_stop(); }

  uint64_t version = 0;  // the journal's number of the point's last change
  double work = 0;       // seconds of processor time of the point's chunks
  double work_at_checkpoint = 0;
  LeaseMemory memory = {};  // of a lease

 private:
  // Lease::attempt and Lease::crashes.
  struct Attempt {
    int number = 1;
    int crashes = 0;
    friend bool operator==(const Attempt&, const Attempt&) = default;
  };
  // The first chunk to lease and its attempt.
  std::optional<std::pair<uint64_t, Attempt>> NextChunk(const Capacity& capacity) const;
  // Whether the states from which the chunks that were never leased start are known.
  bool KnowsAllStarts() const;
  void Take(uint64_t chunk);
  void ContinueFrom(FoldState state);
  absl::Status Check(const ChunkResult& chunk) const;
  void SkipUnneeded();
  uint64_t chunks() const { return experiment_->plan().chunks(); }

  const std::shared_ptr<const PointExperiment> experiment_;
  PointFold fold_;
  uint64_t next_chunk_ = 0;               // this chunk and all after it were never leased
  std::map<uint64_t, Attempt> returned_;  // chunks before it to be leased again
  std::stop_source stop_;
  std::stop_source ending_;
};

}  // namespace ballpiston::server

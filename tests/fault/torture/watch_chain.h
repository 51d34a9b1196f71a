// One watch of a job, cut at random and taken up again with the last token, as one story:
//   1. each attachment begins with the job, or, if that has ended, with finished points left to
//   tell;
//   2. the job's state never goes back, but for one that runs, which a restart may find queued;
//   3. each finished point is told once over the whole chain, and all are, before the end;
//   4. points done and samples never go back within one life of the server;
//   5. the terminal state is told once, as the last message, before OK, and nothing is OK without.
#ifndef BALLPISTON_TESTS_FAULT_TORTURE_WATCH_CHAIN_H_
#define BALLPISTON_TESTS_FAULT_TORTURE_WATCH_CHAIN_H_

#include <atomic>
#include <optional>
#include <set>
#include <string>

#include "absl/status/status.h"
#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "tests/fault/torture/findings.h"

namespace ballpiston::torture {

// Of one thread.
class WatchChain {
 public:
  // `life` counts the server's lives.
  WatchChain(std::string job, const std::atomic<int>& life, Findings& findings);

  // Attaches, reads at most so many messages, and cuts. False if the server could not be reached.
  bool Attach(v1::EnsembleService::StubInterface& stub, int messages);

  bool ended() const { return ended_.has_value(); }
  const std::string& job() const { return request_.name(); }

  // Of an ended chain: compares with the points that the store has.
  void CheckFinishedPoints(v1::EnsembleService::StubInterface& stub);

 private:
  void CheckThatItHasEnded(v1::EnsembleService::StubInterface& stub);
  void Hear(const v1::WatchEnsembleJobResponse& message);
  void HearJob(const v1::EnsembleJob& job);
  void HearProgress(const v1::JobProgress& progress);
  void CheckEnd(const absl::Status& end, bool cut);
  void Wrong(const std::string& what);

  const std::atomic<int>& life_;
  Findings& findings_;
  v1::WatchEnsembleJobRequest request_;
  int life_of_stream_ = 0;
  bool of_ended_job_ = false;  // as the stream's first message says
  int told_life_ = -1;         // that of progress_
  v1::JobProgress progress_;
  int state_life_ = -1;
  v1::EnsembleJob::State state_ = v1::EnsembleJob::QUEUED;
  std::set<int> finished_;
  std::optional<v1::EnsembleJob::State> ended_;
};

}  // namespace ballpiston::torture

#endif  // BALLPISTON_TESTS_FAULT_TORTURE_WATCH_CHAIN_H_

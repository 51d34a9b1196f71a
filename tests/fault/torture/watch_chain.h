// Watches of one job, cut at random and resumed with the last token, checked as one sequence:
//   1. each watch begins with the job or, if the job has ended, with the finished points that were
//   not sent yet;
//   2. the job's state never goes back, except from RUNNING to QUEUED at a restart;
//   3. each finished point is sent once over the whole chain, before the end;
//   4. points done and samples never go back within one life of the server;
//   5. the terminal state is sent once, as the last message, before OK; no watch ends with OK
//      without it.
#pragma once

#include <atomic>
#include <optional>
#include <set>
#include <string>

#include "absl/status/status.h"
#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "tests/fault/torture/findings.h"

namespace ballpiston::torture {

// Not thread-safe.
class WatchChain {
 public:
  // `life` counts the server's lives.
  WatchChain(std::string job, const std::atomic<int>& life, Findings& findings);

  // Opens a watch, reads at most this many messages, and cuts it. False if the server could not be
  // reached.
  bool Attach(v1::EnsembleService::StubInterface& stub, int messages);

  bool ended() const { return ended_.has_value(); }
  const std::string& job() const { return request_.name(); }

  // After the end: compares the received points with those in the store.
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

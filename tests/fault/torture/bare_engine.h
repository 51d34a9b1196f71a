// The engine without the service: a question's first point, its blocks computed by so many threads
// and merged in order, and nothing else. The measure of what the service costs, and of how fast the
// machine is just now.
#ifndef BALLPISTON_TESTS_FAULT_TORTURE_BARE_ENGINE_H_
#define BALLPISTON_TESTS_FAULT_TORTURE_BARE_ENGINE_H_

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>

#include "ballpiston/v1/spec.pb.h"
#include "core/experiment/point_experiment.h"
#include "tests/fault/torture/windows.h"
#include "tests/support/server_process.h"

namespace ballpiston::torture {

class BareEngine {
 public:
  BareEngine(const v1::EnsembleSpec& question, int workers);

  Window Run(std::chrono::milliseconds length);

  // While the server is stopped.
  Window RunInsteadOf(const ServerProcess& server, std::chrono::milliseconds length);

  double SamplesOfBlock() const;

 private:
  using Clock = std::chrono::steady_clock;

  void Work(Clock::time_point end);
  uint64_t Next();
  void Merge(uint64_t block, BlockResult result);

  const std::unique_ptr<const PointExperiment> experiment_;
  const int workers_;
  std::mutex mutex_;
  uint64_t next_ = 0, merged_blocks_ = 0;
  std::map<uint64_t, BlockResult> early_;
  BlockResult merged_;
  Window window_;
};

}  // namespace ballpiston::torture

#endif  // BALLPISTON_TESTS_FAULT_TORTURE_BARE_ENGINE_H_

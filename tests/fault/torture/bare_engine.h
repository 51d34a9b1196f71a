// The engine without the service: threads compute the blocks of a question's first point, and the
// blocks are merged in order. It is the reference for the cost of the service and for the present
// speed of the machine.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <vector>

#include "ballpiston/v1/spec.pb.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "tests/fault/torture/windows.h"
#include "tests/support/server_process.h"

namespace ballpiston::torture {

class BareEngine {
 public:
  using Clock = std::chrono::steady_clock;

  BareEngine(const v1::EnsembleSpec& question, int workers);

  Window Run(std::chrono::milliseconds length);

  // Runs while the server is stopped. Goes on until `least_samples` are done, because the machine
  // may be busy.
  Window RunInsteadOf(const ServerProcess& server, std::chrono::milliseconds length,
                      double least_samples = 1);

 private:
  // Its blocks stay on their way between two windows.
  struct Worker {
    std::unique_ptr<BlockQueue> queue;
    std::unique_ptr<EngineRun> run;
  };

  void Work(Worker& worker);

  const std::unique_ptr<const PointExperiment> experiment_;
  LocalPoint point_;
  std::mutex mutex_;  // guards the point and the window
  Window window_;
  std::atomic<Clock::time_point> end_;  // of the window
  std::vector<Worker> workers_;
};

}  // namespace ballpiston::torture

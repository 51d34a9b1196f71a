// Machines elsewhere that compute leases: they report late, twice, out of order, in parts, or
// return the lease after a long time.
#pragma once

#include <vector>

#include "server/compute/scheduler.h"
#include "server/host.h"
#include "tests/simulation/machine.h"

namespace ballpiston::server {

class Cluster : public Executor {
 public:
  Cluster(Machine& machine, Scheduler& scheduler);
  ~Cluster() override;

  ExecutorTraits traits() const override { return {.local = false}; }
  void Start() override;
  void Wake() override {}  // the machines ask for leases at random times
  bool HasTurn(int64_t) const override { return false; }
  void Shutdown() override;

 private:
  void Work();
  void Compute(const Lease& lease);
  void ReportInAnyOrder(const Lease& lease, std::vector<ChunkResult> chunks);

  Machine& machine_;
  Scheduler& scheduler_;
  const size_t number_;
  bool is_shutting_down_ = false;
  std::vector<Thread> threads_;
};

}  // namespace ballpiston::server

// The objects and options that every method of the API uses.
#pragma once

#include <atomic>
#include <string>

#include "absl/time/time.h"
#include "core/gpu/device_orbits.h"
#include "server/book/job_book.h"
#include "server/cluster/cluster.h"
#include "server/compute/model_ladder.h"
#include "server/compute/scheduler.h"
#include "server/compute/thread_executor.h"
#include "server/door/authenticator.h"
#include "server/limits.h"
#include "server/rpc/quota.h"
#include "server/rpc/streams.h"
#include "server/rpc/watch.h"
#include "server/status/call_observer.h"
#include "server/store/store.h"

namespace ballpiston::server {

struct ServiceContext {
  const Authenticator& authenticator;
  const Limits& limits;
  JobBook& book;
  const Scheduler& scheduler;
  const ThreadExecutor& threads;
  const OrbitsOnDevice* device = nullptr;  // null without a device
  const Cluster* cluster;                  // null without a cluster
  ModelLadder& ladder;
  Quotas& quotas;
  Streams& streams;
  const std::atomic<bool>& draining;
  std::string instance;  // of this server process, which numbers the changes
  WatchTiming timing;
  Store& store;
  CallObserver& calls;
  absl::Time start_time;
  std::string store_path;
};

}  // namespace ballpiston::server

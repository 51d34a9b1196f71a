// The objects and options that every method of the API uses.
#pragma once

#include <atomic>
#include <string>

#include "absl/time/time.h"
#include "server/api/quota.h"
#include "server/api/streams.h"
#include "server/api/watch.h"
#include "server/door/authenticator.h"
#include "server/execution/slurm_executor.h"
#include "server/execution/thread_executor.h"
#include "server/jobs/job_book.h"
#include "server/limits.h"
#include "server/observability/activity.h"
#include "server/observability/call_observer.h"
#include "server/scheduling/model_ladder.h"
#include "server/scheduling/scheduler.h"
#include "server/store/store.h"

namespace ballpiston::server {

struct ServiceContext {
  const Authenticator& authenticator;
  const Limits& limits;
  JobBook& book;
  const Scheduler& scheduler;
  const ThreadExecutor& threads;
  const SlurmExecutor* slurm;  // null without a cluster
  ModelLadder& ladder;
  Quotas& quotas;
  Streams& streams;
  Activity& activity;
  const std::atomic<bool>& draining;
  std::string instance;  // of this server process, which numbers the changes
  WatchTiming timing;
  Store& store;
  CallObserver& calls;
  absl::Time start_time;
  std::string store_path;
};

}  // namespace ballpiston::server

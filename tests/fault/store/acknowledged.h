// The answers that a client got during a trace, and when. A power cut must not undo them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "ballpiston/v1/ensemble.pb.h"
#include "tests/fault/store/fault_disk.h"
#include "tests/fault/store/power_cut.h"
#include "tests/fault/store/service_on_disk.h"

namespace ballpiston::server {

// When a call was made and when it was answered, as counts of the disk's operations.
struct TracedCall {
  static constexpr size_t kNever = std::numeric_limits<size_t>::max();

  size_t made = kNever;
  size_t answered = kNever;

  // Whether the call was answered before a cut during operation `cut`.
  bool WasAnswered(size_t cut) const { return answered <= cut; }
  bool WasMade(size_t cut) const { return made <= cut; }
};

struct TracedJob {
  v1::EnsembleSpec spec;  // its seed is the job's key
  std::string request_id;
  std::string id;
  TracedCall create;
  TracedCall cancel;
  TracedCall remove;
  TracedCall success;                // the client has seen it, with its results
  std::vector<std::string> results;  // of an undisturbed run
};

struct Trace {
  DiskFiles initial;
  std::vector<DiskOperation> operations;
  std::map<uint64_t, TracedJob> jobs;  // by seed
};

// Opens the files after a cut and describes all errors in sentences: the store does not open or
// fails its check, acknowledged data is lost, deleted data is back, a request was executed twice, a
// job has a wrong end or other bytes. Empty: no errors.
std::vector<std::string> WhatIsWrongAfter(const Trace& trace, size_t cut, Survival survival,
                                          uint64_t seed);

}  // namespace ballpiston::server

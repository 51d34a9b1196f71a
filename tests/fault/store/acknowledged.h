// What a client was told in the course of a trace, and when: what a power cut must not undo.
#ifndef BALLPISTON_TESTS_FAULT_STORE_ACKNOWLEDGED_H_
#define BALLPISTON_TESTS_FAULT_STORE_ACKNOWLEDGED_H_

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

  // Before a cut in the midst of operation `cut`.
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

// Opens what a cut left and says in sentences what is wrong with it: the store does not open, fails
// its check, something acknowledged is lost, something deleted is back, a request was done twice, a
// job does not end as it should or with other bytes. Empty: nothing.
std::vector<std::string> WhatIsWrongAfter(const Trace& trace, size_t cut, Survival survival,
                                          uint64_t seed);

}  // namespace ballpiston::server

#endif  // BALLPISTON_TESTS_FAULT_STORE_ACKNOWLEDGED_H_

// The files that a power cut leaves. Pure functions of the disk's log of operations.
//
// A write or truncation is safe once a later sync of its file succeeded, a name once its folder was
// flushed. Any part of the other operations, including the one in progress, may be on the disk:
// `Survival` says which. After a failed sync, earlier writes may be lost although a later sync
// succeeds, unless they were written again.
#pragma once

#include "tests/fault/store/fault_disk.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

enum class Survival {
  kNothing,      // no unsafe operation
  kEverything,   // all operations
  kOldest,       // the operations before some moment
  kNewest,       // the operations after some moment: the disk reordered them
  kSectors,      // any sectors of 512 bytes, any names and truncations
  kTornSectors,  // the same, and some sectors are new up to their middle and old beyond it
};

inline constexpr Survival kSurvivals[] = {Survival::kNothing, Survival::kEverything,
                                          Survival::kOldest,  Survival::kNewest,
                                          Survival::kSectors, Survival::kTornSectors};

// The files after operations 0, ..., cut - 1 were done and operation `cut` was in progress, if
// there is one. The same for the same arguments.
DiskFiles AfterPowerCut(const DiskFiles& initial, const std::vector<DiskOperation>& operations,
                        size_t cut, Survival survival, uint64_t seed);

}  // namespace ballpiston::server

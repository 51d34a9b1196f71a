// What is left on a disk after a power cut: pure functions of its log of operations.
//
// A write or truncation is safe once a later sync of its file succeeded, a name once its folder was
// flushed. Of the others, the one in progress included, any part may be there: `Survival` says
// which. After a sync that failed nobody knows: what was written before it may be lost although a
// later sync succeeds, unless it was written again.
#ifndef BALLPISTON_TESTS_FAULT_STORE_POWER_CUT_H_
#define BALLPISTON_TESTS_FAULT_STORE_POWER_CUT_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/fault/store/fault_disk.h"

namespace ballpiston::server {

enum class Survival {
  kNothing,      // of what is not safe
  kEverything,   // the disk had written it all
  kOldest,       // what came before some moment
  kNewest,       // what came after some moment: the disk wrote in another order
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

#endif  // BALLPISTON_TESTS_FAULT_STORE_POWER_CUT_H_

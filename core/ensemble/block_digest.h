// A digest of a result: 64 bits that depend on every bit of every number in it.
//
// Two results with the same digest are the same, except with a probability of some 2^-64. A stored
// digest of a chunk lets anybody who computes the chunk again compare the bits. The digest does not
// protect from a person who makes up numbers with a given digest. Properties, each with a test of
// its name:
//   1. EveryNumberChangesTheDigest.  2. NumbersInAnotherOrderHaveAnotherDigest.
#pragma once

#include <cstdint>

#include "core/ensemble/block_result.h"

namespace ballpiston {

uint64_t DigestOf(const BlockResult& result);

}  // namespace ballpiston

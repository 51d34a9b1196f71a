// Specifications and requests of the tests.
#pragma once

#include "ballpiston/v1/ensemble.pb.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

// Idempotency keys.
inline constexpr char kUuid[] = "123e4567-e89b-12d3-a456-426614174000";
inline constexpr char kOtherUuid[] = "123e4567-e89b-12d3-a456-426614174001";

// For the fake experiments (fake_experiments.h): `points` points of `blocks` blocks each.
v1::EnsembleSpec Equilibrium(int points, int64_t blocks, uint64_t seed = 1);

// 90,000 points of one block: 720 kB, more than a connection buffers while nobody reads.
v1::EnsembleSpec LargeEquilibrium();

// For the core's experiments: six points of 4096 samples.
v1::EnsembleSpec SmallFirstHit();

v1::CreateEnsembleJobRequest CreateRequest(const v1::EnsembleSpec& spec,
                                           const std::string& request_id = "");
// The same, but the answer must not come from the store.
v1::CreateEnsembleJobRequest FreshRequest(const v1::EnsembleSpec& spec,
                                          const std::string& request_id = "");

}  // namespace ballpiston::server

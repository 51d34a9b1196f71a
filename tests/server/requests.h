// Specifications and requests of the tests.
#pragma once

#include "ballpiston/v1/ensemble.pb.h"
#include "tests/support/message_text.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {

// Idempotency keys.
inline constexpr char kUuid[] = "123e4567-e89b-12d3-a456-426614174000";
inline constexpr char kOtherUuid[] = "123e4567-e89b-12d3-a456-426614174001";

// For the fake experiments (fake_experiments.h): `points` points of `blocks` blocks each.
inline v1::EnsembleSpec Equilibrium(int points, int64_t blocks, uint64_t seed = 1) {
  v1::EnsembleSpec spec;
  spec.set_experiment(v1::EnsembleSpec::EQUILIBRIUM);
  spec.mutable_grid()->add_rho(0.53);
  for (int i = 0; i < points; ++i) spec.mutable_grid()->add_delta(0.1 + 1e-6 * i);
  spec.mutable_target()->set_collisions(blocks);
  spec.set_seed(seed);
  return spec;
}

// 90,000 points of one block: 720 kB, more than a connection buffers while nobody reads.
inline v1::EnsembleSpec LargeEquilibrium() { return Equilibrium(90'000, 1); }

// For the core's experiments: six points of 4096 samples.
inline v1::EnsembleSpec SmallFirstHit() {
  return FromText<v1::EnsembleSpec>(
      "experiment: FIRST_HIT"
      " grid { rho: 0.53 delta: [0.3, 0.25, 0.2] epsilon: [0.1, 0.4] exponent: 1 }"
      " target { samples: 4096 } seed: 42");
}

inline v1::CreateEnsembleJobRequest CreateRequest(const v1::EnsembleSpec& spec,
                                                  const std::string& request_id = "") {
  v1::CreateEnsembleJobRequest request;
  *request.mutable_spec() = spec;
  request.set_request_id(request_id);
  return request;
}

// The same, but the answer must not come from the store.
inline v1::CreateEnsembleJobRequest FreshRequest(const v1::EnsembleSpec& spec,
                                                 const std::string& request_id = "") {
  v1::CreateEnsembleJobRequest request = CreateRequest(spec, request_id);
  request.set_fresh(true);
  return request;
}

// A request that has only the name of a job.
template <typename Request>
Request RequestNaming(const std::string& name) {
  Request request;
  request.set_name(name);
  return request;
}

inline v1::WatchEnsembleJobRequest WatchRequest(const std::string& name,
                                                const std::string& resume_token) {
  auto request = RequestNaming<v1::WatchEnsembleJobRequest>(name);
  request.set_resume_token(resume_token);
  return request;
}

}  // namespace ballpiston::server

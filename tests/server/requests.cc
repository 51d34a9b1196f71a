#include "tests/server/requests.h"

#include "tests/support/message_text.h"

namespace ballpiston::server {

v1::EnsembleSpec Equilibrium(int points, int64_t blocks, uint64_t seed) {
  v1::EnsembleSpec spec;
  spec.set_experiment(v1::EnsembleSpec::EQUILIBRIUM);
  spec.mutable_grid()->add_rho(0.53);
  for (int i = 0; i < points; ++i) spec.mutable_grid()->add_delta(0.1 + 1e-6 * i);
  spec.mutable_target()->set_collisions(blocks);
  spec.set_seed(seed);
  return spec;
}

v1::EnsembleSpec LargeEquilibrium() { return Equilibrium(90'000, 1); }

v1::EnsembleSpec SmallFirstHit() {
  return FromText<v1::EnsembleSpec>(
      "experiment: FIRST_HIT"
      " grid { rho: 0.53 delta: [0.3, 0.25, 0.2] epsilon: [0.1, 0.4] exponent: 1 }"
      " target { samples: 4096 } seed: 42");
}

v1::CreateEnsembleJobRequest CreateRequest(const v1::EnsembleSpec& spec,
                                           const std::string& request_id) {
  v1::CreateEnsembleJobRequest request;
  *request.mutable_spec() = spec;
  request.set_request_id(request_id);
  return request;
}

v1::CreateEnsembleJobRequest FreshRequest(const v1::EnsembleSpec& spec,
                                          const std::string& request_id) {
  v1::CreateEnsembleJobRequest request = CreateRequest(spec, request_id);
  request.set_fresh(true);
  return request;
}

}  // namespace ballpiston::server

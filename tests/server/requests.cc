#include "tests/server/requests.h"

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
  v1::EnsembleSpec spec;
  spec.set_experiment(v1::EnsembleSpec::FIRST_HIT);
  spec.mutable_grid()->add_rho(0.53);
  for (const double delta : {0.3, 0.25, 0.2}) spec.mutable_grid()->add_delta(delta);
  for (const double epsilon : {0.1, 0.4}) spec.mutable_grid()->add_epsilon(epsilon);
  spec.mutable_grid()->add_exponent(1);
  spec.mutable_target()->set_samples(4096);
  spec.set_seed(42);
  return spec;
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

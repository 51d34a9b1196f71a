// EvaluatePairs: checks the whole answer.
#include <cmath>

#include "ballpiston/v1/analytic.pb.h"
#include "server/convert/analytic.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/rules.h"

namespace ballpiston::fuzz {
namespace {

// Larger requests are skipped, because every answer is evaluated and a few pairs can show every
// error.
constexpr int kMostPairs = 16;

void RequireFinite(const v1::PairAnalytics& point) {
  Require(std::isfinite(point.tau_ball_piston()) && point.tau_ball_piston() > 0, "a mean time");
  Require(std::isfinite(point.tau_ball_wall()) && point.tau_ball_wall() > 0, "a mean time");
  Require(std::isfinite(point.volume()) && point.volume() > 0, "a volume");
  for (const v1::EnergyAnalytics& energy : point.energies()) {
    Require(std::isfinite(energy.f()) && energy.f() >= 0, "a rate");
    for (const double kernel : energy.kernel()) Require(kernel >= 0, "a kernel");
  }
  for (const v1::CanonicalAnalytics& canonical : point.canonical()) {
    Require(std::isnormal(canonical.mean_h()) && canonical.mean_h() > 0, "an average");
    Require(std::isnormal(canonical.exchange_rate()), "an exchange rate");
    Require(std::isfinite(canonical.rare_limit_exchange_rate()), "its limit");
  }
}

void CheckPairsRequest(const std::string& bytes) {
  v1::EvaluatePairsRequest request;
  if (!request.ParseFromString(bytes)) return;
  if (request.rho_size() * request.delta_size() > kMostPairs) return;
  const auto response = server::EvaluatePairs(request);
  if (!response.ok()) return RequireSendable(response.status(), bytes);
  Require(response->points_size() == request.rho_size() * request.delta_size(), "every pair");
  for (const v1::PairAnalytics& point : response->points()) {
    Require(point.energies_size() == request.epsilon_size(), "every energy");
    Require(point.canonical_size() == request.beta_size() + request.temperature_size(),
            "every temperature");
    RequireFinite(point);
  }
}

const Registration kPairsRequest({.name = "pairs_request",
                                  .check = CheckPairsRequest,
                                  .message = &v1::EvaluatePairsRequest::default_instance()});

}  // namespace
}  // namespace ballpiston::fuzz

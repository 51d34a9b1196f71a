#include "server/convert/analytic.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/arithmetic/number_text.h"
#include "core/closed_form/canonical_measure.h"
#include "core/closed_form/conditional_rate.h"
#include "core/closed_form/kernel.h"
#include "core/closed_form/kernel_moments.h"
#include "core/closed_form/mean_free_time.h"
#include "core/closed_form/pair_measures.h"
#include "core/geometry/pair_geometry.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

using Violations = std::vector<FieldViolation>;

std::string Element(const char* field, int index) { return absl::StrCat(field, "[", index, "]"); }

void Add(const std::string& field, const absl::Status& status, Violations& violations) {
  if (!status.ok()) violations.push_back({field, std::string(status.message())});
}

// Lists may be long and all wrong; what is not told is of no use to anybody.
bool Enough(const Violations& violations) { return violations.size() >= 1000; }

template <typename List, typename Allowed>
void CheckValues(const char* field, const List& values, Allowed allowed, const char* range,
                 Violations& violations) {
  for (int i = 0; i < values.size() && !Enough(violations); ++i) {
    if (allowed(values.Get(i))) continue;
    violations.push_back(
        {Element(field, i), absl::StrCat(NumberText(values.Get(i)), " is not in ", range)});
  }
}

// The bound on delta falls as rho grows: a delta is wrong with some valid rho if it is with the
// largest of them.
void CheckDelta(const v1::EvaluatePairsRequest& request, int index, double largest_rho,
                Violations& violations) {
  const double delta = request.delta(index);
  Add(Element("delta", index),
      largest_rho > 0 ? ValidatePairDelta(largest_rho, delta) : ValidateSomeDelta(delta),
      violations);
}

void CheckPairs(const v1::EvaluatePairsRequest& request, Violations& violations) {
  double largest_rho = 0;  // of the valid ones
  for (int i = 0; i < request.rho_size() && !Enough(violations); ++i) {
    const absl::Status status = ValidateRho(request.rho(i));
    Add(Element("rho", i), status, violations);
    if (status.ok()) largest_rho = std::max(largest_rho, request.rho(i));
  }
  for (int i = 0; i < request.delta_size() && !Enough(violations); ++i) {
    CheckDelta(request, i, largest_rho, violations);
  }
}

void CheckNotEmpty(const v1::EvaluatePairsRequest& request, Violations& violations) {
  if (request.rho_size() == 0) violations.push_back({"rho", "required: at least one value"});
  if (request.delta_size() == 0) violations.push_back({"delta", "required: at least one value"});
}

void CheckSize(const v1::EvaluatePairsRequest& request, Violations& violations) {
  const int64_t pairs = int64_t{request.rho_size()} * request.delta_size();
  if (pairs > kMaxPairs) {
    violations.push_back(
        {"rho", absl::StrCat(pairs, " pairs of rho and delta; at most ", kMaxPairs, " a call")});
    return;
  }
  const double values = static_cast<double>(pairs) *
                        (request.epsilon_size() * (6.0 + request.outgoing_epsilon_size()) +
                         4.0 * request.beta_size());
  if (values <= static_cast<double>(kMaxAnalyticValues)) return;
  violations.push_back(
      {"epsilon", absl::StrFormat("%.0f values in the answer (for each pair 6 + outgoing_epsilon "
                                  "an epsilon, 4 a beta); at most %d a call",
                                  values, kMaxAnalyticValues)});
}

Violations Check(const v1::EvaluatePairsRequest& request) {
  Violations violations;
  CheckNotEmpty(request, violations);
  CheckSize(request, violations);
  CheckPairs(request, violations);
  CheckValues(
      "epsilon", request.epsilon(), [](double x) { return x >= 0 && x <= 0.5; }, "[0, 1/2]",
      violations);
  CheckValues(
      "outgoing_epsilon", request.outgoing_epsilon(), [](double x) { return x > 0 && x < 0.5; },
      "(0, 1/2)", violations);
  CheckValues(
      "beta", request.beta(), [](double x) { return x > 0 && std::isfinite(x); }, "(0, infinity)",
      violations);
  return violations;
}

void FillPair(const PairGeometry& geometry, const PairMeasures& measures,
              const MeanFreeTimes& times, v1::PairAnalytics& point) {
  point.set_rho(geometry.rho());
  point.set_delta(geometry.delta());
  point.set_lambda(geometry.lambda());
  point.set_eta(measures.eta);
  point.set_cell_area(measures.cell_area);
  point.set_volume(measures.volume);
  point.set_area_ball_piston(measures.area_ball_piston);
  point.set_area_ball_wall(measures.area_ball_wall);
  point.set_area_piston_wall(measures.area_piston_wall);
  point.set_tau_ball_piston(times.ball_piston);
  point.set_tau_ball_wall(times.ball_wall);
  point.set_tau_piston_wall(times.piston_wall);
  point.set_pair_delta_bound(PairDeltaBound(geometry.rho()));
  point.set_gas_delta_bound(GasDeltaBound(geometry.rho()));
  point.set_rare_limit_rate(RareLimitRate(geometry.rho()));
}

void FillEnergy(const v1::EvaluatePairsRequest& request, const PairGeometry& geometry,
                double epsilon, v1::EnergyAnalytics& energy) {
  energy.set_epsilon(epsilon);
  energy.set_phi(Phi(epsilon));
  energy.set_f(PairCollisionRate(epsilon));
  energy.set_j(PairEnergyCurrent(epsilon));
  energy.set_h(PairSquaredEnergyTransfer(epsilon));
  energy.set_mean_free_time_conditional(ConditionalMeanFreeTime(geometry, epsilon));
  for (const double outgoing : request.outgoing_epsilon()) {
    energy.add_kernel(PairKernel(epsilon, outgoing));
  }
}

void FillCanonical(double beta, v1::CanonicalAnalytics& canonical) {
  const CanonicalAverages averages = AveragesAt(beta);
  canonical.set_beta(beta);
  canonical.set_mean_f(averages.mean_f);
  canonical.set_mean_energy_current(averages.mean_energy_current);
  canonical.set_mean_h(averages.mean_h);
}

void FillPoint(const v1::EvaluatePairsRequest& request, const PairGeometry& geometry,
               v1::PairAnalytics& point) {
  const PairMeasures measures = Measures(geometry);
  FillPair(geometry, measures, MeanFreeTimesFrom(measures), point);
  for (const double epsilon : request.epsilon()) {
    FillEnergy(request, geometry, epsilon, *point.add_energies());
  }
  for (const double beta : request.beta()) FillCanonical(beta, *point.add_canonical());
}

// Answers beyond the range of double: deltas and betas that are next to 0.
Violations Overflows(const v1::EvaluatePairsRequest& request,
                     const v1::EvaluatePairsResponse& response) {
  Violations violations;
  const int pairs = std::min(request.delta_size(), response.points_size());
  for (int i = 0; i < pairs; ++i) {  // those of the first rho
    const v1::PairAnalytics& point = response.points(i);
    if (std::isfinite(point.tau_ball_piston()) && point.area_ball_piston() > 0) continue;
    violations.push_back(
        {Element("delta", i),
         absl::StrCat(NumberText(point.delta()),
                      " is too small: the mean free time leaves the range of double")});
  }
  for (int i = 0; i < response.points(0).canonical_size(); ++i) {
    const v1::CanonicalAnalytics& canonical = response.points(0).canonical(i);
    if (std::isfinite(canonical.mean_h())) continue;
    violations.push_back(
        {Element("beta", i), absl::StrCat(NumberText(canonical.beta()),
                                          " is too small: <h> leaves the range of double")});
  }
  return violations;
}

}  // namespace

absl::StatusOr<v1::EvaluatePairsResponse> EvaluatePairs(const v1::EvaluatePairsRequest& request) {
  const Violations violations = Check(request);
  if (!violations.empty()) return InvalidRequest(violations);
  v1::EvaluatePairsResponse response;
  for (const double rho : request.rho()) {
    for (const double delta : request.delta()) {
      const absl::StatusOr<PairGeometry> geometry = PairGeometry::Create(rho, delta);
      if (!geometry.ok()) return geometry.status();
      FillPoint(request, *geometry, *response.add_points());
    }
  }
  const Violations overflows = Overflows(request, response);
  if (!overflows.empty()) return InvalidRequest(overflows);
  return response;
}

}  // namespace ballpiston::server

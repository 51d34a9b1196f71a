#include "server/convert/analytic.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"
#include "core/arithmetic/number_text.h"
#include "core/closed_form/exchange_rate.h"
#include "core/closed_form/kernel.h"
#include "core/closed_form/mean_free_time.h"
#include "core/closed_form/pair_measures.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/temperature.h"
#include "server/convert/errors.h"

namespace ballpiston::server {
namespace {

using Violations = std::vector<FieldViolation>;

std::string Element(const char* field, int index) { return absl::StrCat(field, "[", index, "]"); }

void Add(const std::string& field, const absl::Status& status, Violations& violations) {
  if (!status.ok()) violations.push_back({field, std::string(status.message())});
}

// A long list may have an error in every element; more reported errors would not help the user.
bool Enough(const Violations& violations) { return violations.size() >= 1000; }

template <typename List, typename Allowed>
void CheckValues(const char* field, const List& values, Allowed allowed, absl::string_view range,
                 Violations& violations) {
  for (int i = 0; i < values.size() && !Enough(violations); ++i) {
    if (allowed(values.Get(i))) continue;
    violations.push_back(
        {Element(field, i), absl::StrCat(NumberText(values.Get(i)), " is not in ", range)});
  }
}

// The bound of delta falls as rho grows. So a delta that is invalid with any valid rho is invalid
// with the largest one.
void CheckPairs(const v1::EvaluatePairsRequest& request, Violations& violations) {
  double largest_rho = 0;  // of the valid values
  for (int i = 0; i < request.rho_size() && !Enough(violations); ++i) {
    const absl::Status status = ValidateRho(request.rho(i));
    Add(Element("rho", i), status, violations);
    if (status.ok()) largest_rho = std::max(largest_rho, request.rho(i));
  }
  for (int i = 0; i < request.delta_size() && !Enough(violations); ++i) {
    const double delta = request.delta(i);
    Add(Element("delta", i),
        largest_rho > 0 ? ValidatePairDelta(largest_rho, delta) : ValidatePositiveDelta(delta),
        violations);
  }
}

void CheckNotEmpty(const v1::EvaluatePairsRequest& request, Violations& violations) {
  if (request.rho_size() == 0) violations.push_back({"rho", "required: at least one value"});
  if (request.delta_size() == 0) violations.push_back({"delta", "required: at least one value"});
  if (request.outgoing_epsilon_size() > 0 && request.epsilon_size() == 0) {
    violations.push_back(
        {"outgoing_epsilon",
         "has values, but epsilon has none; required: at least one epsilon, the energy before the "
         "collision"});
  }
}

// The name of the list that contributes most to the answer.
const char* LongestList(const v1::EvaluatePairsRequest& request, double of_energies,
                        double of_temperatures) {
  if (of_energies >= of_temperatures) return "epsilon";
  return request.temperature_size() >= request.beta_size() ? "temperature" : "beta";
}

void CheckSize(const v1::EvaluatePairsRequest& request, Violations& violations) {
  const int64_t pairs = int64_t{request.rho_size()} * request.delta_size();
  if (pairs > kMaxPairs) {
    violations.push_back(
        {"rho", absl::StrCat(pairs, " pairs of rho and delta; at most ", kMaxPairs, " a call")});
    return;
  }
  const double of_energies = request.epsilon_size() * (6.0 + request.outgoing_epsilon_size());
  const double of_temperatures = 8.0 * (request.beta_size() + request.temperature_size());
  const double values = static_cast<double>(pairs) * (of_energies + of_temperatures);
  if (values <= static_cast<double>(kMaxAnalyticValues)) return;
  violations.push_back({LongestList(request, of_energies, of_temperatures),
                        absl::StrFormat("%.0f values in the answer (for each pair 6 + "
                                        "outgoing_epsilon an epsilon, 8 a beta or temperature); at "
                                        "most %d a call",
                                        values, kMaxAnalyticValues)});
}

void CheckTemperatures(const v1::EvaluatePairsRequest& request, Violations& violations) {
  const auto allowed = [](double x) { return x >= kMinTemperature && x <= kMaxTemperature; };
  const std::string range =
      absl::StrCat("[", NumberText(kMinTemperature), ", ", NumberText(kMaxTemperature), "]");
  CheckValues("beta", request.beta(), allowed, range, violations);
  CheckValues("temperature", request.temperature(), allowed, range, violations);
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
  CheckTemperatures(request, violations);
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
  energy.set_epsilon(epsilon + 0.0);  // 0 for -0
  energy.set_phi(Phi(epsilon));
  energy.set_f(PairCollisionRate(epsilon));
  energy.set_j(PairEnergyCurrent(epsilon));
  energy.set_h(PairSquaredEnergyTransfer(epsilon));
  energy.set_mean_free_time_conditional(ConditionalMeanFreeTime(geometry, epsilon));
  for (const double outgoing : request.outgoing_epsilon()) {
    energy.add_kernel(PairKernel(epsilon, outgoing));
  }
}

void FillCanonical(double beta, double temperature, const PairMeasures& measures, double rho,
                   v1::CanonicalAnalytics& canonical) {
  const CanonicalAverages averages = AveragesAt(beta);
  canonical.set_beta(beta);
  canonical.set_mean_f(averages.mean_f);
  canonical.set_mean_energy_current(averages.mean_energy_current);
  canonical.set_mean_h(averages.mean_h);
  canonical.set_temperature(temperature);
  canonical.set_exchange_rate(ExchangeRate(measures, temperature));
  canonical.set_static_conductivity(StaticConductivity(canonical.exchange_rate()));
  canonical.set_rare_limit_exchange_rate(RareLimitExchangeRate(rho, temperature));
}

void FillPoint(const v1::EvaluatePairsRequest& request, const PairGeometry& geometry,
               v1::PairAnalytics& point) {
  const PairMeasures measures = Measures(geometry);
  FillPair(geometry, measures, MeanFreeTimesFrom(measures), point);
  for (const double epsilon : request.epsilon()) {
    FillEnergy(request, geometry, epsilon, *point.add_energies());
  }
  const auto fill = [&](double beta, double temperature) {
    FillCanonical(beta, temperature, measures, geometry.rho(), *point.add_canonical());
  };
  for (const double beta : request.beta()) fill(beta, 1 / beta);
  for (const double temperature : request.temperature()) fill(1 / temperature, temperature);
}

bool RatesAreInRange(const v1::PairAnalytics& point) {
  return std::isfinite(point.tau_ball_piston()) && std::isnormal(point.area_ball_piston()) &&
         std::all_of(point.canonical().begin(), point.canonical().end(),
                     [](const auto& row) { return std::isnormal(row.static_conductivity()); });
}

// Violations for values beyond the range of double, which occur for deltas close to 0.
Violations Overflows(const v1::EvaluatePairsRequest& request,
                     const v1::EvaluatePairsResponse& response) {
  Violations violations;
  for (int i = 0; i < request.delta_size(); ++i) {
    for (int pair = i; pair < response.points_size(); pair += request.delta_size()) {
      const v1::PairAnalytics& point = response.points(pair);
      if (RatesAreInRange(point)) continue;
      violations.push_back(
          {Element("delta", i),
           absl::StrCat(NumberText(point.delta()),
                        " is too small at rho = ", NumberText(point.rho()),
                        ": the collision rate or its inverse leaves the range of double")});
      break;
    }
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

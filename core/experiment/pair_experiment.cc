#include "core/experiment/pair_experiment.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/arithmetic/number_text.h"
#include "core/billiard/billiard_domain.h"
#include "core/closed_form/pair_measures.h"
#include "core/experiment/expected_returns.h"

namespace ballpiston {
namespace {

// |dG_bp| of the smallest delta that is permitted. The mean free time is of order 1/|dG_bp|, and
// errors need its fourth power.
constexpr double kSmallestArea = 1e-70;

bool HasFiniteTimes(double rho, double delta) {
  return Measures(PairGeometry::Create(rho, delta).value()).area_ball_piston >= kSmallestArea;
}

// For small deltas |dG_bp| is sqrt2 lambda delta^2. The factor covers the rounding to two digits.
double SmallestDelta(double rho) {
  const double lambda = std::sqrt(4 * rho * rho - 1);
  return 1.1 * std::sqrt(kSmallestArea / (std::numbers::sqrt2 * lambda));
}

std::optional<std::string> WrongDelta(double smallest, double largest, double delta,
                                      DeltaValidation validate) {
  const absl::Status status = validate(largest, delta);
  if (!status.ok()) return std::string(status.message());
  if (HasFiniteTimes(smallest, delta)) return std::nullopt;
  return absl::StrFormat(
      "delta is %s, too small: powers of the mean free time leave the range of double; permitted "
      "at rho = "
      "%s: delta >= %.2g",
      NumberText(delta), NumberText(smallest), SmallestDelta(smallest));
}

const BilliardDomain& DomainOf(const EnsembleSpec& spec) {
  return spec.precision == Precision::kSingle ? kSingleDomain : kDoubleDomain;
}

// The beginning of the sentence that gives the domain.
std::string PermittedWith(const EnsembleSpec& spec) {
  if (spec.precision == Precision::kSingle) return "permitted with precision single: ";
  return "permitted with the models billiard and billiard_reference: ";
}

std::string OtherModels(const EnsembleSpec& spec) {
  if (spec.experiment == nullptr) return "";  // a trace belongs to no experiment
  std::vector<absl::string_view> names;
  for (const Model model : spec.experiment->models()) {
    if (!IsABilliard(model)) names.push_back(Name(model));
  }
  if (names.empty()) return absl::StrCat("; no other model answers ", spec.experiment->name);
  return absl::StrCat("; at other values these models answer ", spec.experiment->name, ": ",
                      absl::StrJoin(names, ", "));
}

std::string RangeOfRhoIn(const BilliardDomain& domain) {
  return absl::StrCat(NumberText(domain.min_rho), domain.HasRho(kMinRho) ? " < " : " <= ",
                      "rho <= ", NumberText(domain.max_rho));
}

std::string RangeOfDeltaIn(const BilliardDomain& domain) {
  return absl::StrCat("delta >= ", NumberText(domain.min_delta));
}

std::string RangeOfEpsilonIn(const BilliardDomain& domain) {
  if (domain.min_epsilon == 0) return "epsilon >= 0";
  return absl::StrCat("epsilon = 0 or epsilon >= ", NumberText(domain.min_epsilon));
}

}  // namespace

PairGeometry GeometryOf(const PointParameters& point) {
  return PairGeometry::Create(point[kRho], point[kDelta]).value();
}

bool IsSoundForBilliard(const EnsembleSpec& spec, const PointParameters& point) {
  const BilliardDomain& domain = DomainOf(spec);
  return domain.HasRho(point[kRho]) && domain.HasDelta(point[kDelta]) &&
         domain.HasEpsilon(point.Find(kEpsilon).value_or(0));
}

void CheckBilliardDomain(const EnsembleSpec& spec, std::vector<FieldViolation>& found) {
  const bool is_single = spec.model == Model::kAuto && spec.precision == Precision::kSingle;
  if (!is_single && !IsABilliard(spec.model)) return;
  const BilliardDomain& domain = DomainOf(spec);
  const auto refuse = [&](absl::string_view name, size_t i, double value, const auto& range_in) {
    std::string permitted = range_in(domain);
    if (spec.precision == Precision::kSingle) {
      absl::StrAppend(&permitted, "; with precision double: ", range_in(kDoubleDomain));
    }
    found.push_back({absl::StrFormat("grid.%s[%d]", name, i),
                     absl::StrCat(name, " is ", NumberText(value), "; ", PermittedWith(spec),
                                  permitted, OtherModels(spec))});
  };
  const auto check = [&](const Parameter& parameter, const auto& has, const auto& range_in) {
    const std::vector<double>& values = spec.grid[parameter];
    for (size_t i = 0; i < values.size(); ++i) {
      if (!(domain.*has)(values[i])) refuse(parameter.name, i, values[i], range_in);
    }
  };
  check(kRho, &BilliardDomain::HasRho, RangeOfRhoIn);
  check(kDelta, &BilliardDomain::HasDelta, RangeOfDeltaIn);
  check(kEpsilon, &BilliardDomain::HasEpsilon, RangeOfEpsilonIn);
}

// The largest rho has the smallest bound, and the smallest rho has the longest times, so it
// is enough to check each delta with these two.
void CheckDeltas(const Grid& grid, DeltaValidation validate, std::vector<FieldViolation>& found) {
  const std::vector<double>& deltas = grid[kDelta];
  for (size_t i = 0; i < deltas.size(); ++i) {
    const auto [smallest, largest] = std::ranges::minmax(grid.Beside(kDelta, i, kRho));
    if (const auto wrong = WrongDelta(smallest, largest, deltas[i], validate)) {
      found.push_back({absl::StrFormat("grid.delta[%d]", i), *wrong});
    }
  }
}

void CheckPairGrid(const EnsembleSpec& spec, std::vector<FieldViolation>& found) {
  CheckDeltas(spec.grid, ValidatePairDelta, found);
  CheckBilliardDomain(spec, found);
}

SampleWork WorkOfACollision(const PairGeometry& geometry) {
  const PredictedHits hits = HitsPerCollision(geometry);
  return {.ball_wall = hits.ball_wall, .piston_wall = hits.piston_wall, .collisions = 1};
}

}  // namespace ballpiston

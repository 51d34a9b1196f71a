#include "core/geometry/pair_geometry.h"

#include <algorithm>
#include <cmath>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "core/arithmetic/number_text.h"

namespace ballpiston {
namespace {

absl::Status ValidateDelta(double rho, double delta, double bound, absl::string_view formula,
                           absl::string_view whose) {
  if (delta > 0 && delta <= bound * (1 + kDeltaSlack)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("delta is ", NumberText(delta), "; permitted at rho = ", NumberText(rho),
                   ": 0 < delta <= ", formula, " = ", NumberText(bound), ", ", whose));
}

}  // namespace

double Lambda(double rho) {
  // Both factors are exact or correctly rounded. 4 rho^2 - 1 would lose all digits for rho -> 1/2.
  return std::sqrt((2 * rho - 1) * (2 * rho + 1));
}

double PairDeltaBound(double rho) {
  // (1 - lambda)/2 times (1 + lambda)/(1 + lambda). The fused product keeps 1 - 2 rho^2 exact to an
  // ulp for rho -> 1/sqrt(2), where the cell vanishes.
  return std::fma(-2 * rho, rho, 1) / (1 + Lambda(rho));
}

double GasDeltaBound(double rho) {
  // Likewise: (rho^2/2 - lambda^2/4)/(rho/sqrt(2) + lambda/2), with numerator (1 - 2 rho^2)/4.
  return std::fma(-2 * rho, rho, 1) / (2 * (rho * M_SQRT2 + Lambda(rho)));
}

absl::Status ValidateRho(double rho) {
  if (rho > kMinRho && rho < kMaxRho) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "rho is ", NumberText(rho), "; permitted: 1/2 < rho < 1/sqrt(2) = ", NumberText(kMaxRho)));
}

absl::Status ValidatePairDelta(double rho, double delta) {
  return ValidateDelta(rho, delta, PairDeltaBound(rho), "(1 - lambda)/2",
                       "the bound of a ball-piston pair");
}

absl::Status ValidateGasDelta(double rho, double delta) {
  return ValidateDelta(rho, delta, GasDeltaBound(rho), "rho/sqrt(2) - lambda/2",
                       "the bound of a gas, where no two pistons may overlap");
}

absl::Status ValidatePositiveDelta(double delta) {
  if (delta > 0) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("delta is ", NumberText(delta), "; permitted: 0 < delta <= (1 - lambda)/2"));
}

absl::StatusOr<PairGeometry> PairGeometry::Create(double rho, double delta) {
  if (absl::Status status = ValidateRho(rho); !status.ok()) return status;
  if (absl::Status status = ValidatePairDelta(rho, delta); !status.ok()) return status;
  return PairGeometry(rho, delta);
}

PairGeometry::PairGeometry(double rho, double delta)
    : rho_(rho),
      delta_(std::fmin(delta, PairDeltaBound(rho))),
      lambda_(Lambda(rho)),
      tip_(PairDeltaBound(rho)),
      piston_left_(tip_ - delta_),
      piston_right_(0.5 + lambda_ / 2 + delta_) {}

double PairGeometry::CentreToArc(double depth) const {
  // 4 s^2 = 1 - 4 t (t + lambda). The factor 1 - 2 t is exact for t > 1/4. This matters for
  // t -> 1/2 and lambda -> 0, where s tends to lambda/2.
  const double square = (1 - 2 * depth) * (1 + 2 * depth) - 4 * depth * lambda_;
  return std::sqrt(std::max(square, 0.0)) / 2;
}

double PairGeometry::HalfHeight(double depth) const {
  return depth * (depth + lambda_) / (0.5 + CentreToArc(depth));
}

}  // namespace ballpiston

#include "core/experiment/pair_experiment.h"

#include <cmath>
#include <limits>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/arithmetic/number_text.h"
#include "core/billiard/single_precision.h"
#include "core/closed_form/pair_measures.h"

namespace ballpiston {
namespace {

bool HasFiniteTimes(double rho, double delta) {
  const PairMeasures measures = Measures(PairGeometry::Create(rho, delta).value());
  // A denormal number is also too small, because it has lost digits.
  return measures.area_ball_piston >= std::numeric_limits<double>::min();
}

std::optional<std::string> WrongDelta(double smallest, double largest, double delta,
                                      DeltaValidation validate) {
  const absl::Status status = validate(largest, delta);
  if (!status.ok()) return std::string(status.message());
  if (HasFiniteTimes(smallest, delta)) return std::nullopt;
  return absl::StrCat("delta is ", NumberText(delta),
                      ", too small: the mean free time leaves the range of double");
}

// The smallest and the largest valid rho.
struct RangeOfRho {
  double smallest = kMaxRho;
  double largest = kMinRho;
  bool IsEmpty() const { return largest == kMinRho; }
};

RangeOfRho RangeIn(const Grid& grid) {
  RangeOfRho range;
  for (const double rho : grid[kRho]) {
    if (!ValidateRho(rho).ok()) continue;
    range.largest = std::fmax(range.largest, rho);
    range.smallest = std::fmin(range.smallest, rho);
  }
  return range;
}

void CheckSinglePrecision(const Grid& grid, std::vector<FieldViolation>& found) {
  const std::vector<double>&radii = grid[kRho], &deltas = grid[kDelta];
  for (size_t i = 0; i < radii.size(); ++i) {
    if (!ValidateRho(radii[i]).ok() || IsRhoForSinglePrecision(radii[i])) continue;
    found.push_back({absl::StrFormat("grid.rho[%d]", i),
                     absl::StrCat("rho is ", NumberText(radii[i]),
                                  "; permitted with precision single: ", NumberText(kSingleMinRho),
                                  " <= rho <= ", NumberText(kSingleMaxRho))});
  }
  for (size_t i = 0; i < deltas.size(); ++i) {
    if (!ValidateSomeDelta(deltas[i]).ok() || deltas[i] >= kSingleMinDelta) continue;
    found.push_back({absl::StrFormat("grid.delta[%d]", i),
                     absl::StrCat("delta is ", NumberText(deltas[i]),
                                  "; permitted with precision single: delta >= ",
                                  NumberText(kSingleMinDelta))});
  }
}

}  // namespace

PairGeometry GeometryOf(const PointParameters& point) {
  return PairGeometry::Create(point[kRho], point[kDelta]).value();
}

// The largest valid rho has the smallest bound, and the smallest rho has the longest times, so it
// is enough to check each delta with these two.
void CheckDeltas(const Grid& grid, DeltaValidation validate, std::vector<FieldViolation>& found) {
  const RangeOfRho range = RangeIn(grid);
  if (range.IsEmpty()) return;
  const std::vector<double>& deltas = grid[kDelta];
  for (size_t i = 0; i < deltas.size(); ++i) {
    if (!ValidateSomeDelta(deltas[i]).ok()) continue;  // already reported
    if (const auto wrong = WrongDelta(range.smallest, range.largest, deltas[i], validate)) {
      found.push_back({absl::StrFormat("grid.delta[%d]", i), *wrong});
    }
  }
}

void CheckPairGrid(const EnsembleSpec& spec, std::vector<FieldViolation>& found) {
  CheckDeltas(spec.grid, ValidatePairDelta, found);
  if (RangeIn(spec.grid).IsEmpty()) return;
  if (spec.precision == Precision::kSingle) CheckSinglePrecision(spec.grid, found);
}

SampleWork WorkOfACollision(const PairGeometry& geometry) {
  const PredictedHits hits = HitsPerCollision(geometry);
  return {.ball_wall = hits.ball_wall, .piston_wall = hits.piston_wall, .collisions = 1};
}

}  // namespace ballpiston

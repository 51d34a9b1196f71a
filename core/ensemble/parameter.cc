#include "core/ensemble/parameter.h"

#include "absl/strings/str_cat.h"
#include "core/arithmetic/number_text.h"
#include "core/gas/gas_shape.h"
#include "core/geometry/temperature.h"

namespace ballpiston {
namespace {

absl::Status InRange(const Parameter& parameter, double value, double lower, double upper) {
  if (value >= lower && value <= upper) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(parameter.name, " is ", NumberText(value),
                                                 "; permitted: [", lower, ", ", upper, "]"));
}

absl::Status IsTemperature(const Parameter& parameter, double value) {
  return InRange(parameter, value, kMinTemperature, kMaxTemperature);
}

bool IsCodeOfShape(double value) {
  constexpr double kAboveAllCodes = 0x1p41;
  if (!(value >= 1 && value < kAboveAllCodes)) return false;  // NaN too; the others fit an integer
  const GasShape shape = ShapeOf(value);
  return shape.cells() >= 1 && shape.cells() <= kMaxCells && CodeOf(shape) == value;
}

}  // namespace

absl::Status ValidateEpsilon(double epsilon) { return InRange(kEpsilon, epsilon, 0, 0.5); }

absl::Status ValidateExponent(double exponent) {
  return InRange(kExponent, exponent, 0, kMaxExponent);
}

absl::Status ValidateCells(double cells) {
  if (IsCodeOfShape(cells)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("cells is the code ", NumberText(cells),
                                                 "; permitted: codes of N or NxM, 1 to ", kMaxCells,
                                                 " cells in all"));
}

absl::Status ValidateTemperature(double temperature) {
  return IsTemperature(kTemperature, temperature);
}

absl::Status ValidateHot(double temperature) { return IsTemperature(kHot, temperature); }

absl::Status ValidateCold(double temperature) { return IsTemperature(kCold, temperature); }

PointParameters::PointParameters(
    std::initializer_list<std::pair<const Parameter&, std::optional<double>>> values) {
  for (const auto& [parameter, value] : values) Set(parameter, value);
}

Grid::Grid(std::initializer_list<std::pair<const Parameter&, std::vector<double>>> lists) {
  for (const auto& [parameter, values] : lists) (*this)[parameter] = values;
}

double Grid::PointCount() const {
  double points = 1;
  for (const std::vector<double>& list : lists_) {
    if (!list.empty()) points *= static_cast<double>(list.size());
  }
  return points;
}

PointParameters Grid::PointAt(size_t index) const {
  PointParameters point;
  for (size_t i = kParameters.size(); i-- > 0;) {
    if (lists_[i].empty()) continue;
    point.Set(*kParameters[i], lists_[i][index % lists_[i].size()]);
    index /= lists_[i].size();
  }
  return point;
}

}  // namespace ballpiston

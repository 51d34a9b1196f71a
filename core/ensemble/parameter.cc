#include "core/ensemble/parameter.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/arithmetic/number_text.h"

namespace ballpiston {
namespace {

absl::Status InRange(const Parameter& parameter, double value, double lower, double upper) {
  if (value >= lower && value <= upper) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(parameter.name, " is ", NumberText(value),
                                                 "; permitted: [", lower, ", ", upper, "]"));
}

}  // namespace

absl::Status ValidateEpsilon(double epsilon) { return InRange(kEpsilon, epsilon, 0, 0.5); }

absl::Status ValidateExponent(double exponent) {
  return InRange(kExponent, exponent, 0, kMaxExponent);
}

absl::Status ValidateCells(double cells) {
  if (cells == std::floor(cells)) return InRange(kCells, cells, 1, kMaxCells);
  return absl::InvalidArgumentError(
      absl::StrCat("cells is ", NumberText(cells), "; permitted: whole numbers"));
}

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

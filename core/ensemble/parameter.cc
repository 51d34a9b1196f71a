#include "core/ensemble/parameter.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "core/arithmetic/number_text.h"
#include "core/gas/gas_shape.h"

namespace ballpiston {
namespace {

bool IsCodeOfShape(double value) {
  constexpr double kAboveAllCodes = 0x1p41;
  if (!(value >= 1 && value < kAboveAllCodes)) return false;  // NaN too; the others fit an integer
  const GasShape shape = ShapeOf(value);
  return shape.cells() >= 1 && shape.cells() <= kMaxCells && CodeOf(shape) == value;
}

}  // namespace

absl::Status Parameter::Validate(double value) const {
  if (validate != nullptr) return validate(value);
  if (value >= lower && value <= upper) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(name, " is ", NumberText(value), "; permitted: [", lower, ", ", upper, "]"));
}

absl::Status ValidateCells(double cells) {
  if (IsCodeOfShape(cells)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("cells is the code ", NumberText(cells),
                                                 "; permitted: codes of N or NxM, 1 to ", kMaxCells,
                                                 " cells in all"));
}

PointParameters::PointParameters(
    std::initializer_list<std::pair<const Parameter&, std::optional<double>>> values) {
  for (const auto& [parameter, value] : values) Set(parameter, value);
}

Grid::Grid(std::initializer_list<std::pair<const Parameter&, std::vector<double>>> lists) {
  for (const auto& [parameter, values] : lists) (*this)[parameter] = values;
}

const Parameter* Grid::FirstColumn() const {
  const auto found = std::ranges::find_if(
      kParameters, [this](const Parameter* parameter) { return IsColumn(*parameter); });
  return found == kParameters.end() ? nullptr : *found;
}

std::span<const double> Grid::Beside(const Parameter& parameter, size_t index,
                                     const Parameter& other) const {
  const std::span<const double> values = (*this)[other];
  const bool are_of_a_row = IsColumn(parameter) && IsColumn(other);
  return are_of_a_row ? values.subspan(index, 1) : values;
}

double Grid::PointCount() const {
  const Parameter* const column = FirstColumn();
  double points = column == nullptr ? 1 : static_cast<double>((*this)[*column].size());
  for (const Parameter* parameter : kParameters) {
    const std::vector<double>& list = (*this)[*parameter];
    if (!IsColumn(*parameter) && !list.empty()) points *= static_cast<double>(list.size());
  }
  return points;
}

// + 0.0 makes 0 of -0: they are one value, and give the same bytes.
PointParameters Grid::PointAt(size_t index) const {
  PointParameters point;
  for (size_t i = kParameters.size(); i-- > 0;) {
    if (is_column_[i] || lists_[i].empty()) continue;
    point.Set(*kParameters[i], lists_[i][index % lists_[i].size()] + 0.0);
    index /= lists_[i].size();
  }
  for (const Parameter* parameter : kParameters) {
    if (IsColumn(*parameter)) point.Set(*parameter, (*this)[*parameter][index] + 0.0);
  }
  return point;
}

}  // namespace ballpiston

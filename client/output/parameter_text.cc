#include "client/output/parameter_text.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/output/number_text.h"

namespace ballpiston::client {
namespace {

using Digits = std::string (*)(double x);
using Point = v1::PointParameters;

std::string TenDigits(double x) { return absl::StrFormat("%.10g", x); }

template <bool (Point::*is_there)() const, double (Point::*value)() const>
std::string NumberOf(const Point& point, Digits digits) {
  return (point.*is_there)() ? digits((point.*value)()) : "";
}

std::string ShapeOf(const Point& point, Digits) { return point.cells(); }

struct OptionalParameter {
  const char* name;
  std::string (*text)(const Point& point, Digits digits);  // empty if the point lacks it
  int (v1::Grid::*size)() const;                           // of the grid's list
  bool in_every_csv = false;
};

constexpr OptionalParameter kOptional[kOptionalParameters] = {
    {"epsilon", NumberOf<&Point::has_epsilon, &Point::epsilon>, &v1::Grid::epsilon_size, true},
    {"exponent", NumberOf<&Point::has_exponent, &Point::exponent>, &v1::Grid::exponent_size, true},
    {"cells", ShapeOf, &v1::Grid::cells_size},
    {"temperature", NumberOf<&Point::has_temperature, &Point::temperature>,
     &v1::Grid::temperature_size},
    {"hot", NumberOf<&Point::has_hot, &Point::hot>, &v1::Grid::hot_size},
    {"cold", NumberOf<&Point::has_cold, &Point::cold>, &v1::Grid::cold_size}};

using ShownParameters = std::array<bool, kOptionalParameters>;

std::vector<std::string> TitlesOf(const ShownParameters& shown) {
  std::vector<std::string> titles = {"rho", "delta"};
  for (size_t i = 0; i < kOptionalParameters; ++i) {
    if (shown[i]) titles.push_back(kOptional[i].name);
  }
  return titles;
}

std::vector<std::string> CellsOf(const ShownParameters& shown, const Point& point, Digits digits) {
  std::vector<std::string> cells = {digits(point.rho()), digits(point.delta())};
  for (size_t i = 0; i < kOptionalParameters; ++i) {
    if (shown[i]) cells.push_back(kOptional[i].text(point, digits));
  }
  return cells;
}

}  // namespace

std::string ParameterText(const v1::PointParameters& parameters) {
  std::string text =
      absl::StrCat("rho ", TenDigits(parameters.rho()), ", delta ", TenDigits(parameters.delta()));
  for (const OptionalParameter& parameter : kOptional) {
    const std::string value = parameter.text(parameters, TenDigits);
    if (!value.empty()) absl::StrAppend(&text, ", ", parameter.name, " ", value);
  }
  return text;
}

ParameterColumns::ParameterColumns(const v1::Grid& grid) {
  for (size_t i = 0; i < kOptionalParameters; ++i) {
    const OptionalParameter& parameter = kOptional[i];
    // A copy, because the bounds sanitizer of GCC 12 wrongly rejects a call through the array.
    const auto size = parameter.size;
    shown_[i] = parameter.in_every_csv || (grid.*size)() > 0;
  }
}

std::vector<std::string> ParameterColumns::Titles() const { return TitlesOf(shown_); }

std::vector<std::string> ParameterColumns::Cells(const v1::PointParameters& parameters) const {
  return CellsOf(shown_, parameters, ExactText);
}

void ParametersShown::Include(const v1::PointParameters& parameters) {
  for (size_t i = 0; i < kOptionalParameters; ++i) {
    shown_[i] = shown_[i] || !kOptional[i].text(parameters, TenDigits).empty();
  }
}

std::vector<std::string> ParametersShown::Titles() const { return TitlesOf(shown_); }

std::vector<std::string> ParametersShown::Cells(const v1::PointParameters& parameters) const {
  return CellsOf(shown_, parameters, TenDigits);
}

}  // namespace ballpiston::client

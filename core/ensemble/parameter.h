// The parameters that span grids of questions.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/temperature.h"

namespace ballpiston {

// A single value is permitted from `lower` to `upper`. If there is a function `validate`, it
// decides instead.
struct Parameter {
  absl::string_view name;  // of the grid's list
  size_t index;            // in kParameters; determines random streams
  double lower = 0, upper = 0;
  absl::Status (*validate)(double value) = nullptr;

  absl::Status Validate(double value) const;  // name, value, permitted range
};

inline constexpr double kMaxExponent = 1000;

absl::Status ValidateCells(double cells);  // OK if `cells` is the code of a shape

inline constexpr Parameter kRho = {.name = "rho", .index = 0, .validate = ValidateRho};
inline constexpr Parameter kDelta = {
    .name = "delta", .index = 1, .validate = ValidatePositiveDelta};
inline constexpr Parameter kEpsilon = {"epsilon", 2, 0, 0.5};
inline constexpr Parameter kExponent = {"exponent", 3, 0, kMaxExponent};
// The shape of a gas, as the code that CodeOf of core/gas/gas_shape.h makes of it.
inline constexpr Parameter kCells = {.name = "cells", .index = 4, .validate = ValidateCells};
// The temperature of a gas in equilibrium, and those of the two reservoirs at the ends of a gas.
// The Boltzmann constant is 1 (core/geometry/temperature.h).
inline constexpr Parameter kTemperature = {"temperature", 5, kMinTemperature, kMaxTemperature};
inline constexpr Parameter kHot = {"hot", 6, kMinTemperature, kMaxTemperature};
inline constexpr Parameter kCold = {"cold", 7, kMinTemperature, kMaxTemperature};

// In the order of a grid's loops, outermost first.
inline constexpr std::array kParameters = {&kRho,   &kDelta,       &kEpsilon, &kExponent,
                                           &kCells, &kTemperature, &kHot,     &kCold};

// The values of one point; those that its experiment does not use are absent.
class PointParameters {
 public:
  PointParameters() = default;
  PointParameters(std::initializer_list<std::pair<const Parameter&, std::optional<double>>> values);

  double operator[](const Parameter& parameter) const { return *values_[parameter.index]; }
  const std::optional<double>& Find(const Parameter& parameter) const {
    return values_[parameter.index];
  }
  void Set(const Parameter& parameter, std::optional<double> value) {
    values_[parameter.index] = value;
  }

  friend bool operator==(const PointParameters&, const PointParameters&) = default;

 private:
  std::array<std::optional<double>, kParameters.size()> values_ = {};
};

// The product of lists. An empty list means that the parameter is absent at every point.
//
// Some lists can be the columns of a table: they have equally many values, and the values with the
// same index belong together. The grid is then the product of the table's rows and the other lists.
class Grid {
 public:
  Grid() = default;
  Grid(std::initializer_list<std::pair<const Parameter&, std::vector<double>>> lists);

  const std::vector<double>& operator[](const Parameter& parameter) const {
    return lists_[parameter.index];
  }
  std::vector<double>& operator[](const Parameter& parameter) { return lists_[parameter.index]; }

  void MakeColumn(const Parameter& parameter) { is_column_[parameter.index] = true; }
  bool IsColumn(const Parameter& parameter) const { return is_column_[parameter.index]; }
  // The first column; null without a table. The number of its values is that of the rows.
  const Parameter* FirstColumn() const;
  // The values of `other` that occur together with value `index` of `parameter`.
  std::span<const double> Beside(const Parameter& parameter, size_t index,
                                 const Parameter& other) const;

  // All columns must be equally long in these two functions.
  double PointCount() const;  // exact below 2^53
  // index < PointCount(). The last list varies fastest, the table slowest.
  PointParameters PointAt(size_t index) const;

 private:
  std::array<std::vector<double>, kParameters.size()> lists_ = {};
  std::array<bool, kParameters.size()> is_column_ = {};
};

}  // namespace ballpiston

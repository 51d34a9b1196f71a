#include "core/gas/gas_shape.h"

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace ballpiston {
namespace {

constexpr int64_t kRowUnit = int64_t{1} << 20;  // more than the columns of any shape

// Accepts only digits, without a sign and without blanks.
bool ParseCount(absl::string_view text, int64_t& count) {
  for (const char c : text) {
    if (!absl::ascii_isdigit(static_cast<unsigned char>(c))) return false;
  }
  return absl::SimpleAtoi(text, &count) && count >= 1 && count <= kMaxCells;
}

}  // namespace

absl::StatusOr<GasShape> ParseGasShape(absl::string_view text) {
  const std::pair<absl::string_view, absl::string_view> parts =
      absl::StrSplit(text, absl::MaxSplits('x', 1));
  GasShape shape = {.is_lattice = text.find('x') != absl::string_view::npos};
  const bool is_valid = ParseCount(parts.first, shape.columns) &&
                        (!shape.is_lattice || ParseCount(parts.second, shape.rows));
  if (is_valid && shape.cells() <= kMaxCells) return shape;
  return absl::InvalidArgumentError(absl::StrCat(
      "cells is \"", text, "\"; permitted: N or NxM, 1 to ", kMaxCells, " cells in all"));
}

std::string Text(const GasShape& shape) {
  if (!shape.is_lattice) return absl::StrCat(shape.columns);
  return absl::StrCat(shape.columns, "x", shape.rows);
}

double CodeOf(const GasShape& shape) {
  return static_cast<double>(shape.columns + (shape.is_lattice ? shape.rows * kRowUnit : 0));
}

GasShape ShapeOf(double code) {
  const auto number = static_cast<int64_t>(code);
  const int64_t rows = number / kRowUnit;
  return {.columns = number % kRowUnit, .rows = rows == 0 ? 1 : rows, .is_lattice = rows != 0};
}

}  // namespace ballpiston

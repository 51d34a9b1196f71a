// The shape of a gas: the number of its cells, and how they are joined.
//
// A chain of N cells, written "N": each ball meets a piston on its left and another on its right. A
// lattice of N x M cells, written "NxM": N columns along x and M rows along y; each ball meets four
// pistons. Both are periodic, except along x if there are reservoirs at the ends.
//
// A ring of one cell is permitted: its ball meets the same piston on both sides.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace ballpiston {

inline constexpr int64_t kMaxCells = 1'000'000;  // of a gas

struct GasShape {
  int64_t columns = 1;
  int64_t rows = 1;
  bool is_lattice = false;  // or a chain, which has one row

  int64_t cells() const { return columns * rows; }
  int directions() const { return is_lattice ? 4 : 2; }        // in which a ball has a piston
  int64_t contacts() const { return cells() * directions(); }  // pairs of ball and piston that meet

  friend bool operator==(const GasShape&, const GasShape&) = default;
};

// Parses "12" or "4x3". INVALID_ARGUMENT, with the text and the permitted values, unless the
// numbers are whole and there are 1 to kMaxCells cells in all.
absl::StatusOr<GasShape> ParseGasShape(absl::string_view text);

std::string Text(const GasShape& shape);

// A shape as a value of the parameter `cells`, a whole number below 2^41 that determines the shape.
double CodeOf(const GasShape& shape);
GasShape ShapeOf(double code);

}  // namespace ballpiston

#include "core/ensemble/parameter.h"

#include "core/gas/gas_shape.h"
#include "core/geometry/temperature.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

// The index is part of random streams and of stored records.
TEST(Parameter, IndexIsThePlaceInTheList) {
  constexpr const char* kNames[] = {"rho",   "delta",       "epsilon", "exponent",
                                    "cells", "temperature", "hot",     "cold"};
  ASSERT_EQ(kParameters.size(), std::size(kNames));
  for (size_t i = 0; i < kParameters.size(); ++i) {
    EXPECT_EQ(kParameters[i]->index, i);
    EXPECT_EQ(kParameters[i]->name, kNames[i]);
  }
}

TEST(Parameter, CodesOfShapesAreTheValuesOfCells) {
  for (const char* text :
       {"1", "1000000", "1x1", "1000000x1", "1x1000000", "1000x1000", "1x524288", "524288x1"}) {
    EXPECT_OK(kCells.Validate(CodeOf(ParseGasShape(text).value()))) << text;
  }
  constexpr double kRow = 0x1p20;  // the code of a lattice without columns
  for (const double value : {0.0, -1.0, 0.5, 12.5, 1e6 + 1, kRow - 1, kRow, kRow + 0.5, 3 * kRow,
                             CodeOf({.columns = 1001, .rows = 1000, .is_lattice = true}),
                             CodeOf({.columns = 1, .rows = 1'000'001, .is_lattice = true}), 0x1p41,
                             0x1p63, 1e300, HUGE_VAL, -HUGE_VAL, std::nan("")}) {
    EXPECT_THAT(kCells.Validate(value),
                StatusIs(absl::StatusCode::kInvalidArgument,
                         HasSubstr("permitted: codes of N or NxM, 1 to 1000000 cells in all")))
        << value;
  }
  EXPECT_THAT(kCells.Validate(0.5).message(), HasSubstr("cells is the code 0.5; "));
}

TEST(Parameter, RangesAreClosedToTheLastBit) {
  const std::tuple<const Parameter*, double, double, const char*> kRanges[] = {
      {&kEpsilon, 0, 0.5, "[0, 0.5]"},
      {&kExponent, 0, kMaxExponent, "[0, 1000]"},
      {&kTemperature, kMinTemperature, kMaxTemperature, "[1e-120, 1e+120]"},
      {&kHot, kMinTemperature, kMaxTemperature, "[1e-120, 1e+120]"},
      {&kCold, kMinTemperature, kMaxTemperature, "[1e-120, 1e+120]"}};
  for (const auto& [parameter, lower, upper, permitted] : kRanges) {
    for (const double value : {lower, 0.25, upper}) {
      EXPECT_OK(parameter->Validate(value)) << parameter->name;
    }
    for (const double value : {std::nextafter(lower, -HUGE_VAL), std::nextafter(upper, HUGE_VAL),
                               HUGE_VAL, -HUGE_VAL, std::nan("")}) {
      EXPECT_THAT(parameter->Validate(value), StatusIs(absl::StatusCode::kInvalidArgument))
          << parameter->name << " " << value;
    }
    EXPECT_EQ(parameter->Validate(-1).message(),
              absl::StrCat(parameter->name, " is -1; permitted: ", permitted));
  }
}

TEST(Grid, APointHasZeroForMinusZero) {
  const Grid grid = {{kEpsilon, {-0.0, 0.0}}};
  EXPECT_FALSE(std::signbit(grid.PointAt(0)[kEpsilon]));
}

}  // namespace
}  // namespace ballpiston

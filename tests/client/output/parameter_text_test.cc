#include "client/output/parameter_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/client/message_text.h"

namespace ballpiston::client {
namespace {

using ::testing::ElementsAre;

v1::PointParameters ParametersOf(const std::string& text) {
  return FromText<v1::PointParameters>("rho: 0.53 delta: 0.1 " + text);
}

constexpr char kAll[] =
    R"(epsilon: 0.25 exponent: 1 cells: "4x3" temperature: 1.00000000001 hot: 2 cold: 0)";

TEST(ParameterText, NamesTheParametersOfThePoint) {
  EXPECT_EQ(ParameterText(ParametersOf("")), "rho 0.53, delta 0.1");
  EXPECT_EQ(ParameterText(ParametersOf(kAll)),
            "rho 0.53, delta 0.1, epsilon 0.25, exponent 1, cells 4x3, temperature 1, hot 2, "
            "cold 0");
}

TEST(ParameterColumns, OfAPairAreTheSameInEveryFile) {
  const ParameterColumns columns{v1::Grid()};
  EXPECT_THAT(columns.Titles(), ElementsAre("rho", "delta", "epsilon", "exponent"));
  EXPECT_THAT(columns.Cells(ParametersOf("")), ElementsAre("0.53", "0.1", "", ""));
}

TEST(ParameterColumns, OfAGasAreThoseOfTheGrid) {
  const ParameterColumns conduction{
      FromText<v1::Grid>("cells: ['4x3', '8'] hot: [2, 3] cold: 1 rho: 0.53")};
  EXPECT_THAT(conduction.Titles(),
              ElementsAre("rho", "delta", "epsilon", "exponent", "cells", "hot", "cold"));
  EXPECT_THAT(conduction.Cells(ParametersOf("cells: '4x3' hot: 2 cold: 1")),
              ElementsAre("0.53", "0.1", "", "", "4x3", "2", "1"));
  const ParameterColumns equilibrium{FromText<v1::Grid>("temperature: 1")};
  EXPECT_THAT(equilibrium.Titles(),
              ElementsAre("rho", "delta", "epsilon", "exponent", "temperature"));
  EXPECT_THAT(equilibrium.Cells(ParametersOf(kAll)),
              ElementsAre("0.53", "0.1", "0.25", "1", "1.00000000001"));  // exact
}

TEST(ParametersShown, AreTheParametersOfAnyPoint) {
  ParametersShown shown;
  EXPECT_THAT(shown.Titles(), ElementsAre("rho", "delta"));
  shown.Include(ParametersOf("temperature: 0.5"));
  shown.Include(ParametersOf("cells: '12' cold: 0"));
  shown.Include(ParametersOf(""));
  EXPECT_THAT(shown.Titles(), ElementsAre("rho", "delta", "cells", "temperature", "cold"));
  EXPECT_THAT(shown.Cells(ParametersOf("cells: '12' cold: 0")),
              ElementsAre("0.53", "0.1", "12", "", "0"));
  EXPECT_THAT(shown.Cells(ParametersOf(kAll)), ElementsAre("0.53", "0.1", "4x3", "1", "0"));
}

}  // namespace
}  // namespace ballpiston::client

#include "client/output/parameter_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/message_text.h"

namespace ballpiston::client {
namespace {

using ::testing::ElementsAre;

v1::PointParameters At(const std::string& text) {
  return FromText<v1::PointParameters>("rho: 0.53 delta: 0.1 " + text);
}

constexpr char kAll[] =
    R"(epsilon: 0.25 exponent: 1 cells: "4x3" temperature: 1.00000000001 hot: 2 cold: 0)";

TEST(ParameterText, NamesTheParametersOfThePoint) {
  EXPECT_EQ(ParameterText(At("")), "rho 0.53, delta 0.1");
  EXPECT_EQ(ParameterText(At(kAll)),
            "rho 0.53, delta 0.1, epsilon 0.25, exponent 1, cells 4x3, temperature 1, hot 2, "
            "cold 0");
}

TEST(ParametersInCsv, OfAPairAreTheSameInEveryFile) {
  EXPECT_THAT(ParametersInCsv(v1::Grid()), ElementsAre("rho", "delta", "epsilon", "exponent"));
}

TEST(ParametersInCsv, OfAGasAreThoseOfTheGrid) {
  EXPECT_THAT(ParametersInCsv(FromText<v1::Grid>("cells: ['4x3', '8'] hot: [2, 3] cold: 1")),
              ElementsAre("rho", "delta", "epsilon", "exponent", "cells", "hot", "cold"));
  EXPECT_THAT(ParametersInCsv(FromText<v1::Grid>("temperature: 1")),
              ElementsAre("rho", "delta", "epsilon", "exponent", "temperature"));
}

TEST(ParametersOfPoints, AreTheParametersOfAnyPoint) {
  std::vector<v1::PointResult> points;
  EXPECT_THAT(ParametersOf(points), ElementsAre("rho", "delta"));
  for (const char* text : {"temperature: 0.5", "cells: '12' cold: 0", ""}) {
    *points.emplace_back().mutable_parameters() = At(text);
  }
  EXPECT_THAT(ParametersOf(points), ElementsAre("rho", "delta", "cells", "temperature", "cold"));
}

}  // namespace
}  // namespace ballpiston::client

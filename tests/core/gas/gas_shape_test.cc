#include "core/gas/gas_shape.h"

#include <cmath>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/status_matchers.h"

namespace ballpiston {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(GasShape, ParsesChainsAndLattices) {
  EXPECT_THAT(ParseGasShape("1"), IsOkAndHolds(GasShape{1, 1, false}));
  EXPECT_THAT(ParseGasShape("12"), IsOkAndHolds(GasShape{12, 1, false}));
  EXPECT_THAT(ParseGasShape("4x3"), IsOkAndHolds(GasShape{4, 3, true}));
  EXPECT_THAT(ParseGasShape("7x1"), IsOkAndHolds(GasShape{7, 1, true}));
  EXPECT_THAT(ParseGasShape("1x1"), IsOkAndHolds(GasShape{1, 1, true}));
  EXPECT_THAT(ParseGasShape("1000000"), IsOkAndHolds(GasShape{1'000'000, 1, false}));
  EXPECT_THAT(ParseGasShape("1000x1000"), IsOkAndHolds(GasShape{1000, 1000, true}));
  EXPECT_THAT(ParseGasShape("1x1000000"), IsOkAndHolds(GasShape{1, 1'000'000, true}));
}

TEST(GasShape, ARowOfALatticeDiffersFromAChain) {
  EXPECT_FALSE(ParseGasShape("7").value() == ParseGasShape("7x1").value());
  EXPECT_EQ(ParseGasShape("7").value().directions(), 2);
  EXPECT_EQ(ParseGasShape("7x1").value().directions(), 4);
}

TEST(GasShape, MalformedTextsAreRejectedAndQuoted) {
  for (const std::string text : {"",
                                 "0",
                                 "x",
                                 "4x",
                                 "x4",
                                 "4x0",
                                 "0x4",
                                 "-3",
                                 "+3",
                                 " 4",
                                 "4 ",
                                 "4\n",
                                 "4X4",
                                 "1e3",
                                 "4.0",
                                 "0x10",
                                 "4x4x4",
                                 "4xx4",
                                 "4x-1",
                                 "4 x 4",
                                 "1000001",
                                 "1001x1000",
                                 "four",
                                 "99999999999999999999",
                                 "4,4",
                                 "4x99999999999999999999",
                                 "99999999999999999999x4",
                                 "4294967296x4294967296"}) {
    EXPECT_THAT(ParseGasShape(text), StatusIs(absl::StatusCode::kInvalidArgument,
                                              AllOf(HasSubstr("cells is \"" + text + "\""),
                                                    HasSubstr("N or NxM"), HasSubstr("1000000"))));
  }
}

TEST(GasShape, TextAndCodeDetermineTheShape) {
  for (const std::string text : {"1", "2", "12", "1000000", "1x1", "2x1", "1x2", "4x3", "3x4",
                                 "1000x1000", "1000000x1", "1x1000000", "999999x1"}) {
    const GasShape shape = ParseGasShape(text).value();
    EXPECT_EQ(Text(shape), text);
    EXPECT_EQ(ShapeOf(CodeOf(shape)), shape) << text;
    EXPECT_EQ(CodeOf(shape), std::floor(CodeOf(shape)));
    EXPECT_LT(CodeOf(shape), 0x1p41);
  }
}

TEST(GasShape, CodesOfChainsAreTheirNumberOfCells) {
  EXPECT_EQ(CodeOf({.columns = 12}), 12);
  EXPECT_EQ(CodeOf({.columns = kMaxCells}), kMaxCells);
}

}  // namespace
}  // namespace ballpiston

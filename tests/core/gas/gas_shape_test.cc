#include "core/gas/gas_shape.h"

#include "absl/strings/str_split.h"
#include "tests/core/preamble.h"
#include "tests/support/status_matchers.h"

namespace ballpiston {
namespace {

TEST(GasShape, TextAndCodeDetermineTheShape) {
  for (const auto& [text, shape] : {std::pair<std::string, GasShape>("1", {1, 1, false}),
                                    {"12", {12, 1, false}},
                                    {"4x3", {4, 3, true}},
                                    {"7x1", {7, 1, true}},
                                    {"1x2", {1, 2, true}},
                                    {"1x1", {1, 1, true}},
                                    {"1000000", {1'000'000, 1, false}},
                                    {"1000x1000", {1000, 1000, true}},
                                    {"1x1000000", {1, 1'000'000, true}},
                                    {"1000000x1", {1'000'000, 1, true}}}) {
    EXPECT_THAT(ParseGasShape(text), IsOkAndHolds(shape)) << text;
    EXPECT_EQ(Text(shape), text);
    EXPECT_EQ(ShapeOf(CodeOf(shape)), shape) << text;
    EXPECT_EQ(CodeOf(shape), std::floor(CodeOf(shape)));
    EXPECT_LT(CodeOf(shape), 0x1p41);
    EXPECT_EQ(shape.directions(), shape.is_lattice ? 4 : 2);
    if (!shape.is_lattice) {
      EXPECT_EQ(CodeOf(shape), static_cast<double>(shape.columns));
    }
  }
}

TEST(GasShape, MalformedTextsAreRejectedAndQuoted) {
  const std::vector<std::string> malformed = absl::StrSplit(
      "|0|x|4x|x4|4x0|0x4|-3|+3| 4|4 |4\n|4X4|1e3|4.0|0x10|4x4x4|4xx4|4x-1|4 x 4|1000001|1001x1000|"
      "four|4,4|99999999999999999999|4x99999999999999999999|99999999999999999999x4|"
      "4294967296x4294967296",
      '|');
  for (const std::string& text : malformed) {
    EXPECT_THAT(ParseGasShape(text), StatusIs(absl::StatusCode::kInvalidArgument,
                                              AllOf(HasSubstr("cells is \"" + text + "\""),
                                                    HasSubstr("N or NxM"), HasSubstr("1000000"))));
  }
}

}  // namespace
}  // namespace ballpiston

#include "client/command/spec_file.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

TEST(SpecFile, ReadsProtoJsonWithEitherFieldNames) {
  ASSERT_OK_AND_ASSIGN(const v1::EnsembleSpec spec,
                       ParseSpec("s.json", R"({"experiment": "FIRST_HIT", "grid": {"rho": [0.53]},
                              "target": {"samples": "100", "estimate": "conductivity"},
                              "seed": 7})"));
  EXPECT_EQ(spec.target().samples(), 100);
  EXPECT_EQ(spec.target().estimate(), "conductivity");
  EXPECT_EQ(spec.seed(), 7u);
}

TEST(SpecFile, ZeroHasNoSignInAnyNotation) {
  for (const char* zero : {"-0", "-0.0", "-.0", "-0e5", "0"}) {
    ASSERT_OK_AND_ASSIGN(
        const v1::EnsembleSpec spec,
        ParseSpec("s.json", absl::StrCat(R"({"grid": {"epsilon": [0.1, )", zero,
                                         R"(]}, "target": {"tolerance": )", zero, "}}")));
    EXPECT_EQ(spec.grid().epsilon(0), 0.1);
    for (const double number : {spec.grid().epsilon(1), spec.target().tolerance()}) {
      EXPECT_EQ(number, 0);
      EXPECT_FALSE(std::signbit(number)) << zero;
    }
  }
  EXPECT_FALSE(ParseSpec("s.json", "{}")->has_grid());
}

TEST(SpecFile, ReadsTheParametersOfAGas) {
  ASSERT_OK_AND_ASSIGN(
      const v1::EnsembleSpec spec,
      ParseSpec("s.json", R"({"grid": {"cells": ["12", "4x3"], "temperature": [-0.0, 0.5],
                                       "hot": [-0.0, 2], "cold": [-0.0, 1]}})"));
  EXPECT_THAT(spec.grid().cells(), testing::ElementsAre("12", "4x3"));
  EXPECT_EQ(spec.grid().temperature(1), 0.5);
  EXPECT_EQ(spec.grid().hot(1), 2);
  EXPECT_EQ(spec.grid().cold(1), 1);
  for (const double number :
       {spec.grid().temperature(0), spec.grid().hot(0), spec.grid().cold(0)}) {
    EXPECT_FALSE(std::signbit(number));
  }
}

TEST(SpecFile, RejectsOtherTexts) {
  for (const char* text :
       {"", "   ", "null", "\"FIRST_HIT\"", "[]", "7", "{", "{]", "not json", "{\"sed\": 1}",
        "{\"grid\": {\"rho\": [\"x\"]}}", "{\"experiment\": \"NO_SUCH\"}",
        "{\"target\": {\"samples\": 1, \"tolerance\": 0.1}}", "{\"seed\": -1}", "{} {}"}) {
    EXPECT_THAT(ParseSpec("s.json", text),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("--spec s.json: ")))
        << text;
  }
}

TEST(SpecFile, NamesTheUnknownField) {
  EXPECT_THAT(ParseSpec("s.json", R"({"experiment": "FIRST_HIT", "sed": 1})"),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("sed")));
}

// The message of the JSON parser repeats the whole value.
TEST(SpecFile, ErrorShortensALongValue) {
  const std::string name = "HEAD" + std::string(300'000, 'X') + "TAIL";
  const auto spec = ParseSpec("s.json", R"({"experiment": ")" + name + "\"}");
  const std::string message(spec.status().message());
  EXPECT_LT(message.size(), 1'100u);
  EXPECT_THAT(message, HasSubstr("HEAD"));
  EXPECT_THAT(message, HasSubstr("XTAIL"));
}

}  // namespace
}  // namespace ballpiston::client

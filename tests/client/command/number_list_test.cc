#include "client/command/number_list.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

using ::testing::DoubleEq;

std::vector<double> List(const std::string& text) {
  const auto list = ParseNumberList(text);
  EXPECT_OK(list);
  return list.value_or(std::vector<double>());
}

TEST(NumberList, ReadsNumbersInAnyDecimalForm) {
  EXPECT_THAT(List("0.1,2,-3.5,1e-5,2.5E3,.5"), ElementsAre(0.1, 2, -3.5, 1e-5, 2500, 0.5));
}

TEST(NumberList, RangeHasBothItsEndsAndEvenSteps) {
  EXPECT_THAT(List("0:1:11"), ElementsAre(0, .1, .2, .3, .4, .5, .6, .7, .8, .9, 1));
}

TEST(NumberList, RangeMayFall) { EXPECT_THAT(List("0.3:0.1:3"), ElementsAre(0.3, 0.2, 0.1)); }

TEST(NumberList, LogarithmicRangeHasEvenRatios) {
  EXPECT_THAT(List("1e-3:1:4:log"), ElementsAre(1e-3, DoubleEq(1e-2), DoubleEq(1e-1), 1));
}

TEST(NumberList, RangeWithCountOneIsItsFirstEnd) {
  EXPECT_THAT(List("0.2:0.9:1"), ElementsAre(0.2));
}

TEST(NumberList, CommasAndRangesMix) {
  EXPECT_THAT(List("0.1,0.2:0.3:3,7"), ElementsAre(0.1, 0.2, 0.25, 0.3, 7));
}

TEST(NumberList, RejectsOtherTextsWithAReason) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "'' is not a decimal number"},
      {",", "is not a decimal number"},
      {"0.1,", "'' is not a decimal number"},
      {"0.1,,0.2", "'' is not a decimal number"},
      {" 0.1", "' 0.1' is not a decimal number"},
      {"0.1 ", "is not a decimal number"},
      {"nan", "'nan' is not a decimal number"},
      {"-nan", "is not a decimal number"},
      {"inf", "'inf' is not a decimal number"},
      {"-Infinity", "is not a decimal number"},
      {"1e999", "'1e999' is not a decimal number"},
      {"0x10", "is not a decimal number"},
      {"1/2", "'1/2' is not a decimal number"},
      {"+1", "is not a decimal number"},
      {"--1", "is not a decimal number"},
      {"1e", "is not a decimal number"},
      {"e5", "is not a decimal number"},
      {".", "is not a decimal number"},
      {"0.1.2", "is not a decimal number"},
      {"0,1;2", "'1;2' is not a decimal number"},
      {"abc", "is not a decimal number"},
      {"\xc2\xbd", "is not a decimal number"},
      {"0.1:0.2", "write FROM:TO:COUNT"},
      {":", "write FROM:TO:COUNT"},
      {"0:1:3:lin", "write FROM:TO:COUNT"},
      {"0:1:3:log:x", "write FROM:TO:COUNT"},
      {":1:3", "has an end that is not a decimal number"},
      {"0::3", "has an end that is not a decimal number"},
      {"nan:1:3", "has an end that is not a decimal number"},
      {"0:inf:3", "has an end that is not a decimal number"},
      {"0:1:", "a whole number from 1 to 100000"},
      {"0:1:0", "a whole number from 1 to 100000"},
      {"0:1:-3", "a whole number from 1 to 100000"},
      {"0:1:2.5", "a whole number from 1 to 100000"},
      {"0:1:100001", "a whole number from 1 to 100000"},
      {"0:1:1e300", "a whole number from 1 to 100000"},
      {"0:1:99999999999999999999", "a whole number from 1 to 100000"},
      {"0:1:3:log", "both ends must be above 0"},
      {"-1:1:3:log", "both ends must be above 0"},
      {"1e-300:1e300:3:log", "beyond 1e100"},
      {"0:1:100000,5", "'0:1:100000,5' has more than 100000 numbers"}};
  for (const auto& [text, reason] : cases) {
    EXPECT_THAT(ParseNumberList(text),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(reason)))
        << text;
  }
}

TEST(NumberList, ErrorNamesTheFirstWrongItem) {
  EXPECT_EQ(ParseNumberList("0.53,inf,nan,0:1:0").status().message(),
            "'inf' is not a decimal number such as 0.1 or 1e-3");
}

TEST(NumberList, ErrorOfATooLongListIsShort) {
  std::string text = "0:1:100000";
  for (int i = 1; i < 1000; ++i) text += ",0:1:100000";
  const std::string message(ParseNumberList(text).status().message());
  EXPECT_THAT(message, HasSubstr(" has more than 100000 numbers"));
  EXPECT_LT(message.size(), 200u);
}

TEST(Count, IsAWholeNumberInAnyNotation) {
  EXPECT_THAT(ParseCount("10000"), IsOkAndHolds(10000));
  EXPECT_THAT(ParseCount("1e6"), IsOkAndHolds(1'000'000));
  EXPECT_THAT(ParseCount("2.5e3"), IsOkAndHolds(2500));
  EXPECT_THAT(ParseCount("-5"), IsOkAndHolds(-5));  // the server rejects it
  EXPECT_THAT(ParseCount("9223372036854775807"), IsOkAndHolds(INT64_MAX));
  for (const char* text : {"", "1.5", "1e-3", "1e30", "nan", "10k", " 1", "9223372036854775808"}) {
    EXPECT_THAT(ParseCount(text), StatusIs(absl::StatusCode::kInvalidArgument)) << text;
  }
}

TEST(Seed, HoldsAll64Bits) {
  EXPECT_THAT(ParseSeed("0"), IsOkAndHolds(0u));
  EXPECT_THAT(ParseSeed("18446744073709551615"), IsOkAndHolds(UINT64_MAX));
  for (const char* text : {"", "-1", "1e3", "18446744073709551616", "0x1", " 1", "+1"}) {
    EXPECT_THAT(ParseSeed(text), StatusIs(absl::StatusCode::kInvalidArgument)) << text;
  }
}

}  // namespace
}  // namespace ballpiston::client

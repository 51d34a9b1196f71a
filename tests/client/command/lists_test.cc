// Lists of numbers and of shapes, and tables of points: what is read, and the errors.
#include "client/command/number_list.h"
#include "client/command/points_file.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

// ---- number_list.h ----

TEST(NumberList, HasNumbersAndRanges) {
  const std::pair<const char*, std::vector<double>> cases[] = {
      {"0.1,2,-3.5,1e-5,2.5E3,.5", {0.1, 2, -3.5, 1e-5, 2500, 0.5}},
      {"0:1:11", {0, .1, .2, .3, .4, .5, .6, .7, .8, .9, 1}},  // both ends, even steps
      {"0.3:0.1:3", {0.3, 0.2, 0.1}},
      {"0.2:0.2:1", {0.2}},
      {"1e-3:1:4:log", {1e-3, 1e-2, 1e-1, 1}},  // even ratios
      {"1e-309:0.1:3:log", {1e-309, 1e-155, 0.1}},
      {"1e-120:1e120:3:log", {1e-120, 1, 1e120}},
      {"0.1,0.2:0.3:3,7", {0.1, 0.2, 0.25, 0.3, 7}}};
  for (const auto& [text, numbers] : cases) {
    EXPECT_THAT(ParseNumberList(text), IsOkAndHolds(numbers)) << text;
  }
}

TEST(NumberList, RejectsOtherTextsWithAReason) {
  const std::pair<const char*, std::vector<std::string>> cases[] = {
      {"' is not a decimal number",
       {"",     ",",   "0.1,",      "0.1,,0.2", " 0.1",  "0.1 ", "nan",
        "-nan", "inf", "-Infinity", "0x10",     "1/2",   "+1",   "--1",
        "1e",   "e5",  ".",         "0.1.2",    "0,1;2", "abc",  "\xc2\xbd"}},
      {"' is beyond double precision; permitted: 0, or an absolute value from 5e-324 to 1.79e308",
       {"1e999", "-1e309", "1e-400"}},
      {"write FROM:TO:COUNT", {"0.1:0.2", ":", "0:1:3:lin", "0:1:3:log:x"}},
      {"has an end that is not a decimal number", {":1:3", "0::3", "nan:1:3", "0:inf:3"}},
      {"a whole number from 1 to 100000",
       {"0:1:", "0:1:0", "0:1:-3", "0:1:2.5", "0:1:100001", "0:1:1e300",
        "0:1:99999999999999999999"}},
      {"both ends must be above 0", {"0:1:3:log", "-1:1:3:log"}},
      {"beyond 1e150", {"1e-300:1e300:3:log"}},
      {"'0:1:100000,5' has more than 100000 numbers", {"0:1:100000,5"}}};
  for (const auto& [reason, texts] : cases) {
    for (const std::string& text : texts) {
      EXPECT_THAT(ParseNumberList(text),
                  StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(reason)))
          << text;
    }
  }
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
  EXPECT_THAT(ParseCount("1e30").status().message(), HasSubstr("at most 9223372036854775807"));
}

TEST(Seed, HoldsAll64Bits) {
  EXPECT_THAT(ParseSeed("0"), IsOkAndHolds(0u));
  EXPECT_THAT(ParseSeed("18446744073709551615"), IsOkAndHolds(UINT64_MAX));
  for (const char* text : {"", "-1", "1e3", "18446744073709551616", "0x1", " 1", "+1"}) {
    EXPECT_THAT(ParseSeed(text), StatusIs(absl::StatusCode::kInvalidArgument)) << text;
  }
}

// The server checks the shapes.
TEST(ShapeList, HasChainsLatticesAndRanges) {
  const std::pair<const char*, std::vector<std::string>> cases[] = {
      {"12", {"12"}},
      {"1,4x3,1000000x1", {"1", "4x3", "1000000x1"}},
      {"1e3,007", {"1000", "7"}},
      {",4y4,2.5", {"", "4y4", "2.5"}},
      {"1:2:3", {"1", "1.5", "2"}},
      {"2:10:5,4x4", {"2", "4", "6", "8", "10", "4x4"}},
      {"8:1024:8:log", {"8", "16", "32", "64", "128", "256", "512", "1024"}},
      {"-3,0,0x5,1e15", {"-3", "0", "0x5", "1000000000000000"}}};
  for (const auto& [text, shapes] : cases) {
    EXPECT_THAT(ParseShapeList(text), IsOkAndHolds(shapes)) << text;
  }
}

TEST(ShapeList, RejectsOtherTextsWithAReason) {
  const std::pair<std::string, std::string> cases[] = {
      {"4x4:8x8:2", "'4x4:8x8:2' has an end that is not a decimal number"},
      {"1:5", "'1:5' is not a range"},
      {"1:5:1", "'1:5:1' has two different ends and a count of 1"},
      {"1:100000:100000,5", "has more than 100000 shapes"}};
  for (const auto& [text, reason] : cases) {
    EXPECT_THAT(ParseShapeList(text),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(reason)));
  }
}

// ---- points_file.h ----

// With a byte order mark, the quotes of R's write.csv, and empty lines.
TEST(PointsFile, FillsTheListsThatItsHeaderNames) {
  v1::Grid grid;
  grid.add_exponent(1);
  ASSERT_OK(ParsePoints("p.csv",
                        "\xEF\xBB\xBF\n"
                        "delta,\"rho\", cells\r\n0.1,0.53,\"4x3\"\r\n \r\n1e-3,\"0.6\",1e3\r\n\n",
                        grid));
  EXPECT_THAT(grid.table(), ElementsAre("delta", "rho", "cells"));
  EXPECT_THAT(grid.delta(), ElementsAre(0.1, 1e-3));
  EXPECT_THAT(grid.rho(), ElementsAre(0.53, 0.6));
  EXPECT_THAT(grid.cells(), ElementsAre("4x3", "1000"));
  EXPECT_THAT(grid.exponent(), ElementsAre(1));
}

TEST(PointsFile, AnErrorNamesTheLineAndTheColumn) {
  const std::pair<std::string, std::string> table[] = {
      {"", "p.csv: is empty"},
      {"\n \n", "p.csv: is empty"},
      {"rho,delta\n", "p.csv: has no row below its header"},
      {"rho,detla\n0.5,0.1\n", "line 1: the column 'detla' is not one of rho, delta, "},
      {"rho,detla\n0.5,0.1\n", "did you mean delta?"},
      {"rho,table\n0.5,0.1\n", "line 1: the column 'table' is not one of"},
      {"rho,rho\n0.5,0.1\n", "line 1: the column rho is there twice"},
      {"rho,epsilon\n0.5,0.1\n", "has the column epsilon, and --epsilon is given"},
      {"rho,delta\n0.5,0.1\n0.5,x\n", "line 3, column delta: 'x' is not a decimal number"},
      {"rho,delta\n0.5,\n", "line 2, column delta: '' is not a decimal number"},
      {"rho,delta\n\n0.5\n", "line 3 has 1 value; the header names 2 columns"}};
  for (const auto& [csv, message] : table) {
    v1::Grid grid;
    grid.add_epsilon(0.1);
    EXPECT_THAT(ParsePoints("p.csv", csv, grid),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(message)))
        << csv;
  }
}

TEST(PointsFile, HasAtMost100000Rows) {
  std::string csv = "rho\n";
  for (int i = 0; i < 100'000; ++i) csv += "0.53\n";
  v1::Grid grid;
  ASSERT_OK(ParsePoints("p.csv", csv, grid));
  EXPECT_EQ(grid.rho_size(), 100'000);
  v1::Grid other;
  EXPECT_THAT(ParsePoints("p.csv", csv + "0.53\n", other),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       HasSubstr("has too many rows; permitted: 1 to 100000")));
}

}  // namespace
}  // namespace ballpiston::client

#include "client/command/points_file.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

TEST(PointsFile, FillsTheListsThatItsHeaderNames) {
  v1::Grid grid;
  grid.add_exponent(1);
  ASSERT_OK(ParsePoints("p.csv",
                        "\xEF\xBB\xBF"
                        "delta,rho, cells\r\n0.1,0.53,4x3\r\n1e-3,0.6,12\r\n\n",
                        grid));
  EXPECT_THAT(grid.table(), ElementsAre("delta", "rho", "cells"));
  EXPECT_THAT(grid.delta(), ElementsAre(0.1, 1e-3));
  EXPECT_THAT(grid.rho(), ElementsAre(0.53, 0.6));
  EXPECT_THAT(grid.cells(), ElementsAre("4x3", "12"));
  EXPECT_THAT(grid.exponent(), ElementsAre(1));
}

TEST(PointsFile, AnErrorNamesTheLineAndTheColumn) {
  struct Wrong {
    const char* csv;
    const char* message;
  };
  const Wrong kWrong[] = {
      {"", "p.csv: is empty"},
      {"\n \n", "p.csv: is empty"},
      {"rho,delta\n", "p.csv: has no row below its header"},
      {"rho,detla\n0.5,0.1\n", "line 1: the column 'detla' is not one of rho, delta, "},
      {"rho,detla\n0.5,0.1\n", "did you mean delta?"},
      {"rho,table\n0.5,0.1\n", "line 1: the column 'table' is not one of"},
      {"rho,rho\n0.5,0.1\n", "line 1: the column rho is there twice"},
      {"rho,epsilon\n0.5,0.1\n", "has the column epsilon, and --epsilon is given"},
      {"rho,delta\n0.5,0.1\n0.5\n", "line 3 has 1 value; the header names 2 columns"},
      {"rho,delta\n0.5,0.1\n0.5,x\n", "line 3, column delta: 'x' is not a decimal number"},
      {"rho,delta\n0.5,\n", "line 2, column delta: '' is not a decimal number"},
      {"rho,delta\n\n0.5,0.1\n", "line 2 has 1 value;"},
      {"cells\n2x\n", "line 2, column cells: '2x' is not a shape"}};
  for (const Wrong& wrong : kWrong) {
    v1::Grid grid;
    grid.add_epsilon(0.1);
    EXPECT_THAT(ParsePoints("p.csv", wrong.csv, grid),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(wrong.message)))
        << wrong.csv;
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
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("has 100001 rows")));
}

}  // namespace
}  // namespace ballpiston::client

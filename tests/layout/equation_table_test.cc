// The table of the paper's equations is complete, and its files and names exist.
#include "tests/layout/equation_table.h"

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace ballpiston {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<EquationRow> RowsOfTheReadme() {
  return EquationRows(Contents(SourcePath("core/closed_form/README.md")));
}

std::vector<std::string> LabelsOfThePaper() {
  std::ifstream file(SourcePath("tests/data/equation_labels.txt"));
  return {std::istream_iterator<std::string>(file), {}};
}

std::string ContentsInProject(const std::string& path) { return Contents(SourcePath(path)); }

TEST(EquationTable, HasEveryLabelOfThePaperInItsOrder) {
  const std::vector<std::string> paper = LabelsOfThePaper();
  EXPECT_EQ(paper.size(), 49u);
  std::vector<std::string> labels;
  for (const EquationRow& row : RowsOfTheReadme()) labels.push_back(row.label);
  EXPECT_EQ(labels, paper);
}

TEST(EquationTable, EveryNameIsInItsFile) {
  EXPECT_THAT(WrongRows(RowsOfTheReadme(), ContentsInProject), IsEmpty());
}

// The tests above can fail.
TEST(EquationTable, RowsAreReadBetweenTheMarks) {
  const std::vector<EquationRow> rows = EquationRows(
      "| `before` | x | y |\n<!-- equations:begin -->\n| label | what it is | where "
      "|\n|---|---|---|\n"
      "| `Gv` | volume | `a.h: A` |\n<!-- equations:end -->\n| `after` | x | y |\n");
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].label, "Gv");
  EXPECT_EQ(rows[0].where, "`a.h: A`");
  EXPECT_THAT(EquationRows("| `Gv` | volume | `a.h: A` |\n"), IsEmpty());
}

TEST(EquationTable, ReferencesAreFilesWithNames) {
  EXPECT_THAT(
      ReferencesIn("`a.h: A`, of `x`; `core/b/c.h: D2` and more"),
      ElementsAre(CodeReference{"core/closed_form/a.h", "A"}, CodeReference{"core/b/c.h", "D2"}));
}

TEST(EquationTable, MissingFilesAndNamesAreErrors) {
  const auto contents = [](const std::string& path) {
    return std::string(path == "core/closed_form/a.h" ? "double Area(double rho);" : "");
  };
  EXPECT_THAT(WrongRows({{"Gv", "`a.h: Area`"}, {"n", "No function: a constant"}}, contents),
              IsEmpty());
  EXPECT_THAT(
      WrongRows({{"Gv", "`a.h: Are`"}, {"dGc", "`b.h: Area`"}, {"n", "a constant"}}, contents),
      ElementsAre("Gv: there is no Are in core/closed_form/a.h",
                  "dGc: there is no Area in core/closed_form/b.h", "n: names no function"));
}

}  // namespace
}  // namespace ballpiston

// Arguments, output and exit status of the program, with a fake report instead of computed tables.
#include "tools/stability/program.h"

#include <filesystem>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/files.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::stability {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr char kTables[] = "| tables |\n";

class Program : public ::testing::Test {
 protected:
  int Run(const std::vector<std::string>& arguments) {
    out_.str("");
    error_.str("");
    efforts_.clear();
    const auto make_report = [this](double effort) {
      efforts_.push_back(effort);
      while_computing_();
      return report_;
    };
    return RunProgram(arguments, make_report, out_, error_);
  }

  TemporaryFolder folder_;
  std::string path_ = folder_.File("stability.md");
  Report report_ = {.text = kTables, .complaints = {}};
  std::function<void()> while_computing_ = [] {};

  std::vector<double> efforts_;  // one for each report that was made
  std::ostringstream out_;
  std::ostringstream error_;
};

TEST_F(Program, HelpExitsWithZero) {
  EXPECT_EQ(Run({"--help"}), 0);
  for (const char* argument : {"--quick", "--out FILE", "--into FILE", "--help"}) {
    EXPECT_THAT(out_.str(), HasSubstr(argument));
  }
  EXPECT_EQ(error_.str(), "");
  EXPECT_THAT(efforts_, IsEmpty());
}

TEST_F(Program, AWrongArgumentIsNamedAndExitsWithTwo) {
  const std::vector<std::vector<std::string>> wrong = {
      {"--fast"}, {"--quick", "stability.md"}, {"--out"}, {"--out", ""}, {"--into"}, {""}};
  const std::vector<std::string> named = {"'--fast'",    "'stability.md'", "--out needs",
                                          "--out needs", "--into needs",   "''"};
  for (size_t i = 0; i < wrong.size(); ++i) {
    EXPECT_EQ(Run(wrong[i]), 2) << named[i];
    EXPECT_THAT(error_.str(), HasSubstr(named[i]));
    EXPECT_EQ(out_.str(), "");
    EXPECT_THAT(efforts_, IsEmpty());
  }
}

TEST_F(Program, OutAndIntoExcludeEachOther) {
  EXPECT_EQ(Run({"--out", path_, "--into", path_}), 2);
  EXPECT_THAT(error_.str(), HasSubstr("--out and --into"));
  EXPECT_THAT(efforts_, IsEmpty());
}

TEST_F(Program, WithoutAFileTheTablesArePrinted) {
  EXPECT_EQ(Run({}), 0);
  EXPECT_EQ(out_.str(), kTables);
  EXPECT_EQ(error_.str(), "");
  EXPECT_THAT(efforts_, ElementsAre(1));
}

TEST_F(Program, QuickTakesAThousandthOfTheStarts) {
  EXPECT_EQ(Run({"--quick"}), 0);
  EXPECT_THAT(efforts_, ElementsAre(1e-3));
}

TEST_F(Program, OutWritesANewFileAndPrintsItsPath) {
  EXPECT_EQ(Run({"--out", path_}), 0);
  EXPECT_EQ(Contents(path_), kTables);
  EXPECT_THAT(NamesIn(folder_.path()), ElementsAre("stability.md"));
  EXPECT_EQ(out_.str(), "");
  EXPECT_EQ(error_.str(), "stability: the tables are in " + path_ + "\n");
}

TEST_F(Program, OutReplacesAnExistingFileAfterTheTablesAreComputed) {
  WriteFile(path_, "older tables\n");
  while_computing_ = [this] { EXPECT_EQ(Contents(path_), "older tables\n"); };
  EXPECT_EQ(Run({"--out", path_}), 0);
  EXPECT_EQ(Contents(path_), kTables);
}

TEST_F(Program, IntoReplacesTheSectionNamedStability) {
  WriteFile(path_, "before\n<!-- stability:begin -->\nold\n<!-- stability:end -->\nafter\n");
  EXPECT_EQ(Run({"--into", path_}), 0);
  EXPECT_EQ(Contents(path_),
            "before\n<!-- stability:begin -->\n| tables |\n<!-- stability:end -->\nafter\n");
  EXPECT_EQ(error_.str(), "stability: the tables are in " + path_ + "\n");
}

TEST_F(Program, AnUnwritableFileIsRejectedBeforeTheComputation) {
  WriteFile(path_, "a page without the section\n");
  const std::vector<std::vector<std::string>> refused = {{"--out", folder_.File("missing/new.md")},
                                                         {"--out", "/proc/new.md"},
                                                         {"--out", folder_.path()},
                                                         {"--into", folder_.File("missing.md")},
                                                         {"--into", path_}};
  for (const std::vector<std::string>& arguments : refused) {
    EXPECT_EQ(Run(arguments), 1) << arguments[1];
    EXPECT_THAT(error_.str(), HasSubstr(arguments[1]));
    EXPECT_EQ(out_.str(), "");
    EXPECT_THAT(efforts_, IsEmpty());
  }
  EXPECT_THAT(NamesIn(folder_.path()), ElementsAre("stability.md"));
}

TEST_F(Program, TablesArePrintedIfTheFolderIsGone) {
  while_computing_ = [this] { std::filesystem::remove_all(folder_.path()); };
  EXPECT_EQ(Run({"--out", path_}), 1);
  EXPECT_EQ(out_.str(), kTables);
  EXPECT_THAT(error_.str(), HasSubstr("cannot write " + path_));
}

TEST_F(Program, ComplaintsExitWithOneAfterTheTablesAreWritten) {
  report_.complaints = {"lanes fails: grazing"};
  EXPECT_EQ(Run({"--out", path_}), 1);
  EXPECT_EQ(Contents(path_), kTables);
  EXPECT_THAT(error_.str(), HasSubstr("stability: lanes fails: grazing\n"));
}

TEST_F(Program, AReportThatCannotBeMadeExitsWithOneAndLeavesTheFile) {
  WriteFile(path_, "older tables\n");
  while_computing_ = [] { throw std::runtime_error("fork: no memory"); };
  EXPECT_EQ(Run({"--out", path_}), 1);
  EXPECT_EQ(Contents(path_), "older tables\n");
  EXPECT_EQ(out_.str(), "");
  EXPECT_EQ(error_.str(), "stability: cannot compute the tables: fork: no memory\n");
}

TEST_F(Program, ClosedStandardOutputExitsWithOne) {
  out_.setstate(std::ios::badbit);
  EXPECT_EQ(Run({}), 1);
  EXPECT_THAT(error_.str(), HasSubstr("cannot write to standard output"));
}

}  // namespace
}  // namespace ballpiston::stability

// Arguments, output and exit status of the program, with a fake report instead of computed tables.
#include "tools/stability/program.h"

#include "tests/support/preamble.h"

namespace ballpiston::stability {
namespace {

class Program : public ::testing::Test {
 protected:
  int Run(const std::vector<std::string>& arguments) {
    const auto make_report = [this](double effort) {
      efforts_.push_back(effort);
      if (fails_) throw std::runtime_error("no memory");
      return Report{.text = "| tables |\n", .complaints = complaints_};
    };
    return RunProgram(arguments, make_report, out_, error_);
  }

  bool fails_ = false;
  std::vector<std::string> complaints_;
  std::vector<double> efforts_;  // one for each report that was made
  std::ostringstream out_;
  std::ostringstream error_;
};

TEST_F(Program, PrintsTheTablesOfAllStartsOrOfAThousandth) {
  EXPECT_EQ(Run({}), 0);
  EXPECT_EQ(Run({"--quick"}), 0);
  EXPECT_EQ(out_.str(), "| tables |\n| tables |\n");
  EXPECT_EQ(error_.str(), "");
  EXPECT_THAT(efforts_, ElementsAre(1, 1e-3));
}

TEST_F(Program, HelpExitsWithZeroAndAWrongArgumentWithTwo) {
  EXPECT_EQ(Run({"--help"}), 0);
  EXPECT_THAT(out_.str(), HasSubstr("--quick"));
  for (const char* argument : {"--fast", "stability.md", ""}) {
    EXPECT_EQ(Run({"--quick", argument}), 2);
    EXPECT_THAT(error_.str(), HasSubstr("'" + std::string(argument) + "'"));
  }
  EXPECT_TRUE(efforts_.empty());
}

TEST_F(Program, ComplaintsExitWithOneAfterTheTables) {
  complaints_ = {"lanes fails: grazing"};
  EXPECT_EQ(Run({}), 1);
  EXPECT_EQ(out_.str(), "| tables |\n");
  EXPECT_EQ(error_.str(), "stability: lanes fails: grazing\n");
}

TEST_F(Program, AReportThatCannotBeMadeExitsWithOne) {
  fails_ = true;
  EXPECT_EQ(Run({}), 1);
  EXPECT_EQ(out_.str(), "");
  EXPECT_EQ(error_.str(), "stability: cannot compute the tables: no memory\n");
}

TEST_F(Program, ClosedStandardOutputExitsWithOne) {
  out_.setstate(std::ios::badbit);
  EXPECT_EQ(Run({}), 1);
  EXPECT_THAT(error_.str(), HasSubstr("cannot write to standard output"));
}

}  // namespace
}  // namespace ballpiston::stability

// The sources of a flag's value: the command line, the environment, the config file.
// transcripts/settings.txt shows what a file may hold, and the messages about mistakes.
#include "client/command/config_file.h"

#include "client/command/follow_job.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

class ConfigFileTest : public ::testing::Test {
 protected:
  const EmptyHome home_;
};

TEST_F(ConfigFileTest, RelativeHomeIsReplacedByTheUsersEntry) {
  const std::string home = std::filesystem::relative(home_.File(""));
  std::filesystem::create_directories(home + "/.config/ballpiston");
  WriteFile(home + "/.config/ballpiston/config.toml", "");
  const ScopedVariable config_home("XDG_CONFIG_HOME"), relative("HOME", home);
  EXPECT_THAT(UsualConfig(), Not(StartsWith(home)));
}

// A flag with a variable, its values from the strongest source to the weakest, and what it sets.
struct Ranked {
  std::string key;
  std::vector<std::string> values;  // command line, environment, section, file
  std::string (*read)(const Options& options);
};

const Ranked kRanked[] = {
    {"server", {"a:1", "b:1", "c:1", "d:1"}, [](const Options& o) { return o.server; }},
    {"ca", {"a", "b", "c", "d"}, [](const Options& o) { return o.security.ca; }},
    {"token-file", {"a", "b", "c", "d"}, [](const Options& o) { return o.security.token_file; }},
    {"progress",
     {"none", "json", "bar", "auto"},
     [](const Options& o) {
       return std::vector<std::string>{"auto", "bar", "json", "none"}[int(o.progress)];
     }},
    {"tls",
     {"true", "false", "true", "false"},
     [](const Options& o) -> std::string { return o.security.tls ? "true" : "false"; }},
    {"quiet",
     {"true", "false", "true", "false"},
     [](const Options& o) -> std::string {
       return o.verbosity == Verbosity::kQuiet ? "true" : "false";
     }},
    {"verbose", {"true", "false", "true", "false"}, [](const Options& o) -> std::string {
       return o.verbosity == Verbosity::kVerbose ? "true" : "false";
     }}};

std::string VariableOf(const std::string& key) {
  return "BALLPISTON_" + absl::AsciiStrToUpper(absl::StrReplaceAll(key, {{"-", "_"}}));
}

TEST_F(ConfigFileTest, EachFlagThenVariableThenSectionThenFile) {
  for (const auto& [key, values, read] : kRanked) {
    SCOPED_TRACE(key);
    for (size_t strongest = 0; strongest < values.size(); ++strongest) {
      std::vector<std::string> words = {"watch", "abc"};
      if (strongest == 0) words.push_back("--" + key + "=" + values[0]);
      const ScopedVariable variable(VariableOf(key), strongest <= 1 ? values[1] : "");
      home_.WriteConfig(key + " = \"" + values[3] + "\"\n" +
                        (strongest <= 2 ? "[watch]\n" + key + " = \"" + values[2] + "\"\n" : ""));
      ASSERT_OK_AND_ASSIGN(const CommandLine line, ParseCommandLine(words));
      EXPECT_EQ(read(line.options), values[strongest]);
    }
  }
}

TEST_F(ConfigFileTest, AFlagReplacesWeakerSourcesOfItsRivals) {
  home_.WriteConfig("token-file = \"file\"\nquiet = true\nprogress = \"bar\"\n");
  const ScopedVariable token("BALLPISTON_TOKEN", "secret");
  ASSERT_OK_AND_ASSIGN(CommandLine line, ParseCommandLine({"watch", "abc", "--verbose"}));
  EXPECT_EQ(line.options.security.token, "secret");
  EXPECT_EQ(line.options.security.token_file, "");
  EXPECT_EQ(line.options.verbosity, Verbosity::kVerbose);
  EXPECT_EQ(StyleOf(line.options), ProgressStyle::kBar);
  ASSERT_OK_AND_ASSIGN(line, ParseCommandLine({"watch", "abc", "--quiet", "--token-file", "own"}));
  EXPECT_EQ(line.options.security.token, "");
  EXPECT_EQ(line.options.security.token_file, "own");
  EXPECT_EQ(StyleOf(line.options), ProgressStyle::kNone);
}

// Only of one source do a tolerance and a budget go together.
TEST_F(ConfigFileTest, ATargetReplacesThatOfAWeakerSource) {
  home_.WriteConfig("[run]\nsamples = 5\n");
  ASSERT_OK_AND_ASSIGN(CommandLine line, ParseCommandLine({"run", "first-hit", "--budget", "3"}));
  EXPECT_EQ(line.options.spec.target().kind_case(), v1::Target::KIND_NOT_SET);
  EXPECT_EQ(line.options.spec.target().budget().seconds(), 3);
  home_.WriteConfig("[run]\ntolerance = 0.1\nbudget = 3\n");
  ASSERT_OK_AND_ASSIGN(line, ParseCommandLine({"run", "first-hit"}));
  EXPECT_EQ(line.options.spec.target().tolerance(), 0.1);
  EXPECT_EQ(line.options.spec.target().budget().seconds(), 3);
  ASSERT_OK_AND_ASSIGN(line, ParseCommandLine({"run", "first-hit", "--samples", "7"}));
  EXPECT_EQ(line.options.spec.target().samples(), 7);
  EXPECT_FALSE(line.options.spec.target().has_budget());
  ASSERT_OK_AND_ASSIGN(line, ParseCommandLine({"run", "first-hit", "--budget", "60"}));
  EXPECT_FALSE(line.options.spec.target().has_tolerance());
  EXPECT_EQ(line.options.spec.target().budget().seconds(), 60);
}

TEST_F(ConfigFileTest, TargetsOfOneSourceThatExcludeEachOtherAreRefused) {
  home_.WriteConfig("[run]\nsamples = 5\ncollisions = 3\n");
  EXPECT_THAT(ParseCommandLine({"run", "first-hit"}).status(),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       HasSubstr("--samples and --collisions in the config file exclude")));
}

TEST_F(ConfigFileTest, WhatIsOffOrReplacedReplacesNothing) {
  home_.WriteConfig("verbose = true\nprogress = \"json\"\n");
  ASSERT_OK_AND_ASSIGN(CommandLine line, ParseCommandLine({"watch", "abc", "--quiet=false"}));
  EXPECT_EQ(line.options.verbosity, Verbosity::kVerbose);
  const ScopedVariable quiet("BALLPISTON_QUIET", "1");
  ASSERT_OK_AND_ASSIGN(line, ParseCommandLine({"watch", "abc", "--verbose"}));
  EXPECT_EQ(StyleOf(line.options), ProgressStyle::kJson);
}

TEST_F(ConfigFileTest, ProgressOfAStrongerSourceIsShownInSpiteOfQuiet) {
  home_.WriteConfig("quiet = true\n");
  const ScopedVariable progress("BALLPISTON_PROGRESS", "json");
  ASSERT_OK_AND_ASSIGN(CommandLine line, ParseCommandLine({"watch", "abc"}));
  EXPECT_EQ(StyleOf(line.options), ProgressStyle::kJson);
  ASSERT_OK_AND_ASSIGN(line, ParseCommandLine({"watch", "abc", "--quiet"}));
  EXPECT_EQ(StyleOf(line.options), ProgressStyle::kNone);
}

}  // namespace
}  // namespace ballpiston::client

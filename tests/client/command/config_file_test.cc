// The sources of a flag's value: the command line, the environment, the config file.
#include "client/command/config_file.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

class ConfigFileTest : public ::testing::Test {
 protected:
  static std::string Server(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"server", "status"};
    words.insert(words.end(), more.begin(), more.end());
    const auto line = ParseCommandLine(words);
    EXPECT_OK(line);
    return line.ok() ? line->options.server : "";
  }

  const EmptyHome home_;
};

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
     [](const Options& o) -> std::string { return o.quiet ? "true" : "false"; }},
    {"verbose", {"true", "false", "true", "false"}, [](const Options& o) -> std::string {
       return o.verbose ? "true" : "false";
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
  EXPECT_TRUE(line.options.verbose);
  EXPECT_FALSE(line.options.quiet);
  EXPECT_EQ(line.options.progress, ProgressStyle::kBar);
  ASSERT_OK_AND_ASSIGN(line, ParseCommandLine({"watch", "abc", "--quiet", "--token-file", "own"}));
  EXPECT_EQ(line.options.security.token, "");
  EXPECT_EQ(line.options.security.token_file, "own");
  EXPECT_EQ(line.options.progress, ProgressStyle::kAuto);
}

TEST_F(ConfigFileTest, WhatIsOffOrReplacedReplacesNothing) {
  home_.WriteConfig("verbose = true\nprogress = \"json\"\n");
  ASSERT_OK_AND_ASSIGN(CommandLine line, ParseCommandLine({"watch", "abc", "--quiet=false"}));
  EXPECT_TRUE(line.options.verbose);
  const ScopedVariable quiet("BALLPISTON_QUIET", "1");
  ASSERT_OK_AND_ASSIGN(line, ParseCommandLine({"watch", "abc", "--verbose"}));
  EXPECT_EQ(line.options.progress, ProgressStyle::kJson);
}

TEST_F(ConfigFileTest, HoldsValuesOfEveryKind) {
  home_.WriteConfig(
      "# a comment\n"
      "quiet = true\n"
      "[run]\n"
      "format = \"csv\"\n"
      "rho = [0.53, 0.6]\n"
      "delta = \"0.1,0.2\"\n"
      "cells = [\"12\", \"4x3\", 8]\n"
      "hot = 2\n"
      "samples = 1e6\n"
      "estimate = \"conductivity\"\n"
      "verify = false\n");
  ASSERT_OK_AND_ASSIGN(const CommandLine line, ParseCommandLine({"run", "first-hit"}));
  EXPECT_TRUE(line.options.quiet);
  EXPECT_EQ(line.options.format, Format::kCsv);
  EXPECT_THAT(line.options.spec.grid().rho(), ElementsAre(0.53, 0.6));
  EXPECT_THAT(line.options.spec.grid().delta(), ElementsAre(0.1, 0.2));
  EXPECT_THAT(line.options.spec.grid().cells(), ElementsAre("12", "4x3", "8"));
  EXPECT_THAT(line.options.spec.grid().hot(), ElementsAre(2));
  EXPECT_EQ(line.options.spec.target().samples(), 1'000'000);
  EXPECT_EQ(line.options.spec.target().estimate(), "conductivity");
  EXPECT_FALSE(line.options.spec.verify());
}

TEST_F(ConfigFileTest, ATargetOnTheCommandLineKeepsTheEstimate) {
  home_.WriteConfig("[run]\nsamples = 100\nestimate = \"conductivity\"\n");
  ASSERT_OK_AND_ASSIGN(const CommandLine line,
                       ParseCommandLine({"run", "gas-equilibrium", "--tolerance", "0.1"}));
  EXPECT_EQ(line.options.spec.target().kind_case(), v1::Target::kTolerance);
  EXPECT_EQ(line.options.spec.target().estimate(), "conductivity");
}

TEST_F(ConfigFileTest, AnotherFileMayBeChosen) {
  home_.WriteConfig("server = \"usual:1\"\n");
  const std::string other = home_.File("other.toml"), missing = home_.File("missing.toml");
  WriteFile(other, "server = \"other:1\"\n");
  EXPECT_EQ(Server({"--config", other}), "other:1");
  const ScopedVariable variable("BALLPISTON_CONFIG", other);
  EXPECT_EQ(Server(), "other:1");
  EXPECT_THAT(ParseCommandLine({"list", "--config", missing}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(missing)));
}

TEST_F(ConfigFileTest, IsInTheHomeFolderWithoutXdgConfigHome) {
  home_.WriteConfig("server = \"xdg:1\"\n");
  std::filesystem::create_directories(home_.File(".config/ballpiston"));
  WriteFile(home_.File(".config/ballpiston/config.toml"), "server = \"home:1\"\n");
  EXPECT_EQ(Server(), "xdg:1");
  const ScopedVariable config_home("XDG_CONFIG_HOME", "relative");
  EXPECT_EQ(Server(), "home:1");
  config_home.Set({});
  EXPECT_EQ(Server(), "home:1");
}

}  // namespace
}  // namespace ballpiston::client

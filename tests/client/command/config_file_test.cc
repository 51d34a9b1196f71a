// The sources of a flag's value: the command line, the environment, the config file.
// transcripts/settings.txt shows what a file may hold, and the messages about mistakes.
#include "client/command/config_file.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

class ConfigFileTest : public ::testing::Test {
 protected:
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

}  // namespace
}  // namespace ballpiston::client

// The sources of a flag's value: the command line, the environment, the config file.
#include "client/command/config_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/client/program.h"
#include "tests/support/scoped_variable.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::client {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ConfigFileTest : public ::testing::Test {
 protected:
  static std::string Server(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"server", "status"};
    words.insert(words.end(), more.begin(), more.end());
    const auto line = ParseCommandLine(words);
    EXPECT_OK(line);
    return line.ok() ? line->options.server : "";
  }
  void ExpectError(const std::string& config, const std::string& text) const {
    home_.WriteConfig(config);
    EXPECT_THAT(ParseCommandLine({"list"}),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(text)));
  }

  const EmptyHome home_;
};

TEST_F(ConfigFileTest, FlagThenVariableThenSectionThenFile) {
  EXPECT_EQ(Server(), "");
  home_.WriteConfig("server = \"file:1\"\n");
  EXPECT_EQ(Server(), "file:1");
  home_.WriteConfig("server = \"file:1\"\n[server.status]\nserver = \"section:1\"\n");
  EXPECT_EQ(Server(), "section:1");
  const ScopedVariable variable("BALLPISTON_SERVER", "variable:1");
  EXPECT_EQ(Server(), "variable:1");
  EXPECT_EQ(Server({"--server", "flag:1"}), "flag:1");
  variable.Set("");
  EXPECT_EQ(Server(), "section:1");
}

TEST_F(ConfigFileTest, EveryVariableReachesItsOption) {
  const std::pair<const char*, const char*> variables[] = {
      {"BALLPISTON_SERVER", "h:1"},   {"BALLPISTON_CA", "ca"},
      {"BALLPISTON_TLS", "true"},     {"BALLPISTON_CERT", "cert"},
      {"BALLPISTON_KEY", "key"},      {"BALLPISTON_TOKEN_FILE", "file"},
      {"BALLPISTON_TOKEN", "secret"}, {"BALLPISTON_PROGRESS", "json"},
      {"BALLPISTON_QUIET", "1"},      {"BALLPISTON_VERBOSE", "yes"}};
  for (const auto& [name, value] : variables) setenv(name, value, 1);  // EmptyHome restores them
  ASSERT_OK_AND_ASSIGN(const CommandLine line, ParseCommandLine({"watch", "abc"}));
  const Options& options = line.options;
  EXPECT_EQ(options.server, "h:1");
  EXPECT_EQ(options.security.ca, "ca");
  EXPECT_TRUE(options.security.tls);
  EXPECT_EQ(options.security.certificate, "cert");
  EXPECT_EQ(options.security.key, "key");
  EXPECT_EQ(options.security.token_file, "file");
  EXPECT_EQ(options.security.token, "secret");
  EXPECT_EQ(options.progress, ProgressStyle::kJson);
  EXPECT_TRUE(options.quiet);
  EXPECT_TRUE(options.verbose);
  EXPECT_TRUE(options.given.empty());
  EXPECT_EQ(options.connection, "");
}

TEST_F(ConfigFileTest, AWrongVariableIsNamed) {
  const std::pair<std::string, std::string> wrong[] = {{"BALLPISTON_TLS", "perhaps"},
                                                       {"BALLPISTON_PROGRESS", "loud"}};
  for (const auto& [variable, value] : wrong) {
    const ScopedVariable set(variable, value);
    EXPECT_THAT(ParseCommandLine({"watch", "abc"}),
                StatusIs(absl::StatusCode::kInvalidArgument,
                         HasSubstr(variable + ": '" + value + "' is n")));
  }
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

TEST_F(ConfigFileTest, FlagsOfOtherVerbsAreIgnored) {
  home_.WriteConfig("progress = \"bar\"\n[run]\nformat = \"csv\"\n");
  ASSERT_OK_AND_ASSIGN(const CommandLine line, ParseCommandLine({"list"}));
  EXPECT_EQ(line.options.format, Format::kTable);
}

TEST_F(ConfigFileTest, ErrorsNameTheFile) {
  const std::string file = home_.File("ballpiston/config.toml");
  ExpectError("foramt = \"csv\"\n", file + ": 'foramt' is not a flag; did you mean format?");
  ExpectError("[run]\nlimit = 3\n", file + ": 'limit' is not a flag of run");
  ExpectError("[dance]\nformat = \"csv\"\n", file + ": [dance] is not a verb");
  ExpectError("format = \"xml\"\n", "--format of the config file: 'xml' is not one of table, ");
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

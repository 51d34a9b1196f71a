// Flags that exclude each other, from different sources: the command line, the environment, the
// config file. transcripts/settings.txt shows the order of the sources, and what a file may hold.
#include "client/command/settings.h"

#include "client/command/follow_job.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

class SettingsTest : public ::testing::Test {
 protected:
  static Options Read(const std::string& words) {
    const auto line = ParseCommandLine(absl::StrSplit(words, ' '));
    EXPECT_OK(line);
    return line.ok() ? line->options : Options();
  }
  static std::string Target(const std::string& words) {
    return Read(words).spec.target().ShortDebugString();
  }

  const EmptyHome home_;
};

TEST_F(SettingsTest, ARelativeHomeIsReplacedByTheUsersHomeFolder) {
  const std::string home = std::filesystem::relative(home_.File(""));
  std::filesystem::create_directories(home + "/.config/ballpiston");
  WriteFile(home + "/.config/ballpiston/config.toml", "");
  const ScopedVariable config_home("XDG_CONFIG_HOME"), relative("HOME", home);
  EXPECT_THAT(UsualConfig(), Not(StartsWith(home)));
}

TEST_F(SettingsTest, AFlagReplacesWeakerSourcesOfItsRivals) {
  home_.WriteConfig("token-file = \"file\"\nquiet = true\nprogress = \"bar\"\n");
  const ScopedVariable token("BALLPISTON_TOKEN", "secret");
  const Options verbose = Read("watch abc --verbose");
  EXPECT_EQ(verbose.security.token, "secret");
  EXPECT_EQ(verbose.security.token_file, "");
  EXPECT_EQ(verbose.verbosity, Verbosity::kVerbose);
  EXPECT_EQ(StyleOf(verbose), ProgressStyle::kBar);
  const Options quiet = Read("watch abc --quiet --token-file own");
  EXPECT_EQ(quiet.security.token, "");
  EXPECT_EQ(quiet.security.token_file, "own");
  EXPECT_EQ(StyleOf(quiet), ProgressStyle::kNone);
}

// A tolerance and a budget go together only if they are of one source.
TEST_F(SettingsTest, ATargetReplacesTheTargetOfAWeakerSource) {
  home_.WriteConfig("[run]\nsamples = 5\n");
  EXPECT_EQ(Target("run first-hit --budget 3"), "budget { seconds: 3 }");
  home_.WriteConfig("[run]\ntolerance = 0.1\nbudget = 3\n");
  EXPECT_EQ(Target("run first-hit"), "tolerance: 0.1 budget { seconds: 3 }");
  EXPECT_EQ(Target("run first-hit --samples 7"), "samples: 7");
  EXPECT_EQ(Target("run first-hit --budget 60"), "budget { seconds: 60 }");
}

TEST_F(SettingsTest, TargetsOfOneSourceThatExcludeEachOtherAreRefused) {
  home_.WriteConfig("[run]\nsamples = 5\ncollisions = 3\n");
  EXPECT_THAT(ParseCommandLine({"run", "first-hit"}).status(),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       HasSubstr("--samples and --collisions in the config file exclude")));
}

TEST_F(SettingsTest, AFlagThatIsOffOrReplacedReplacesNoOtherFlag) {
  home_.WriteConfig("verbose = true\nprogress = \"json\"\n");
  EXPECT_EQ(Read("watch abc --quiet=false").verbosity, Verbosity::kVerbose);
  const ScopedVariable quiet("BALLPISTON_QUIET", "1");
  EXPECT_EQ(StyleOf(Read("watch abc --verbose")), ProgressStyle::kJson);
}

TEST_F(SettingsTest, ProgressOfAStrongerSourceIsShownInSpiteOfQuiet) {
  home_.WriteConfig("quiet = true\n");
  const ScopedVariable progress("BALLPISTON_PROGRESS", "json");
  EXPECT_EQ(StyleOf(Read("watch abc")), ProgressStyle::kJson);
  EXPECT_EQ(StyleOf(Read("watch abc --quiet")), ProgressStyle::kNone);
}

}  // namespace
}  // namespace ballpiston::client

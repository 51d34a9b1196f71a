// Shell completion: the words that the program prints, and the scripts of the three shells.
#include "tests/client/preamble.h"
#include "tests/support/process.h"

namespace ballpiston::client {
namespace {

using Lines = std::vector<std::string>;

Lines LinesOf(const std::string& text) { return absl::StrSplit(text, '\n', absl::SkipEmpty()); }

class CompletionTest : public ProgramTest {
 protected:
  // The output of `completion words -- WORDS`.
  static Lines Offers(std::vector<std::string> words) {
    words.insert(words.begin(), {"completion", "words", "--"});
    const Outcome outcome = Ballpiston(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    return LinesOf(outcome.out);
  }
};

TEST_F(CompletionTest, OffersVerbsWithTheirSummaries) {
  EXPECT_THAT(Offers({""}), AllOf(Contains("run\tsubmit a job, watch it, print its result"),
                                  Contains("server"), Not(Contains(StartsWith("start")))));
  EXPECT_EQ(Offers({}), Offers({""}));
  EXPECT_EQ(Offers({"ru"}), Offers({""}));  // the shell chooses from them
  EXPECT_EQ(Offers({"help", "server", ""}), Offers({"server", ""}));
}

TEST_F(CompletionTest, OffersFlagsWithTheirTexts) {
  const Lines flags = Offers({"list", ""});
  EXPECT_THAT(flags, AllOf(Contains("--limit\tlargest number of jobs to list, by default all"),
                           Contains(StartsWith("--quiet\t")), Not(Contains(StartsWith("\t")))));
  EXPECT_EQ(Offers({"list", "--limit", "3", "--"}), flags);
  EXPECT_EQ(Offers({"list", "--server", "h:1", "--quiet", ""}), flags);
}

TEST_F(CompletionTest, OffersAnArgumentAtItsPlace) {
  EXPECT_THAT(Offers({"run", ""}), Contains("first-hit"));
  EXPECT_EQ(Offers({"run", "--rho", "0.53", "--verify", ""}), Offers({"run", ""}));
  EXPECT_EQ(Offers({"run", "--rho", "=", "0.53", ""}), Offers({"run", ""}));
  EXPECT_EQ(Offers({"run", "--rho=0.53", ""}), Offers({"run", ""}));
  EXPECT_THAT(Offers({"run", "first-hit", ""}), Contains(StartsWith("--rho\t")));
  EXPECT_THAT(Offers({"figure", "--quick", "--out", "x", ""}), Contains("mean-free-time"));
  EXPECT_THAT(Offers({"figure", "cell", ""}), Contains(StartsWith("--full\t")));
  EXPECT_THAT(Offers({"label", "abc", ""}), Contains(StartsWith("--server\t")));
}

TEST_F(CompletionTest, StartsNoServer) {
  EXPECT_THAT(Offers({"watch", ""}), Contains(StartsWith("--progress\t")));
  EXPECT_FALSE(std::filesystem::exists(home_.File("ballpiston/server.log")));
}

// ---- the scripts ----

// Each test runs a script in its shell, with a function instead of the program. The function prints
// the offers and records its arguments.
class CompletionScriptTest : public ::testing::Test {
 protected:
  // Standard output of the shell. SCRIPT in the code stands for the script.
  Lines Run(const std::string& shell, const std::string& code) const {
    WriteFile(home_.File("script"), Ballpiston({"completion", shell}).out);
    const ProcessResult result = RunProgram({.command = {"/usr/bin/env", shell, "-c", code},
                                             .environment = {{"ASKED", home_.File("asked")},
                                                             {"SCRIPT", home_.File("script")},
                                                             {"FOLDER", home_.File("")},
                                                             {"LC_ALL", "C"}}});
    EXPECT_EQ(result.err, "");
    return LinesOf(result.out);
  }
  static bool HasShell(const std::string& shell) {
    return RunProgram({.command = {"/bin/sh", "-c", "command -v " + shell}}).exit_code == 0;
  }
  Lines Asked() const { return LinesOf(Contents(home_.File("asked"))); }

  const EmptyHome home_;
};

constexpr char kFakeProgram[] =
    "ballpiston() { printf '<%s>\\n' \"$@\" >\"$ASKED\"; printf $OFFERS; }\n";

std::string InBash(const std::string& offers, const std::string& words, int index) {
  return std::string(". \"$SCRIPT\"; OFFERS='") + offers + "'; COMP_WORDS=(" + words +
         "); COMP_CWORD=" + std::to_string(index) + "; compopt() { echo compopt $*; }\n" +
         kFakeProgram + "_ballpiston; printf '%s\\n' \"${COMPREPLY[@]}\"; complete -p";
}

TEST_F(CompletionScriptTest, BashChoosesFromTheWords) {
  const std::string registered = "complete -F _ballpiston ballpiston";
  EXPECT_THAT(Run("bash", InBash("run\\tsubmit\\njobs\\nrest\\t*\\n", "ballpiston r", 1)),
              ElementsAre("run", "rest", registered));
  EXPECT_THAT(Asked(), ElementsAre("<completion>", "<words>", "<-->", "<r>"));
  EXPECT_THAT(Run("bash", InBash("csv\\njson\\n", "ballpiston list --format '' --quiet", 3)),
              ElementsAre("csv", "json", registered));
  EXPECT_THAT(Asked(),
              ElementsAre("<completion>", "<words>", "<-->", "<list>", "<--format>", "<>"));
  EXPECT_THAT(Run("bash", InBash("no\\n--format=csv\\n", "ballpiston list --format = c", 4)),
              ElementsAre("csv", registered));
  EXPECT_THAT(Run("bash", InBash("`date`\\n$(date)\\n", "ballpiston watch ''", 2)),
              ElementsAre("`date`", "$(date)", registered));
  EXPECT_THAT(Run("bash", InBash("no\\n--label\\tof KEY=VALUE\\n", "ballpiston list --", 2)),
              ElementsAre("--label", registered));
}

TEST_F(CompletionScriptTest, BashOffersFiles) {
  WriteFile(home_.File("spec one.json"), "");
  EXPECT_THAT(
      Run("bash", "cd \"$FOLDER\"; " + InBash("FILES\\n", "ballpiston run --spec spec", 3)),
      ElementsAre("compopt -o filenames", "spec one.json", "complete -F _ballpiston ballpiston"));
}

// Functions that print their arguments replace the functions of zsh's completion.
std::string InZsh(const std::string& offers, const std::string& words, int index) {
  return std::string("compdef() { }; . $SCRIPT; OFFERS='") + offers + "'; words=(" + words +
         "); CURRENT=" + std::to_string(index) +
         "; _files() { print files }; _describe() { print -l -- ${(P)2} }\n" + kFakeProgram +
         "_ballpiston";
}

TEST_F(CompletionScriptTest, ZshOffersWordsWithTheirTexts) {
  if (!HasShell("zsh")) GTEST_SKIP() << "no zsh";
  EXPECT_THAT(Run("zsh", InZsh("run\\tsubmit\\njobs\\n", "ballpiston list '' --quiet", 3)),
              ElementsAre("run:submit", "jobs"));
  EXPECT_THAT(Asked(), ElementsAre("<completion>", "<words>", "<-->", "<list>", "<>"));
  EXPECT_THAT(Run("zsh", InZsh("FILES\\n", "ballpiston run --spec s", 4)), ElementsAre("files"));
}

// `complete -C LINE` prints what fish offers for the line.
TEST_F(CompletionScriptTest, FishOffersWordsWithTheirTexts) {
  if (!HasShell("fish")) GTEST_SKIP() << "no fish";
  const std::string fake =
      ". $SCRIPT; function ballpiston; printf '<%s>\\n' $argv >$ASKED; printf $OFFERS; end; "
      "cd $FOLDER; ";
  EXPECT_THAT(Run("fish", fake + "set OFFERS 'run\\tsubmit\\njobs\\nrest\\n'; "
                                 "complete -C 'ballpiston list --x=y r'"),
              testing::UnorderedElementsAre("run\tsubmit", "rest"));
  EXPECT_THAT(Asked(), ElementsAre("<completion>", "<words>", "<-->", "<list>", "<--x=y>", "<r>"));
  WriteFile(home_.File("spec.json"), "");
  EXPECT_THAT(Run("fish", fake + "set OFFERS 'FILES\\n'; complete -C 'ballpiston run --spec sp'"),
              ElementsAre(StartsWith("spec.json")));
}

}  // namespace
}  // namespace ballpiston::client

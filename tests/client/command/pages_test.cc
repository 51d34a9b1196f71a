// The table of verbs and flags, and the pages of help that are made of it.
#include "client/command/reference.h"
#include "client/command/verb_table.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

// ---- verb_table.h ----

// The example's words without the shell's redirections and pipes. ID is replaced by an id, because
// an id has no capitals.
std::vector<std::string> WordsOf(const std::string& example) {
  std::vector<std::string> words = absl::StrSplit(example.substr(0, example.find(" |")), ' ');
  std::erase_if(words, [](const std::string& word) { return word.find('>') != std::string::npos; });
  for (std::string& word : words) {
    if (word.find("ID") != std::string::npos) word = "ensembleJobs/id";
  }
  return words;
}

TEST(VerbTable, EveryExampleIsRead) {
  const EmptyHome home;
  for (const Verb& verb : Verbs()) {
    EXPECT_THAT(verb.examples, SizeIs(Ge(2))) << verb.name;
    for (const std::string& example : verb.examples) {
      const auto line = ParseCommandLine(WordsOf(example));
      ASSERT_THAT(line, IsOk()) << example;
      EXPECT_EQ(line->verb->act, verb.act) << example;
    }
  }
}

// ---- reference.h ----

class ReferenceTest : public ::testing::Test {
 protected:
  const EmptyHome home_;
};

// To write it again: ballpiston help --format markdown >docs/command-line.md
TEST_F(ReferenceTest, TheDocumentationHasTheCurrentReference) {
  const bool is_same = Ballpiston({"help", "--format", "markdown"}).out ==
                       Contents(SourcePath("docs/command-line.md"));
  EXPECT_TRUE(is_same) << "differs; write it again";
}

TEST_F(ReferenceTest, EachVerbHasAManPage) {
  const std::string folder = home_.File("man/man1");
  const Outcome outcome = Ballpiston({"help", "--format", "man", "--out", folder});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  std::vector<std::string> pages = {"ballpiston.1"};
  for (const Verb& verb : Verbs()) {
    pages.push_back(PageName(&verb) + ".1");
    EXPECT_EQ(Contents(folder + "/" + pages.back()), ManPage(&verb));
    EXPECT_THAT(ManPage(&verb), EndsWith("\n.SH \"SEE ALSO\"\nballpiston(1)\n"));
  }
  EXPECT_THAT(ManPage(nullptr), EndsWith(", ballpiston\\-completion(1)\n"));
  EXPECT_THAT(NamesIn(folder), testing::UnorderedElementsAreArray(pages));
}

// roff reads a line that begins with . or ' as a command, and - as a hyphen.
TEST_F(ReferenceTest, ManPagesHaveOnlyKnownCommands) {
  for (const Verb& verb : Verbs()) {
    for (const absl::string_view line : absl::StrSplit(ManPage(&verb), '\n')) {
      EXPECT_NE(line.substr(0, 1), "'") << line;
      if (line.substr(0, 1) != ".") continue;
      const std::string command(line.substr(0, line.find(' ')));
      EXPECT_THAT(command, testing::AnyOf(".TH", ".SH", ".TP", ".B", ".PP")) << line;
    }
  }
  EXPECT_THAT(Ballpiston({"help", "--format", "man", "run"}).out, HasSubstr(".B \\-\\-rho LIST\n"));
}

TEST_F(ReferenceTest, TheShortPageFitsAScreenAndBothPagesNameEveryFlag) {
  for (const Verb& verb : Verbs()) {
    const std::string short_page = ShortPage(&verb), page = TextPage(&verb);
    EXPECT_LE(std::count(short_page.begin(), short_page.end(), '\n'), kScreen) << short_page;
    for (const Flag* flag : FlagsOf(verb)) {
      EXPECT_THAT(short_page, HasSubstr(LongName(*flag)));
      EXPECT_THAT(page, HasSubstr(flag->name.empty() ? flag->variable : LongName(*flag)));
    }
    for (const Argument& argument : verb.arguments) {
      EXPECT_THAT(page, HasSubstr("\n  " + argument.value.name));
    }
    for (const std::string& example : verb.examples) {
      EXPECT_THAT(page, HasSubstr("\n  ballpiston " + example + "\n"));
    }
  }
}

}  // namespace
}  // namespace ballpiston::client

#include "client/command/verb_table.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

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

// Texts are parts of sentences: they end without a full stop.
TEST(VerbTable, EveryVerbAndFlagHasAText) {
  for (const Verb& verb : Verbs()) {
    std::vector<std::string> texts = {verb.summary};
    for (const Argument& argument : verb.arguments) texts.push_back(argument.text);
    for (const Flag* flag : FlagsOf(verb)) texts.push_back(flag->text);
    for (const std::string& text : texts) {
      EXPECT_THAT(text, Not(testing::IsEmpty())) << verb.name;
      EXPECT_THAT(text, Not(EndsWith("."))) << verb.name;
    }
  }
}

TEST(VerbTable, NamesAreUnique) {
  std::set<std::string> verbs;
  for (const Verb& verb : Verbs()) {
    EXPECT_TRUE(verbs.insert(verb.name).second) << verb.name;
    std::set<std::string> flags = {"--help", "-h"};
    for (const Flag* flag : FlagsOf(verb)) {
      for (const absl::string_view name : absl::StrSplit(flag->name, ',', absl::SkipEmpty())) {
        EXPECT_TRUE(flags.insert(std::string(name)).second) << verb.name << " " << name;
      }
    }
  }
}

// A flag without a value is a switch. Every other flag has a name for its value, in capitals.
TEST(VerbTable, ValuesHaveNamesInCapitals) {
  for (const Verb& verb : Verbs()) {
    for (const Flag* flag : FlagsOf(verb)) {
      EXPECT_EQ(flag->value.name, absl::AsciiStrToUpper(flag->value.name)) << flag->name;
      EXPECT_TRUE(flag->value.read) << flag->name;
    }
  }
}

}  // namespace
}  // namespace ballpiston::client

// Headers list properties of their code, "each with a test of its name" or "the test that bears its
// name". These tests exist.
#include <algorithm>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/layout/source_files.h"

namespace ballpiston {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// The comments of a source, each on one line.
std::string Comments(const std::string& source) {
  std::istringstream lines(source);
  std::string comments;
  for (std::string line; std::getline(lines, line);) {
    comments += line.starts_with("//") ? line.substr(2) : "\n";
  }
  return comments;
}

// The names in all lists of properties.
std::vector<std::string> StatedProperties(const std::string& header) {
  static const std::regex property(R"([0-9]\. ([A-Z][a-z]*[A-Z]\w*))");
  const std::string comments = Comments(header), begin = "its name:";
  std::vector<std::string> names;
  for (size_t at = comments.find(begin); at != std::string::npos;) {
    const size_t next = comments.find(begin, at + 1);
    const std::string list = comments.substr(at, std::min(comments.find('\n', at), next) - at);
    for (std::sregex_iterator name(list.begin(), list.end(), property), end; name != end; ++name) {
      names.push_back(name->str(1));
    }
    at = next;
  }
  return names;
}

// The names among these that no test in the sources has.
std::vector<std::string> WithoutTest(const std::vector<std::string>& names,
                                     const std::string& sources) {
  std::vector<std::string> missing;
  for (const std::string& name : names) {
    if (sources.find(" " + name + ") {") == std::string::npos) missing.push_back(name);
  }
  return missing;
}

TEST(StatedProperties, HaveATestOfTheirName) {
  const std::map<std::string, std::string> files = SourceFiles();
  std::string tests;
  for (const auto& [path, text] : files) {
    if (path.starts_with("tests/") && path.ends_with(".cc")) tests += text;
  }
  size_t stated = 0;
  for (const auto& [path, text] : files) {
    if (path.starts_with("tests/") || !path.ends_with(".h")) continue;
    const std::vector<std::string> names = StatedProperties(text);
    EXPECT_THAT(WithoutTest(names, tests), IsEmpty()) << path;
    stated += names.size();
  }
  EXPECT_GT(stated, 100u);
}

// The test above can fail.
TEST(StatedProperties, AreReadFromTheListsToTheEndsOfTheirComments) {
  EXPECT_THAT(StatedProperties("// A fold. Properties, each with a test of its\n"
                               "// name:\n"
                               "//   1. FirstOne.  2. SecondOne, within 1.5 sigma.\n"
                               "//   3. ThirdOne: as above.\n"
                               "#pragma once\n"
                               "// 4. AnotherComment.\n"
                               "// Property, with the test that bears its name: 1. FourthOne.\n"),
              ElementsAre("FirstOne", "SecondOne", "ThirdOne", "FourthOne"));
  EXPECT_THAT(StatedProperties("// 1. NotInAList.\n"), IsEmpty());
  EXPECT_THAT(WithoutTest({"HasATest", "HasNoTest"}, "TEST(Suite, HasATest) {"),
              ElementsAre("HasNoTest"));
}

}  // namespace
}  // namespace ballpiston

// Headers list properties of their code, "each with a test of its name". These tests exist.
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace ballpiston {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// A line for each comment.
std::string Comments(const std::string& source) {
  std::istringstream lines(source);
  std::string comments;
  for (std::string line; std::getline(lines, line);) {
    comments += line.starts_with("//") ? line.substr(2) : "\n";
  }
  return comments;
}

std::vector<std::string> StatedProperties(const std::string& header) {
  const std::string comments = Comments(header);
  const size_t begin = comments.find("a test of its name:");
  if (begin == std::string::npos) return {};
  const std::string list = comments.substr(begin, comments.find('\n', begin) - begin);
  static const std::regex property(R"([0-9]\. ([A-Z][a-z]*[A-Z]\w*))");
  std::vector<std::string> names;
  for (std::sregex_iterator next(list.begin(), list.end(), property), end; next != end; ++next) {
    names.push_back(next->str(1));
  }
  return names;
}

std::vector<std::string> FilesIn(const std::string& folder, const std::string& extension) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(SourcePath(folder))) {
    if (entry.path().extension() == extension) files.push_back(entry.path());
  }
  return files;
}

TEST(StatedProperties, HaveATestOfTheirName) {
  std::string tests;
  for (const std::string& file : FilesIn("tests", ".cc")) tests += Contents(file);
  for (const char* folder : {"core", "server", "client", "tools"}) {
    for (const std::string& file : FilesIn(folder, ".h")) {
      for (const std::string& name : StatedProperties(Contents(file))) {
        EXPECT_NE(tests.find(" " + name + ") {"), std::string::npos)
            << file << ": there is no test " << name;
      }
    }
  }
}

// The test above can fail.
TEST(StatedProperties, AreReadFromTheListToTheEndOfItsComment) {
  EXPECT_THAT(StatedProperties("// A fold. Properties, each with a test of its\n"
                               "// name:\n"
                               "//   1. FirstOne.  2. SecondOne, within 1.5 sigma.\n"
                               "//   3. ThirdOne: as above.\n"
                               "#pragma once\n"
                               "// 4. AnotherComment.\n"),
              ElementsAre("FirstOne", "SecondOne", "ThirdOne"));
  EXPECT_THAT(StatedProperties("// 1. NotInAList.\n"), IsEmpty());
}

}  // namespace
}  // namespace ballpiston

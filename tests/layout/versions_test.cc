// The files that name the version of the project, its date or the engine's version agree.
#include <regex>
#include <string>

#include "gtest/gtest.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace ballpiston {
namespace {

// The first group of the pattern's first match in a file of the project; empty if it has none.
std::string Found(const std::string& file, const std::string& pattern) {
  const std::string text = Contents(SourcePath(file));
  std::smatch match;
  return std::regex_search(text, match, std::regex(pattern)) ? match.str(1) : "";
}

TEST(Versions, AreTheSameInAllFiles) {
  const std::string version = Found("CMakeLists.txt", R"(project\(ballpiston VERSION (\S+))");
  EXPECT_NE(version, "");
  EXPECT_EQ(Found("CITATION.cff", R"(\nversion: (\S+))"), version);
  EXPECT_EQ(Found("codemeta.json", "\"version\": \"([^\"]+)\""), version);
  EXPECT_EQ(Found("debian/changelog", R"(ballpiston \((\S+)\))"), version);
  EXPECT_EQ(Found("CHANGELOG.md", R"(\n## (\S+),)"), version);
}

TEST(Versions, HaveTheSameDateAndEngineInAllFiles) {
  const std::string date = Found("CHANGELOG.md", R"(\n## \S+, (\S+),)");
  EXPECT_NE(date, "");
  EXPECT_EQ(Found("CITATION.cff", R"(\ndate-released: (\S+))"), date);
  EXPECT_EQ(Found("codemeta.json", "\"datePublished\": \"([^\"]+)\""), date);
  EXPECT_EQ(Found("CHANGELOG.md", R"(\n## [^\n]*, engine (\S+))"),
            Found("core/engine_version.h", "kEngineVersion\\[\\] = \"([^\"]+)\""));
}

}  // namespace
}  // namespace ballpiston

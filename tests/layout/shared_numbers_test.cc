// A number that several pages state is equal on all of them.
#include "tests/layout/shared_numbers.h"

#include <filesystem>
#include <set>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace ballpiston {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

constexpr char kNumbers[] = "docs/numbers.md";

// Text by path, of all pages but the one with the numbers.
std::map<std::string, std::string> Pages() {
  const std::filesystem::path root = SourcePath("");
  std::map<std::string, std::string> pages = {{"README.md", Contents(root / "README.md")}};
  for (const char* folder : {"docs", "core", "server", "client", "tests", "tools", "proto"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      const std::string path = entry.path().lexically_relative(root);
      if (entry.path().extension() == ".md" && path != kNumbers)
        pages[path] = Contents(entry.path());
    }
  }
  return pages;
}

TEST(SharedNumbers, AreTheSameOnAllPages) {
  const SharedNumbers numbers = NumbersIn(Contents(SourcePath(kNumbers)));
  std::map<std::string, std::string> unused = numbers;
  for (const auto& [path, text] : Pages()) {
    for (const auto& [name, before] : MarkedNumbersIn(text)) {
      ASSERT_TRUE(numbers.contains(name)) << path << ": " << name << " is not in " << kNumbers;
      EXPECT_TRUE(EndsWithNumber(before, numbers.at(name)))
          << path << ": " << name << " is " << numbers.at(name)
          << ", but the page says: " << before;
      unused.erase(name);
    }
  }
  EXPECT_THAT(unused, IsEmpty()) << "on no page";
}

TEST(SharedNumbers, AreReadFromTheTable) {
  EXPECT_THAT(NumbersIn("x\n| name | number |\n|---|---|\n| `a-1` | 0.1 µs | time | `make` |\n"),
              ElementsAre(Pair("a-1", "0.1 µs")));
}

TEST(SharedNumbers, AreWholeWords) {
  const auto marked = MarkedNumbersIn("it takes 12<!--a--> s, or\n112<!--a--> s");
  ASSERT_EQ(marked.size(), 2u);
  EXPECT_EQ(marked[0].name, "a");
  EXPECT_TRUE(EndsWithNumber(marked[0].before, "12"));
  EXPECT_FALSE(EndsWithNumber(marked[0].before, "13"));
  EXPECT_FALSE(EndsWithNumber(marked[1].before, "12"));
}

}  // namespace
}  // namespace ballpiston

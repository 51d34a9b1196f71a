#include "client/command/suggestion.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace ballpiston::client {
namespace {

TEST(EditDistance, CountsInsertionsDeletionsReplacementsAndSwaps) {
  const struct {
    const char *a, *b;
    size_t distance;
  } table[] = {{"", "", 0},         {"", "abc", 3},           {"abc", "abc", 0},  {"abc", "ab", 1},
               {"abc", "axc", 1},   {"abc", "acb", 1},        {"abc", "xabc", 1}, {"abc", "cba", 2},
               {"abcd", "badc", 2}, {"kitten", "sitting", 3}, {"abc", "xyz", 3}};
  for (const auto& [a, b, distance] : table) {
    EXPECT_EQ(EditDistance(a, b), distance) << a << " " << b;
    EXPECT_EQ(EditDistance(b, a), distance) << b << " " << a;
  }
}

TEST(DidYouMean, NamesTheNearestName) {
  const std::vector<std::string> names = {"--format", "--fresh", "--rho"};
  EXPECT_EQ(DidYouMean("--fromat", names), "; did you mean --format?");
  EXPECT_EQ(DidYouMean("--fres", names), "; did you mean --fresh?");
}

TEST(DidYouMean, IsEmptyIfMoreThanAThirdOfTheLettersDiffer) {
  EXPECT_EQ(DidYouMean("abcxyz", {"abcdef"}), "");
  EXPECT_EQ(DidYouMean("abcdyz", {"abcdef"}), "; did you mean abcdef?");
  EXPECT_EQ(DidYouMean("", {"run"}), "");
  EXPECT_EQ(DidYouMean("run", {}), "");
  EXPECT_EQ(DidYouMean(std::string(100'000, 'x'), {"xxx"}), "");
}

TEST(NotOneOf, QuotesTheTextAndListsTheNames) {
  EXPECT_EQ(NotOneOf("jsn", {"csv", "json"}), "'jsn' is not one of csv, json; did you mean json?");
  EXPECT_EQ(NotOneOf("", {"csv", "json"}), "'' is not one of csv, json");
}

}  // namespace
}  // namespace ballpiston::client

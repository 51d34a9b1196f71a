#include "client/command/shape_list.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

std::vector<std::string> Shapes(const std::string& text) {
  const auto list = ParseShapeList(text);
  EXPECT_OK(list);
  return list.value_or(std::vector<std::string>());
}

TEST(ShapeList, ReadsChainsAndLattices) {
  EXPECT_THAT(Shapes("12"), ElementsAre("12"));
  EXPECT_THAT(Shapes("1,4x3,1000000x1"), ElementsAre("1", "4x3", "1000000x1"));
}

TEST(ShapeList, EachShapeHasOneCanonicalForm) {
  EXPECT_THAT(Shapes("1e3,007,1e2x04"), ElementsAre("1000", "7", "100x4"));
}

TEST(ShapeList, ARangeGivesChains) {
  EXPECT_THAT(Shapes("2:10:5,4x4"), ElementsAre("2", "4", "6", "8", "10", "4x4"));
  EXPECT_THAT(Shapes("8:1024:8:log"),
              ElementsAre("8", "16", "32", "64", "128", "256", "512", "1024"));
}

// The server checks which numbers are permitted.
TEST(ShapeList, AnyNumberIsRead) {
  EXPECT_THAT(Shapes("-3,0,0x5,1e15"), ElementsAre("-3", "0", "0x5", "1000000000000000"));
}

TEST(ShapeList, RejectsOtherTextsWithAReason) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "'' is not a shape: write N, a chain of N cells, or NxM, a lattice"},
      {"4,", "'' is not a shape"},
      {"4y4", "'4y4' is not a shape"},
      {"x", "'x' is not a shape"},
      {"4x", "'4x' is not a shape"},
      {"x4", "'x4' is not a shape"},
      {"4x4x4", "'4x4x4' is not a shape"},
      {"4X4", "'4X4' is not a shape"},
      {"4 x4", "'4 x4' is not a shape"},
      {"2.5", "'2.5' is not a shape"},
      {"3,nan", "'nan' is not a shape"},
      {"1e30", "'1e30' is not a shape"},
      {"1:2:4", "'1:2:4' has numbers that are not whole"},
      {"1:10:4:log", "'1:10:4:log' has numbers that are not whole"},
      {"1:1e17:2", "'1:1e17:2' has numbers that are not whole"},
      {"1:1e100:2", "has numbers that are not whole"},
      {"4x4:8x8:2", "'4x4:8x8:2' has an end that is not a decimal number"},
      {"1:5", "'1:5' is not a range"},
      {"1:100000:100000,5", "has more than 100000 shapes"}};
  for (const auto& [text, reason] : cases) {
    EXPECT_THAT(ParseShapeList(text),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(reason)))
        << text;
  }
}

}  // namespace
}  // namespace ballpiston::client

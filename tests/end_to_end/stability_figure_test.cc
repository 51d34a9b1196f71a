// The figure of the failures that the program `stability` counts, without a server. The figure
// fails if a method fails where it promises not to.

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

TEST(StabilityFigure, HasAllSituationsAndMethods) {
  const TemporaryFolder home;
  const std::string figure = home.File("figure");
  const ProcessResult result = RunProgram(ClientCommand(
      home, {"figure", "stability", "--quick", "--progress", "none", "--out", figure}));
  EXPECT_THAT(result, ExitsWith(0));
  const std::string data = Contents(figure + "/stability.csv");
  EXPECT_EQ(Words(absl::StrSplit(data, '\n', absl::SkipEmpty())).size(),
            2 + 7 * 11 + 9 * 10 + 16 * 4u);
  EXPECT_THAT(data, HasSubstr(",\"grazing, rho = 0.501, 0.5296, 0.6, 0.65, 0.7\",lanes,"));
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(Contents(figure + "/stability.svg"), HasSubstr("one hot piston"));
}

}  // namespace
}  // namespace ballpiston

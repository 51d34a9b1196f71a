// The figures that programs of tools/ measure, without a server.
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

class ProgramFigure : public testing::Test {
 protected:
  ProcessOptions Command(const std::string& name, const std::string& flags) const {
    return ClientCommand(home_, Joined({{"figure", name, "--out", figure_}, Split(flags)}));
  }

  const TemporaryFolder home_;
  const std::string figure_ = home_.File("figure");
};

// The measured times are too short for meaningful numbers. The test checks that there are numbers.
TEST_F(ProgramFigure, SpeedAccuracyHasDataAndPicture) {
  const ProcessResult result =
      RunProgram(Command("speed-accuracy", "--seconds 0.01 --progress none"));
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_THAT(Contents(figure_ + "/speed-accuracy.csv"), HasSubstr("markov,0,heat-current"));
  EXPECT_THAT(Contents(figure_ + "/speed-accuracy.svg"), HasSubstr("heat current of a gas"));
  EXPECT_THAT(result.out, HasSubstr(figure_ + "/speed-accuracy.svg\n"));
}

TEST_F(ProgramFigure, AnInterruptionEndsTheProgramToo) {
  for (const int signal : {SIGINT, SIGTERM}) {
    Process client(Command("speed-accuracy", "--seconds 60 --progress bar"));
    ASSERT_TRUE(client.WaitForErr("mean-free-time"));
    client.Signal(signal);
    EXPECT_THAT(client.Wait(), ExitsWith(130));
    AwaitThat([] { return ProcessesWith(BuildPath("bin/method_comparison")).empty(); });
  }
}

// The figure fails if a method fails where it promises not to.
TEST_F(ProgramFigure, StabilityHasAllSituationsAndMethods) {
  const ProcessResult result = RunProgram(Command("stability", "--quick --progress none"));
  EXPECT_THAT(result, ExitsWith(0));
  const std::string data = Contents(figure_ + "/stability.csv");
  EXPECT_EQ(Words(absl::StrSplit(data, '\n', absl::SkipEmpty())).size(),
            2 + 7 * 11 + 9 * 10 + 16 * 4u);
  EXPECT_THAT(data, HasSubstr(",\"grazing, rho = 0.501, 0.5296, 0.6, 0.65, 0.7\",lanes,"));
  EXPECT_THAT(result.err, kQuiet);
  EXPECT_THAT(Contents(figure_ + "/stability.svg"), HasSubstr("one hot piston"));
}

}  // namespace
}  // namespace ballpiston

// The figure that the program `method_comparison` measures, without a server.
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

class SpeedAccuracy : public testing::Test {
 protected:
  ProcessOptions Command(const Words& flags) const {
    return ClientCommand(home_, Joined({{"figure", "speed-accuracy", "--out", figure_}, flags}));
  }

  const TemporaryFolder home_;
  const std::string figure_ = home_.File("figure");
};

// The measured times are too short for meaningful numbers. The test checks that there are numbers.
TEST_F(SpeedAccuracy, LeavesDataAndPicture) {
  const ProcessResult result = RunProgram(Command({"--seconds", "0.01", "--progress", "bar"}));
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_THAT(result.err, HasSubstr("measurements"));
  const std::string csv = Contents(figure_ + "/speed-accuracy.csv");
  for (const char* curve :
       {"fixed-step,0.01,mean-free-time", "billiard-reference,0,ingoing-law",
        "billiard-single,0,trajectory", "closed-form,0,mean-free-time", "markov,0,heat-current"}) {
    EXPECT_THAT(csv, HasSubstr(curve));
  }
  for (const char* text : {"vector lanes", "heat current of a gas"}) {
    EXPECT_THAT(Contents(figure_ + "/speed-accuracy.svg"), HasSubstr(text));
  }
  EXPECT_THAT(result.out, HasSubstr(figure_ + "/speed-accuracy.svg\n"));
}

// The client's standard error is also the program's: Wait returns when both have ended.
TEST_F(SpeedAccuracy, AnInterruptionEndsTheProgramToo) {
  for (const int signal : {SIGINT, SIGTERM}) {
    Process client(Command({"--seconds", "60", "--progress", "bar"}));
    ASSERT_TRUE(client.WaitForErr("mean-free-time"));
    client.Signal(signal);
    EXPECT_THAT(client.Wait(), ExitsWith(130));
  }
}

TEST_F(SpeedAccuracy, WrongValuesAreNamed) {
  const ProcessResult result =
      RunProgram(Command(Split("--delta 0.4 --epsilon 0.6 --seconds 0.001")));
  EXPECT_THAT(result, ExitsWith(2));
  for (const char* text : {"--delta: ", "--epsilon: ", "--seconds: "}) {
    EXPECT_THAT(result.err, HasSubstr(text));
  }
}

}  // namespace
}  // namespace ballpiston

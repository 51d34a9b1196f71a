// Figures, each from one command, and resumed after an interruption. What the figures compute is
// tested in tests/client/python/test_figures.py.
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

class FigureTest : public ::testing::Test {
 protected:
  Words Draw(const std::string& flags) const {
    return Joined({Split("figure mean-free-time --delta 0.2,0.1 " + flags), {"--out", folder_}});
  }
  std::string File(const std::string& name) const { return folder_ + "/" + name; }

  const TestServer server_;
  const std::string folder_ = server_.folder().File("out/figure");  // created with its parents
};

TEST_F(FigureTest, LeavesDataAndPictures) {
  const ProcessResult result = server_.Client(Draw("--samples 200 --collisions 2000"));
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_THAT(result.err, kQuiet);
  const Words parts =
      absl::StrSplit(Contents(File("mean-free-time.csv")), ",mean_free_time_conditional,");
  EXPECT_EQ(parts.size(), 1 + 2 * 59u);  // 59 energies at each delta
  EXPECT_THAT(Contents(File("mean-free-time.svg")), HasSubstr("δ = 0.1"));
  for (const char* name : {"mean-free-time.csv", "mean-free-time-inset.csv", "mean-free-time.png",
                           "mean-free-time.svg"}) {
    EXPECT_THAT(result.out, HasSubstr(File(name) + "\n"));
  }
}

// The jobs take years.
TEST_F(FigureTest, AnInterruptionCancelsNothingAndTheSameCommandGoesOn) {
  const Words command = Draw("--samples 1000000000000 --progress json");
  for (int attempt = 0; attempt < 2; ++attempt) {
    Process figure(server_.Command(command));
    ASSERT_TRUE(figure.WaitForErr("RUNNING"));
    figure.Signal(SIGTERM);
    EXPECT_THAT(figure.Wait(), ExitsWith(130));
    ASSERT_EQ(server_.List().jobs_size(), 1);
    EXPECT_EQ(server_.List().jobs(0).state(), v1::EnsembleJob::RUNNING);
  }
  // A job that was cancelled is made again.
  EXPECT_THAT(server_.Client({"cancel", server_.List().jobs().at(0).name()}), ExitsWith(0));
  Process figure(server_.Command(command));
  ASSERT_TRUE(figure.WaitForErr("RUNNING"));
  figure.Signal(SIGINT);
  EXPECT_THAT(figure.Wait(), ExitsWith(130));
  EXPECT_EQ(server_.List().jobs_size(), 2);
}

}  // namespace
}  // namespace ballpiston

// Figures, each from one command, and resumed after an interruption.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class FigureTest : public ::testing::Test {
 protected:
  Words Draw(const std::string& flags) const {
    return Split("figure mean-free-time --delta 0.2,0.1 --out " + folder_ + " " + flags);
  }
  // Draws a figure without messages and returns its SVG.
  std::string Svg(const std::string& name, const std::string& flags = "") const {
    const ProcessResult result = server_.Client(
        Split("figure " + name + " --out " + folder_ + (flags.empty() ? "" : " ") + flags));
    EXPECT_THAT(result, ExitsWith(0));
    EXPECT_EQ(result.err, "");
    return Contents(folder_ + "/" + name + ".svg");
  }
  std::string File(const std::string& suffix) const { return folder_ + "/mean-free-time" + suffix; }
  std::string Data(const std::string& name) const { return Contents(folder_ + "/" + name); }
  size_t LineCount(const std::string& name) const {
    const Words lines = absl::StrSplit(Data(name), '\n', absl::SkipEmpty());
    return static_cast<size_t>(
        std::count_if(lines.begin(), lines.end(), [](const std::string& line) {
          return line[0] != '#';  // where the data come from
        }));
  }
  static bool HasGnuplot() {
    return RunProgram({.command = {"sh", "-c", "command -v gnuplot"}}).exit_code == 0;
  }

  const TestServer server_;
  const std::string folder_ = server_.folder().File("out/figure");  // created with its parents
};

TEST_F(FigureTest, LeavesDataScriptsAndPicture) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const ProcessResult result = server_.Client(Draw("--samples 200 --collisions 2000"));
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(result.err, "");
  const std::vector<std::string> parts =
      absl::StrSplit(Contents(File(".csv")), ",mean_free_time_conditional,");
  EXPECT_EQ(parts.size(), 1 + 2 * 59u);
  const std::string svg = Contents(File(".svg"));
  EXPECT_THAT(svg, HasSubstr("</svg>"));
  EXPECT_THAT(svg, HasSubstr("δ = 0.1"));
  for (const char* suffix : {".csv", "-inset.csv", ".gnuplot", ".sh", ".svg"}) {
    EXPECT_THAT(result.out, HasSubstr(File(suffix) + "\n"));
  }
}

TEST_F(FigureTest, AnEditedScriptIsUsedAndKept) {
  ASSERT_THAT(server_.Client(Draw("--edit")), ExitsWith(0));
  EXPECT_FALSE(fs::exists(File(".csv")));
  const std::string edited = "# edited\nset output 'mean-free-time.svg'\n";
  WriteFile(File(".gnuplot"), edited);
  const ProcessResult result = server_.Client(Draw("--samples 200 --collisions 2000"));
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_THAT(result.err, HasSubstr("mean-free-time.gnuplot, which differs"));
  EXPECT_EQ(Contents(File(".gnuplot")), edited);
}

TEST_F(FigureTest, WithoutGnuplotLeavesDataAndScripts) {
  ProcessOptions options = server_.Command(Draw("--samples 200 --collisions 2000"));
  // A folder with all that the script needs but gnuplot.
  const std::string bin = server_.folder().File("bin");
  fs::create_directory(bin);
  for (const char* program : {"sh", "sed", "mv", "rm"}) {
    fs::create_symlink(std::string("/bin/") + program, bin + "/" + program);
  }
  options.environment["PATH"] = bin;
  const ProcessResult result = RunProgram(options);
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_THAT(result.err, HasSubstr("gnuplot is not installed"));
  EXPECT_TRUE(fs::exists(File(".gnuplot")));
  EXPECT_FALSE(fs::exists(File(".svg")));
}

// The jobs take years.
TEST_F(FigureTest, AnInterruptionCancelsNothingAndTheSameCommandGoesOn) {
  const Words command = Draw("--samples 1000000000000 --progress json");
  const auto job_count = [this] { return Length(At(server_.Json({"list"}), "jobs")); };
  for (int attempt = 0; attempt < 2; ++attempt) {
    const auto figure = server_.StartClient(command);
    ASSERT_TRUE(figure->WaitForErr("RUNNING"));
    figure->Signal(SIGTERM);
    EXPECT_THAT(figure->Wait(), ExitsWith(130));
    EXPECT_EQ(job_count(), 1);
    EXPECT_EQ(At(server_.Json({"list"}), "jobs", 0, "state").string_value(), "RUNNING");
  }
  // A job that was cancelled is made again.
  const std::string job = At(server_.Json({"list"}), "jobs", 0, "name").string_value();
  EXPECT_THAT(server_.Client({"cancel", job}), ExitsWith(0));
  const auto figure = server_.StartClient(command);
  ASSERT_TRUE(figure->WaitForErr("RUNNING"));
  figure->Signal(SIGINT);
  EXPECT_THAT(figure->Wait(), ExitsWith(130));
  EXPECT_EQ(job_count(), 2);
}

TEST_F(FigureTest, TheGasIsDrawnFromATrace) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("gas", "--temperature 3 --cells 3x2"), HasSubstr("</svg>"));
  EXPECT_EQ(LineCount("gas-balls.csv"), 1 + 6u);
  EXPECT_EQ(LineCount("gas-pistons.csv"), 1 + 12u);
  EXPECT_THAT(Svg("gas", "--temperature 3 --cells 4"), HasSubstr("</svg>"));
  EXPECT_EQ(LineCount("gas-pistons.csv"), 1 + 4u);
}

TEST_F(FigureTest, TemperatureProfilesHaveAllPlacesOfBothModels) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("temperature-profile",
                  "--cells 2,3 --samples 60 --billiard-samples 10 --delta 0.2 --hot 1.1"),
              HasSubstr("N = 3"));
  EXPECT_EQ(LineCount("temperature-profile-markov.csv"), 1 + 5 + 7u);
  EXPECT_THAT(Data("temperature-profile-markov.csv"),
              HasSubstr(",2,1.1,0.5,markov,60,temperature_profile,,1.5,"));
  EXPECT_EQ(LineCount("temperature-profile-billiard.csv"), 1 + 5 + 7u);
  EXPECT_THAT(Data("temperature-profile-billiard.csv"),
              HasSubstr(",3,1.1,0.5,billiard,10,temperature_profile,,0,"));
}

TEST_F(FigureTest, ConductivitiesStandBesideTheirLimit) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("conductivity",
                  "--cells 2,3 --samples 100 --delta 0.15,0.2 --billiard-cells 2 "
                  "--billiard-samples 50"),
              HasSubstr("infinite: -1.8073"));
  EXPECT_THAT(Data("conductivity-billiard.csv"),
              HasSubstr(",0.2,,,2,1,billiard,50,conductivity_ratio,"));
  EXPECT_THAT(Data("conductivity-rings.csv"),
              HasSubstr(",0.15,,,3,1,markov,100,conductivity_ratio,"));
}

TEST_F(FigureTest, RelativeEntropiesStandBesideTheirFloors) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("relative-entropy", "--delta 0.2,0.3 --epsilon 0.125,0.375 --samples 100"),
              HasSubstr("ε = 0.125"));
  EXPECT_THAT(Data("relative-entropy.csv"),
              AllOf(HasSubstr(",0.3,0.375,10,billiard,100,kl_divergence,"),
                    HasSubstr(",0.2,0.125,0,billiard,100,kl_noise_floor,")));
}

TEST_F(FigureTest, IngoingLawsStandOverTheirEquilibrium) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("ingoing-law", "--quick --delta 0.2,0.3 --epsilon 0.125,0.375 --samples 500"),
              HasSubstr("ε = 0.375"));
  // epsilon < 1/4 has two values of sigma.
  EXPECT_EQ(LineCount("ingoing-law.csv"), 1 + 2 * (2 + 1) * 25u);
  EXPECT_THAT(Data("ingoing-law.csv"),
              AllOf(HasSubstr("\n0.3,0.125,0,1,"), HasSubstr("\n0.2,0.375,0,-1,")));
}

TEST_F(FigureTest, HittingTimesStandBesideTheExponentialLaw) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("hitting-time", "--delta 0.2,0.3 --epsilon 0.125,0.375 --samples 500"),
              AllOf(HasSubstr("ε = 0.375"), HasSubstr("δ = 0.3")));
  EXPECT_EQ(LineCount("hitting-time.csv"), 1 + 2 * 2 * 80u);
  EXPECT_THAT(Data("hitting-time.csv"), HasSubstr(",0.3,0.375,1,billiard,500,survival,0,,1,0,1\n"));
}

TEST_F(FigureTest, TheMasterEquationStandsBesideBothModels) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("master-equation", "--delta 0.2,0.3 --epsilon 0.1,0.4 --samples 500"),
              AllOf(HasSubstr("δ = 0.3"), HasSubstr("jump process")));
  EXPECT_EQ(LineCount("master-equation.csv"), 1 + (2 + 1) * 2 * 6 * 61u);
  EXPECT_THAT(Data("master-equation.csv"),
              AllOf(HasSubstr("\nbilliard,0.3,0.4,8,"), HasSubstr("\nmarkov,0.2,0.1,0.25,")));
}

TEST_F(FigureTest, RelaxationStandsBesideItsLimit) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("relaxation", "--delta 0.2,0.3 --epsilon 0.1,0.4 --samples 300"),
              HasSubstr("δ = 0.3"));
  EXPECT_EQ(LineCount("relaxation-energy.csv"), 1 + 2 * 2 * 33u);
  EXPECT_THAT(Data("relaxation-energy.csv"), HasSubstr(",0.3,0.4,,billiard,300,mean_energy,0,,"));
  EXPECT_EQ(LineCount("relaxation-autocorrelation.csv"), 1 + 2 * 33u);
}

TEST_F(FigureTest, RatesHaveAllLengthsOfAllKinds) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  ASSERT_THAT(server_.Client(Split("figure rates --edit --out " + folder_)), ExitsWith(0));
  const std::string fewer_events =
      absl::StrReplaceAll(Data("rates.sh"), {{"by_effort 40000", "by_effort 8000"}});
  WriteFile(folder_ + "/rates.sh", fewer_events);
  const std::string quick = "figure rates --quick --epsilon 0.1,0.4 --out " + folder_;
  EXPECT_THAT(server_.Client(Split(quick)), ExitsWith(0));
  EXPECT_THAT(Data("rates.svg"), HasSubstr("ε = 0.4"));
  EXPECT_EQ(LineCount("rates.csv"), 1 + (2 + 2) * 17u);
  EXPECT_THAT(Data("rates.csv"), AllOf(HasSubstr("\nall,,"), HasSubstr("\nconditional,0.4,")));
}

TEST_F(FigureTest, RatesFailIfTheTraceFails) {
  const ProcessResult result =
      server_.Client(Split("figure rates --quick --seed none --out " + folder_));
  EXPECT_NE(result.exit_code, 0);
  EXPECT_FALSE(fs::exists(folder_ + "/rates.csv"));
}

TEST_F(FigureTest, MarkovTestFitsThePointsAboveTheNoise) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("markov-test",
                  "--quick --delta 0.2:0.325:12:log --epsilon 0.125,0.46875 --exponent 1,10 "
                  "--samples 20000"),
              HasSubstr("n = 10"));
  EXPECT_EQ(LineCount("markov-test-excess.csv"), 1 + 12 * 2 * 2u);
  // At epsilon = 0.125 fewer than ten points are above the noise, so there is no fit.
  EXPECT_EQ(LineCount("markov-test-fit.csv"), 1 + 4 + 4u);  // with the sums over the exponents
  EXPECT_THAT(Data("markov-test-fit.csv"), HasSubstr("\n0.46875,10,11,0.2,"));
  EXPECT_EQ(LineCount("markov-test-decay.csv"), 1 + 2 * 2u);
}

TEST_F(FigureTest, TheCellShowsItsParameters) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("cell", "--delta 0.1 --seed 3"), HasSubstr("δ = 0.1"));
  EXPECT_THAT(Data("cell.csv"), HasSubstr("\n0.529561127988977,0.1,0.34891252930760"));
}

TEST_F(FigureTest, TheCellInThreeDimensionsShowsItsCollisionSurface) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("cell-3d", "--rho 0.65 --delta 0.08"),
              AllOf(HasSubstr("q₁ = q₃"), HasSubstr("heights drawn × ")));
}

TEST_F(FigureTest, TheCollisionSurfaceHasTheVelocitiesOfOneEnergy) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("collision-surface", "--epsilon 0.3"), HasSubstr("ε = 0.3<"));
}

TEST_F(FigureTest, AnOrbitHasTheEventsOfBothBodies) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("orbit"), HasSubstr("piston, q₃"));
  for (const std::string body : {"ball", "piston"}) {
    const std::string data = Data("orbit-" + body + ".csv");
    EXPECT_THAT(data, StartsWith("time,event,x,y,energy\n0,start,"));
    EXPECT_THAT(data, HasSubstr("," + body + "_wall,"));
    EXPECT_THAT(data, HasSubstr(",ball_piston,"));
  }
}

TEST_F(FigureTest, TheKernelStandsBesideCollisionsOfTheBilliard) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("kernel", "--quick --epsilon 0.1,0.3"), HasSubstr("ε = 0.3<"));
  EXPECT_EQ(LineCount("kernel-exact.csv"), 1 + 2 * 499u);
  EXPECT_THAT(Data("kernel-measured.csv"), HasSubstr("\n0.1,"));
}

TEST_F(FigureTest, TheSpectrumHasRatesAndAutocorrelations) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("spectrum", "--delta 0.2,0.1 --samples 1000"),
              AllOf(HasSubstr("0.1521"), HasSubstr("δ = 0.1<")));
  EXPECT_THAT(Data("spectrum.csv"), HasSubstr(",spectral_gap,0.15208712661"));
  EXPECT_THAT(Data("spectrum-billiard.csv"),
              HasSubstr(",0.1,,,billiard,1000,energy_autocorrelation,"));
}

TEST_F(FigureTest, QuickAndFullExcludeEachOther) {
  const ProcessResult result = server_.Client(Split("figure cell --quick --full --out " + folder_));
  EXPECT_THAT(result, ExitsWith(2));
  EXPECT_THAT(result.err, HasSubstr("--quick and --full exclude each other"));
}

TEST_F(FigureTest, APictureThatIsCutOffIsReported) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  ASSERT_THAT(server_.Client(Split("figure cell --edit --out " + folder_)), ExitsWith(0));
  WriteFile(folder_ + "/cell.gnuplot", "set print 'cell.svg'\nprint '<svg>'\n");
  const ProcessResult result = server_.Client(Split("figure cell --out " + folder_));
  EXPECT_THAT(result, ExitsWith(4));
  EXPECT_THAT(result.err, HasSubstr("cell.svg is not complete: the disk may be full"));
}

TEST_F(FigureTest, ListPrintsTheNamesOfTheFigures) {
  const ProcessResult result = server_.Client({"figure", "--list"});
  EXPECT_THAT(result, ExitsWith(0));
  for (const std::string name :
       {"cell", "cell-3d", "collision-surface", "conductivity", "gas", "hitting-time",
        "ingoing-law", "kernel", "markov-test", "master-equation", "mean-free-time", "orbit",
        "rates", "relative-entropy", "relaxation", "spectrum", "speed-accuracy", "stability",
        "temperature-profile"}) {
    EXPECT_THAT("\n" + result.out, HasSubstr("\n" + name + ": "));
  }
}

}  // namespace
}  // namespace ballpiston

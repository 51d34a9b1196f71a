// Figures, each from one command, and resumed after an interruption.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <string>
#include <vector>

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
  static size_t LineCount(const std::string& text) {
    return Words(absl::StrSplit(text, '\n', absl::SkipEmpty())).size();
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
  for (const char* program : {"sh", "sed", "mv"}) {
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
  const auto draw = [this](const std::string& shape) {
    const std::string folder = folder_ + shape;
    const ProcessResult result =
        server_.Client(Split("figure gas --temperature 3 --cells " + shape + " --out " + folder));
    EXPECT_THAT(result, ExitsWith(0));
    EXPECT_EQ(result.err, "");
    EXPECT_THAT(Contents(folder + "/gas.svg"), HasSubstr("</svg>"));
    return folder;
  };
  const std::string lattice = draw("3x2"), chain = draw("4");
  EXPECT_EQ(LineCount(Contents(lattice + "/gas-balls.csv")), 1 + 6u);
  EXPECT_EQ(LineCount(Contents(lattice + "/gas-pistons.csv")), 1 + 12u);
  EXPECT_EQ(LineCount(Contents(chain + "/gas-pistons.csv")), 1 + 4u);
}

TEST_F(FigureTest, TemperatureProfilesHaveAllPlacesOfBothModels) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const ProcessResult result = server_.Client(
      Split("figure temperature-profile --cells 2,3 --samples 60 --billiard-samples 10 --delta 0.2 "
            "--hot 1.1 --out " +
            folder_));
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(result.err, "");
  const std::string markov = Contents(folder_ + "/temperature-profile-markov.csv");
  EXPECT_EQ(LineCount(markov), 1 + 5 + 7u);
  EXPECT_THAT(markov, HasSubstr(",2,1.1,0.5,markov,60,temperature_profile,,1.5,"));
  const std::string billiard = Contents(folder_ + "/temperature-profile-billiard.csv");
  EXPECT_EQ(LineCount(billiard), 1 + 5 + 7u);
  EXPECT_THAT(billiard, HasSubstr(",3,1.1,0.5,billiard,10,temperature_profile,,0,"));
  EXPECT_THAT(Contents(folder_ + "/temperature-profile.svg"), HasSubstr("N = 3"));
}

TEST_F(FigureTest, ConductivitiesStandBesideTheirLimit) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const ProcessResult result = server_.Client(
      Split("figure conductivity --cells 2,3 --samples 100 --delta 0.15,0.2 --billiard-cells 2 "
            "--billiard-samples 50 --out " +
            folder_));
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(Contents(folder_ + "/conductivity-billiard.csv"),
              HasSubstr(",0.2,,,2,1,billiard,50,conductivity_ratio,"));
  EXPECT_THAT(Contents(folder_ + "/conductivity-rings.csv"),
              HasSubstr(",0.15,,,3,1,markov,100,conductivity_ratio,"));
  EXPECT_THAT(Contents(folder_ + "/conductivity.svg"), HasSubstr("infinite: -1.8073"));
}

TEST_F(FigureTest, RelativeEntropiesStandBesideTheirFloors) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const ProcessResult result = server_.Client(
      Split("figure relative-entropy --delta 0.2,0.3 --epsilon 0.125,0.375 --samples 100 --out " +
            folder_));
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(result.err, "");
  const std::string data = Contents(folder_ + "/relative-entropy.csv");
  EXPECT_THAT(data, HasSubstr(",0.3,0.375,10,billiard,100,kl_divergence,"));
  EXPECT_THAT(data, HasSubstr(",0.2,0.125,0,billiard,100,kl_noise_floor,"));
  EXPECT_THAT(Contents(folder_ + "/relative-entropy.svg"), HasSubstr("ε = 0.125"));
}

TEST_F(FigureTest, IngoingLawsStandOverTheirEquilibrium) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const ProcessResult result = server_.Client(
      Split("figure ingoing-law --quick --delta 0.2,0.3 --epsilon 0.125,0.375 --samples 500 "
            "--out " +
            folder_));
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(result.err, "");
  const std::string data = Contents(folder_ + "/ingoing-law.csv");
  EXPECT_EQ(LineCount(data), 1 + 2 * (2 + 1) * 25u);  // epsilon < 1/4 has two values of sigma
  EXPECT_THAT(data, HasSubstr("\n0.3,0.125,0,1,"));
  EXPECT_THAT(data, HasSubstr("\n0.2,0.375,0,-1,"));
  EXPECT_THAT(Contents(folder_ + "/ingoing-law.svg"), HasSubstr("ε = 0.375"));
}

TEST_F(FigureTest, RelaxationStandsBesideItsLimit) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const ProcessResult result = server_.Client(
      Split("figure relaxation --delta 0.2,0.3 --epsilon 0.1,0.4 --samples 300 --out " + folder_));
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(result.err, "");
  const std::string energies = Contents(folder_ + "/relaxation-energy.csv");
  EXPECT_EQ(LineCount(energies), 1 + 2 * 2 * 33u);
  EXPECT_THAT(energies, HasSubstr(",0.3,0.4,,billiard,300,mean_energy,0,,"));
  EXPECT_EQ(LineCount(Contents(folder_ + "/relaxation-autocorrelation.csv")), 1 + 2 * 33u);
  EXPECT_THAT(Contents(folder_ + "/relaxation.svg"), HasSubstr("δ = 0.3"));
}

TEST_F(FigureTest, RatesHaveAllLengthsOfAllKinds) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const ProcessResult result =
      server_.Client(Split("figure rates --quick --epsilon 0.1,0.4 --out " + folder_));
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(result.err, "");
  const std::string data = Contents(folder_ + "/rates.csv");
  EXPECT_EQ(LineCount(data), 1 + (2 + 2) * 17u);
  EXPECT_THAT(data, HasSubstr("\nall,,"));
  EXPECT_THAT(data, HasSubstr("\nconditional,0.4,"));
  EXPECT_THAT(Contents(folder_ + "/rates.svg"), HasSubstr("ε = 0.4"));
}

TEST_F(FigureTest, RatesFailIfTheTraceFails) {
  const ProcessResult result =
      server_.Client(Split("figure rates --quick --seed none --out " + folder_));
  EXPECT_NE(result.exit_code, 0);
  EXPECT_FALSE(fs::exists(folder_ + "/rates.csv"));
}

TEST_F(FigureTest, MarkovTestFitsWhatIsAboveTheNoise) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const ProcessResult result = server_.Client(
      Split("figure markov-test --quick --delta 0.2:0.325:12:log --epsilon 0.125,0.46875 "
            "--exponent 1,10 --samples 20000 --out " +
            folder_));
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(LineCount(Contents(folder_ + "/markov-test-excess.csv")), 1 + 12 * 2 * 2u);
  // At epsilon = 0.125 fewer than ten points are above the noise, so there is no fit.
  const std::string fit = Contents(folder_ + "/markov-test-fit.csv");
  EXPECT_EQ(LineCount(fit), 1 + 4 + 4u);  // the last four are sums over the exponents
  EXPECT_THAT(fit, HasSubstr("\n0.46875,10,11,0.2,"));
  EXPECT_EQ(LineCount(Contents(folder_ + "/markov-test-decay.csv")), 1 + 2 * 2u);
  EXPECT_THAT(Contents(folder_ + "/markov-test.svg"), HasSubstr("n = 10"));
}

TEST_F(FigureTest, TheCellShowsItsParameters) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("cell", "--delta 0.1 --seed 3"), HasSubstr("δ = 0.1"));
  EXPECT_THAT(Contents(folder_ + "/cell.csv"),
              HasSubstr("\n0.529561127988977,0.1,0.34891252930760"));
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
    const std::string data = Contents(folder_ + "/orbit-" + body + ".csv");
    EXPECT_THAT(data, StartsWith("time,event,x,y,energy\n0,start,"));
    EXPECT_THAT(data, HasSubstr("," + body + "_wall,"));
    EXPECT_THAT(data, HasSubstr(",ball_piston,"));
  }
}

TEST_F(FigureTest, TheKernelStandsBesideCollisionsOfTheBilliard) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("kernel", "--quick --epsilon 0.1,0.3"), HasSubstr("ε = 0.3<"));
  EXPECT_EQ(Words(absl::StrSplit(Contents(folder_ + "/kernel-exact.csv"), '\n', absl::SkipEmpty()))
                .size(),
            1 + 2 * 499u);
  EXPECT_THAT(Contents(folder_ + "/kernel-measured.csv"), HasSubstr("\n0.1,"));
}

TEST_F(FigureTest, TheSpectrumHasRatesAndAutocorrelations) {
  if (!HasGnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_THAT(Svg("spectrum", "--delta 0.2,0.1 --samples 1000"),
              AllOf(HasSubstr("0.1521"), HasSubstr("δ = 0.1<")));
  EXPECT_THAT(Contents(folder_ + "/spectrum.csv"), HasSubstr(",spectral_gap,0.15208712661"));
  EXPECT_THAT(Contents(folder_ + "/spectrum-billiard.csv"),
              HasSubstr(",0.1,,,billiard,1000,energy_autocorrelation,"));
}

TEST_F(FigureTest, ListNamesThem) {
  const ProcessResult result = server_.Client({"figure", "--list"});
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_THAT(result.out, HasSubstr("cell: "));
  EXPECT_THAT(result.out, HasSubstr("cell-3d: "));
  EXPECT_THAT(result.out, HasSubstr("collision-surface: "));
  EXPECT_THAT(result.out, HasSubstr("orbit: "));
  EXPECT_THAT(result.out, HasSubstr("kernel: "));
  EXPECT_THAT(result.out, HasSubstr("spectrum: "));
  EXPECT_THAT(result.out, HasSubstr("stability: "));
  EXPECT_THAT(result.out, HasSubstr("mean-free-time: "));
  EXPECT_THAT(result.out, HasSubstr("speed-accuracy: "));
  EXPECT_THAT(result.out, HasSubstr("conductivity: "));
  EXPECT_THAT(result.out, HasSubstr("relative-entropy: "));
  EXPECT_THAT(result.out, HasSubstr("gas: "));
  EXPECT_THAT(result.out, HasSubstr("temperature-profile: "));
  EXPECT_THAT(result.out, HasSubstr("ingoing-law: "));
  EXPECT_THAT(result.out, HasSubstr("relaxation: "));
  EXPECT_THAT(result.out, HasSubstr("rates: "));
  EXPECT_THAT(result.out, HasSubstr("markov-test: "));
}

}  // namespace
}  // namespace ballpiston

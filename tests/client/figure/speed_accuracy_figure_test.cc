#include "client/figure/speed_accuracy_figure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/client/figure/measurements.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::client {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

constexpr char kFixedStep[] = "fixed-step";

MethodMeasurement FixedStep(double time_step, MethodMeasurement measurement) {
  measurement.time_step = time_step;
  return measurement;
}

std::vector<MethodMeasurement> Measurements() {
  return {
      FixedStep(0.01, Measured(kFixedStep, kMeanFreeTime, 100, 0.001, 0.4, 0.2)),
      FixedStep(0.01, Measured(kFixedStep, kMeanFreeTime, 400, 0.004, 0.5, 0.1)),
      Measured(kBilliard, kMeanFreeTime, 1600, 0.002, 0.0625, 0.03125),
      Measured(kClosedForm, kMeanFreeTime, 0, 1e-7, 6e-15, 0),
      Measured(kBilliard, kIngoingLaw, 1600, 0.002, -0.001, 0.002),
      Measured(kClosedForm, kIngoingLaw, 0, 1e-4, 0, 0),
      FixedStep(0.01, Measured(kFixedStep, kTrajectory, 64, 0.00064, 2.5, 0.25)),
      Measured(kBilliard, kTrajectory, 64, 1.6e-5, 31.5, 0.25),
      // The bias is 1/16 at delta = 0.2, and less than 2^-7 + 2 * 2^-6 = 5/128 at 0.1.
      RelaxationTime(kBilliard, 0.2, 256, 0.25, 0.03125, 0.125),
      RelaxationTime(kMarkov, 0.2, 256, 0.015625, 0.125, 0.0625),
      RelaxationTime(kSpectrum, 0.2, 0, 1e-6, 0.0625, 0),
      RelaxationTime(kBilliard, 0.1, 256, 0.5, 0.03125, 0.078125),
      RelaxationTime(kSpectrum, 0.1, 0, 1e-6, 0.0078125, 0.015625),
  };
}

TEST(SpeedAccuracyFigure, AsksForOneComparison) {
  EXPECT_THAT(ComparisonFlags({.rho = 0.53,
                               .delta = 0.2,
                               .epsilon = 0.25,
                               .seconds_per_curve = 3,
                               .seed = 7,
                               .relaxation_deltas = {0.2, 0.01}}),
              ElementsAre("--rho=0.53", "--delta=0.2", "--epsilon=0.25", "--seconds=3", "--seed=7",
                          "--relaxation-delta=0.2", "--relaxation-delta=0.01"));
  EXPECT_THAT(ComparisonFlags({}), SizeIs(5));  // the program chooses where relaxation is compared
}

TEST(SpeedAccuracyFigure, CsvHasEveryMeasurementAndTellsBiasFromChance) {
  ASSERT_OK_AND_ASSIGN(const SpeedAccuracyFiles files, MakeFiles({}, Measurements()));
  EXPECT_EQ(files.csv,
            "method,time_step,quantity,delta,samples,wall_hits,work_seconds,value,"
            "statistical_error,bias_resolved\n"
            "fixed-step,0.01,mean-free-time,0,100,10000,0.001,0.4,0.2,0\n"
            "fixed-step,0.01,mean-free-time,0,400,40000,0.004,0.5,0.1,1\n"
            "billiard,0,mean-free-time,0,1600,160000,0.002,0.0625,0.03125,0\n"
            "closed-form,0,mean-free-time,0,0,0,1e-07,6e-15,0,1\n"
            "billiard,0,ingoing-law,0,1600,160000,0.002,-0.001,0.002,0\n"
            "closed-form,0,ingoing-law,0,0,0,1e-04,0,0,0\n"
            "fixed-step,0.01,trajectory,0,64,6400,0.00064,2.5,0.25,\n"
            "billiard,0,trajectory,0,64,6400,1.6e-05,31.5,0.25,\n"
            "billiard,0,relaxation-time,0.2,256,0,0.25,0.03125,0.125,0\n"
            "markov,0,relaxation-time,0.2,256,0,0.015625,0.125,0.0625,0\n"
            "spectrum,0,relaxation-time,0.2,0,0,1e-06,0.0625,0,1\n"
            "billiard,0,relaxation-time,0.1,256,0,0.5,0.03125,0.078125,0\n"
            "spectrum,0,relaxation-time,0.1,0,0,1e-06,0.0078125,0.015625,0\n");
}

TEST(SpeedAccuracyFigure, ABiasIsMoreThanThreeStatisticalErrors) {
  EXPECT_FALSE(IsBiasResolved(Measured(kBilliard, kMeanFreeTime, 100, 1, 0.75, 0.25)));
  EXPECT_TRUE(IsBiasResolved(Measured(kBilliard, kMeanFreeTime, 100, 1, 0.76, 0.25)));
  EXPECT_FALSE(IsBiasResolved(Measured(kBilliard, kIngoingLaw, 100, 1, -0.76, 0.25)));
  EXPECT_FALSE(IsBiasResolved(Measured(kBilliard, kTrajectory, 100, 1, 31, 0.25)));
}

TEST(SpeedAccuracyFigure, ErrorOfAPanelWithoutRunsNamesTheFlag) {
  std::vector<MethodMeasurement> measurements = Measurements();
  for (MethodMeasurement& m : measurements) {
    if (m.quantity == kIngoingLaw) m.samples = 16;
  }
  EXPECT_THAT(MakeFiles({}, measurements),
              StatusIs(absl::StatusCode::kFailedPrecondition,
                       AllOf(HasSubstr("ingoing-law"), HasSubstr("--seconds"))));
}

class SpeedAccuracyScriptTest : public testing::Test {
 protected:
  const std::string script_ = MakeFiles({.rho = 0.53}, Measurements())->script;
};

TEST_F(SpeedAccuracyScriptTest, HasEveryPanel) {
  for (const char* title : {"{/:Bold a}  mean free time", "{/:Bold b}  law of the ingoing angle",
                            "{/:Bold c}  single orbits"}) {
    EXPECT_THAT(script_, HasSubstr(title));
  }
  for (const char* quantity : {"mean-free-time", "ingoing-law"}) {
    EXPECT_THAT(script_, HasSubstr(std::string("quantity = \"") + quantity + "\""));
  }
  EXPECT_THAT(script_, Not(HasSubstr("$NAME")));
}

TEST_F(SpeedAccuracyScriptTest, HasOneCurveAndOneLegendEntryForEachMethod) {
  EXPECT_THAT(script_, HasSubstr("methods = \"fixed-step billiard closed-form\""));
  EXPECT_THAT(script_, HasSubstr("array step = [0.01, 0, 0]"));
  for (const char* title : {"fixed time step Δt", "vector lanes, double", "closed form"}) {
    const std::string entry = std::string("title \"") + title + "\"";
    EXPECT_THAT(script_, HasSubstr(entry));
    EXPECT_EQ(script_.find(entry, script_.find(entry) + 1), std::string::npos);
  }
}

// The longest run of the first curve resolves 0.5; both its runs had a smaller statistical error.
TEST_F(SpeedAccuracyScriptTest, AResolvedBiasIsALineFromWhereChanceIsSmaller) {
  EXPECT_THAT(script_, HasSubstr("curve,x,y\n1,0.001,0.5\n1,0.0064,0.5\n"));
  EXPECT_THAT(script_, HasSubstr("curve,x,y\nEOD"));  // none in panel b
}

TEST_F(SpeedAccuracyScriptTest, AValueBelowTheEdgeIsDrawnThereWithItsNumber) {
  EXPECT_THAT(script_, HasSubstr("1e-07,0.0125,≤ 6×10^{-15}\n"));  // 0.4 of 0.03125
  EXPECT_THAT(script_, HasSubstr("edge = 0.0125\n"));
}

// 64 hits a run of 1.6e-5 s at 6400 hits: 2.5 ns.
TEST_F(SpeedAccuracyScriptTest, TheCostOfAnOrbitIsTheTimeOfAHit) {
  EXPECT_THAT(script_, HasSubstr("2,2.5,31.5,0.25\n"));
}

TEST_F(SpeedAccuracyScriptTest, RelaxationTimesAreInPanelDOnly) {
  EXPECT_THAT(script_, HasSubstr("methods = \"fixed-step billiard closed-form\""));
  EXPECT_THAT(script_, HasSubstr("{/:Bold d}  relaxation time"));
  EXPECT_THAT(script_, HasSubstr("deltas = \"0.2 0.1\"\n"));
}

// To 2.2 times 1.92 s, where the last ring stands.
TEST_F(SpeedAccuracyScriptTest, TheBiasOfTheLimitIsALineOrABound) {
  EXPECT_THAT(script_, HasSubstr("delta,resolved,x,y\n"
                                 "0.2,1,1e-06,0.0625\n0.2,1,4.224,0.0625\n\n"
                                 "0.1,0,1e-06,0.0390625\n0.1,0,4.224,0.0390625\n\n"));
  EXPECT_THAT(script_, HasSubstr("\"6.25 ± 0 %\""));
  EXPECT_THAT(script_, HasSubstr("\"≤ 3.9 %\""));
}

// 0.25 s at an error of 1/8, so 1 s at 1/16. At delta = 0.1 the billiard's own error, without the
// truth's, is 5/64 sqrt(0.96), so 0.5 s times 0.96 (5/64 / (5/128))^2 are enough for the bound.
TEST_F(SpeedAccuracyScriptTest, RingsStandWhereTheBilliardIsAsExactAsTheLimit) {
  EXPECT_THAT(script_, HasSubstr("delta,x,y\n0.2,1,0.0625\n0.1,1.92,0.0390625\n"));
  EXPECT_THAT(script_, HasSubstr("\"1.0 s\""));
  EXPECT_THAT(script_, HasSubstr("\"≥ 1.9 s\""));
}

TEST_F(SpeedAccuracyScriptTest, EachOfEightDeltasHasItsColour) {
  std::vector<MethodMeasurement> measurements = Measurements();
  for (const double delta : {0.3, 0.25, 0.15, 0.05, 0.02, 0.01}) {
    measurements.push_back(measurements.back());
    measurements.back().delta = delta;
  }
  const std::string script = MakeFiles({}, measurements)->script;
  EXPECT_THAT(script, HasSubstr("deltas = \"0.3 0.25 0.2 0.15 0.1 0.05 0.02 0.01\"\n"));
  EXPECT_THAT(script, HasSubstr("shades = \"#440154 #482475 #414487 #355f8d #2a788e #21918c "
                                "#22a884 #3bbb75\"\n"));
}

TEST_F(SpeedAccuracyScriptTest, WithoutRelaxationTimesThereIsNoPanelD) {
  std::vector<MethodMeasurement> measurements = Measurements();
  std::erase_if(measurements,
                [](const MethodMeasurement& m) { return m.quantity == kRelaxationTime; });
  ASSERT_OK_AND_ASSIGN(const SpeedAccuracyFiles files, MakeFiles({}, measurements));
  EXPECT_THAT(files.script, Not(HasSubstr("{/:Bold d}")));
  EXPECT_THAT(files.script, Not(HasSubstr("legend of d")));
  EXPECT_TRUE(files.script.ends_with("unset multiplot\n"));
}

// A script can be moved and run again: it holds only names of files in its own folder, no paths.
TEST_F(SpeedAccuracyScriptTest, NamesFilesBesideIt) {
  EXPECT_THAT(script_, HasSubstr("\"speed-accuracy.csv\""));
  EXPECT_THAT(script_, Not(HasSubstr("/speed-accuracy")));
}

}  // namespace
}  // namespace ballpiston::client

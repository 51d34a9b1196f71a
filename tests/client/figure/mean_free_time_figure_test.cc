#include "client/figure/mean_free_time_figure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "client/figure/mean_free_time_script.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::client {
namespace {

using ::testing::HasSubstr;

TEST(PaperEnergies, AreFiftyNine) {
  const std::vector<double> energies = PaperEnergies();
  EXPECT_EQ(energies.size(), 59u);
  EXPECT_TRUE(std::is_sorted(energies.begin(), energies.end()));
  EXPECT_EQ(std::set<double>(energies.begin(), energies.end()).size(), 59u);
  EXPECT_EQ(energies.front(), 1.0 / 3200);
  EXPECT_EQ(energies.back(), 0.5 - 1.0 / 3200);
  for (int i = 1; i <= 49; ++i) {
    EXPECT_TRUE(std::binary_search(energies.begin(), energies.end(), i / 100.0)) << i;
  }
}

TEST(MeanFreeTimeFigure, AsksForThePapersSweep) {
  const MeanFreeTimeQuestion question{.seed = 3};
  const v1::EnsembleSpec conditional = ConditionalSpec(question);
  EXPECT_EQ(conditional.experiment(), v1::EnsembleSpec::CONDITIONAL_MEAN_FREE_TIME);
  EXPECT_EQ(conditional.grid().rho(0), (std::sqrt(33) - 2) / (5 * std::sqrt(2)));
  EXPECT_EQ(conditional.grid().delta_size(), 3);
  EXPECT_EQ(conditional.grid().epsilon_size(), 59);
  EXPECT_EQ(conditional.target().samples(), 10'000);
  EXPECT_EQ(conditional.seed(), 3u);
  const v1::EnsembleSpec equilibrium = EquilibriumSpec(question);
  EXPECT_EQ(equilibrium.experiment(), v1::EnsembleSpec::EQUILIBRIUM);
  EXPECT_EQ(equilibrium.grid().epsilon_size(), 0);
  EXPECT_EQ(equilibrium.target().collisions(), 100'000);
}

// Without a model the service would answer with the closed forms, but the figure tests those.
TEST(MeanFreeTimeFigure, AsksForTheBilliardByName) {
  EXPECT_EQ(ConditionalSpec({}).model(), v1::EnsembleSpec::BILLIARD);
  EXPECT_EQ(EquilibriumSpec({}).model(), v1::EnsembleSpec::BILLIARD);
}

TEST(MeanFreeTimeFigure, TheCurveStaysWithinTheBoundOnDelta) {
  const MeanFreeTimeQuestion question;
  const v1::EvaluatePairsRequest request = CurveRequest(question, 0.3255);
  EXPECT_EQ(request.delta(0), 0.025);
  EXPECT_EQ(*request.delta().rbegin(), 0.3255);
  for (const double delta : request.delta()) EXPECT_LE(delta, 0.3255);
}

v1::PointResult Point(double delta, const char* name, double value, double error, double z) {
  v1::PointResult point;
  point.mutable_parameters()->set_rho(0.53);
  point.mutable_parameters()->set_delta(delta);
  point.set_samples(100);
  v1::Estimate* estimate = point.add_estimates();
  estimate->set_name(name);
  estimate->set_value(value);
  estimate->set_standard_error(error);
  estimate->set_exact(value);
  estimate->set_z_score(z);
  return point;
}

MeanFreeTimeAnswers Answers() {
  MeanFreeTimeAnswers answers;
  answers.conditional = {Point(0.1, "mean_free_time_conditional", 8, 0.5, -2.5)};
  answers.conditional[0].mutable_parameters()->set_epsilon(0.25);
  answers.equilibrium = {Point(0.1, "mean_free_time_ball_piston", 4, 0.5, 1)};
  v1::PairAnalytics* pair = answers.scale.add_points();
  pair->set_delta(0.1);
  pair->set_tau_ball_piston(4);
  pair->add_energies()->set_epsilon(0.25);
  pair->mutable_energies(0)->set_phi(0.5);
  pair = answers.curve.add_points();
  pair->set_delta(0.1);
  pair->set_tau_ball_piston(4);
  return answers;
}

TEST(MeanFreeTimeFigure, WritesRatesWithTheirErrors) {
  ASSERT_OK_AND_ASSIGN(const MeanFreeTimeFiles files,
                       MakeFiles({.rho = 0.53, .delta = {0.1}}, Answers()));
  EXPECT_EQ(files.measured_csv,
            "rho,delta,epsilon,samples,mean_free_time_conditional,standard_error,exact,z_score,"
            "scaled_rate,scaled_rate_error\n"
            "0.53,0.1,0.25,100,8,0.5,8,-2.5,0.5,0.03125\n");
  EXPECT_EQ(files.inset_csv,
            "rho,delta,collisions,mean_free_time_ball_piston,standard_error,exact,z_score,rate,"
            "rate_error\n"
            "0.53,0.1,100,4,0.5,4,1,0.25,0.03125\n");
  EXPECT_EQ(files.exact_csv, "curve,x,y\nphi,0.25,0.5\nrate,0.1,0.25\n");
}

TEST(MeanFreeTimeFigure, AnAnswerWithoutItsEstimateIsAnError) {
  MeanFreeTimeAnswers answers = Answers();
  answers.equilibrium[0].mutable_estimates(0)->set_name("other");
  EXPECT_THAT(MakeFiles({.delta = {0.1}}, answers), StatusIs(absl::StatusCode::kInternal));
}

TEST(MeanFreeTimeFigure, FindsTheLargestDeviationOfAll) {
  const LargestZ largest = LargestDeviation(Answers());
  EXPECT_EQ(largest.value, 2.5);
  EXPECT_EQ(largest.estimates, 2);
}

// A script can be moved and run again: it holds only names of files in its own folder, no paths.
TEST(MeanFreeTimeScript, NamesFilesBesideIt) {
  const std::string script = MeanFreeTimeScript({0.2, 0.05});
  EXPECT_THAT(script, HasSubstr("deltas = \"0.2 0.05\""));
  EXPECT_THAT(script, HasSubstr("\"mean-free-time.csv\""));
  EXPECT_EQ(script.find('/' + std::string("mean-free-time")), std::string::npos);
}

}  // namespace
}  // namespace ballpiston::client

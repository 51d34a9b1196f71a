// Questions that leave the choice of the model to the service. It chooses the cheapest model that
// can answer, and gives its reason.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

using google::protobuf::Value;
using ::testing::HasSubstr;

class LadderTest : public ::testing::Test {
 protected:
  google::protobuf::Struct Ask(const std::string& command) const {
    return server_.Json(Split(command));
  }

  const TestServer server_;
};

const Value& Estimate(const google::protobuf::Struct& document, const std::string& name) {
  static const Value absent;
  const Value& all = At(document, "points", 0, "estimates");
  for (const Value& estimate : all.list_value().values()) {
    if (At(estimate, "name").string_value() == name) return estimate;
  }
  ADD_FAILURE() << "no estimate " << name;
  return absent;
}

bool Has(const Value& value, const char* field) {
  return value.struct_value().fields().contains(field);
}

std::string ModelOf(const google::protobuf::Struct& document) {
  return At(document, "points", 0, "model").string_value();
}

std::string ReasonOf(const google::protobuf::Struct& document) {
  return At(document, "points", 0, "reason").string_value();
}

const char kRadius[] = " --rho 0.5296";

struct Question {
  std::string words;
  std::string model;  // that answers
};

TEST_F(LadderTest, APlanNamesTheModelAndMakesNoJob) {
  const std::vector<Question> questions = {
      {"equilibrium --delta 0.1", "CLOSED_FORM"},
      {"equilibrium --delta 0.1 --tolerance 1e-6", "CLOSED_FORM"},
      {"equilibrium --delta 0.1 --verify", "BILLIARD"},
      {"conditional-mean-free-time --delta 0.1 --epsilon 0.1", "CLOSED_FORM"},
      {"first-hit --delta 0.3 --epsilon 0.1 --exponent 1", "BILLIARD"},
      {"markov-property --delta 0.1", "BILLIARD"},
      {"lyapunov --delta 0.1 --estimate lyapunov_2 --tolerance 0.01", "BILLIARD"},
      {"gas-equilibrium --delta 0.1 --cells 8 --temperature 1", "CLOSED_FORM"},
      {"gas-equilibrium --delta 0.1 --cells 8 --temperature 1 --verify", "BILLIARD"},
      {"gas-equilibrium --delta 0.01 --cells 8 --temperature 1 --estimate conductivity "
       "--tolerance 0.05",
       "SPECTRUM"},
      {"gas-equilibrium --delta 0.19 --cells 8 --temperature 1 --estimate conductivity "
       "--tolerance 0.05",
       "BILLIARD"},
      {"gas-conduction --delta 0.1 --cells 8 --hot 2 --cold 1", "BILLIARD"},
      {"gas-conduction --delta 0.19 --cells 8 --hot 2 --cold 1 --tolerance 0.02", "BILLIARD"},
      {"gas-conduction --delta 0.02 --cells 8 --hot 2 --cold 1 --tolerance 0.02", "MARKOV"},
      {"energy-relaxation --delta 0.1", "BILLIARD"},
      {"energy-relaxation --delta 0.1 --model markov", "MARKOV"},
      {"energy-relaxation --delta 0.005 --tolerance 0.02", "SPECTRUM"},
      {"energy-relaxation --delta 0.005 --tolerance 1e-5", "BILLIARD"}};
  for (const Question& question : questions) {
    const auto plan = Ask("plan " + question.words + kRadius);
    EXPECT_EQ(ModelOf(plan), question.model) << question.words;
    EXPECT_EQ(Length(At(plan, "points", 0, "models")), 5) << question.words;
    EXPECT_GT(At(plan, "work").number_value(), 0) << question.words;
  }
  EXPECT_EQ(Length(At(Ask("list"), "jobs")), 0);
}

TEST_F(LadderTest, TheNamedEstimateIsTheFirstOfTheAnswer) {
  const std::string question =
      std::string("run gas-equilibrium --delta 0.01 --cells 8 --temperature 1 --tolerance 0.05") +
      kRadius;
  const auto answer = Ask(question + " --estimate conductivity");
  const auto& estimates = At(answer, "points", 0, "estimates");
  EXPECT_EQ(At(estimates, 0, "name").string_value(), "conductivity");
  EXPECT_EQ(At(answer, "job", "spec", "target", "estimate").string_value(), "conductivity");
  // The default estimate may be named or left out.
  const auto left_out = Ask(question), named = Ask(question + " --estimate exchange_rate");
  EXPECT_EQ(At(left_out, "points", 0, "estimates", 0, "name").string_value(), "exchange_rate");
  EXPECT_EQ(At(named, "job", "name").string_value(), At(left_out, "job", "name").string_value());
}

TEST_F(LadderTest, AMeanFreeTimeIsAnsweredByItsClosedFormWithoutASample) {
  const auto answer = Ask(std::string("run equilibrium --delta 0.1 --tolerance 1e-6") + kRadius);
  EXPECT_EQ(ModelOf(answer), "CLOSED_FORM");
  EXPECT_THAT(ReasonOf(answer), HasSubstr("exact at every delta"));
  EXPECT_EQ(At(answer, "points", 0, "samples").number_value(), 0);
  const Value& time = Estimate(answer, "mean_free_time_ball_piston");
  EXPECT_EQ(At(time, "value").number_value(), At(time, "exact").number_value());
  EXPECT_EQ(At(time, "model_error").number_value(), 0);
}

TEST_F(LadderTest, VerifyRunsTheBilliardBesideTheClosedForm) {
  const auto answer =
      Ask(std::string("run equilibrium --delta 0.1 --collisions 5000 --verify") + kRadius);
  EXPECT_EQ(ModelOf(answer), "BILLIARD");
  EXPECT_EQ(At(answer, "points", 0, "samples").number_value(), 5000);
  for (const char* name :
       {"mean_free_time_ball_piston", "mean_free_time_ball_wall", "mean_free_time_piston_wall"}) {
    const Value& time = Estimate(answer, name);
    EXPECT_TRUE(Has(time, "exact"));
    EXPECT_TRUE(Has(time, "z_score"));
    // Seed 0 alone, and beyond 5 by chance with probability 6e-7.
    EXPECT_LT(std::abs(At(time, "z_score").number_value()), 5) << name;
    EXPECT_EQ(At(time, "model_error").number_value(), 0);
  }
}

TEST_F(LadderTest, RelaxationByTheBilliardHasTheLimitBesideIt) {
  const auto answer =
      Ask(std::string("run energy-relaxation --delta 0.1 --samples 2000") + kRadius);
  EXPECT_EQ(ModelOf(answer), "BILLIARD");
  EXPECT_EQ(At(answer, "points", 0, "samples").number_value(), 2000);
  const Value& time = Estimate(answer, "relaxation_time");
  const double limit = At(time, "limit").number_value();
  const double error = At(time, "standard_error").number_value();
  EXPECT_GT(error, 0);
  // The limit's own error is 2 % here; 5 standard errors beside it.
  EXPECT_NEAR(At(time, "value").number_value(), limit, 0.05 * limit + 5 * error);
  EXPECT_FALSE(Has(time, "exact"));
  EXPECT_EQ(At(time, "model_error").number_value(), 0);
  const Value& curve = At(answer, "points", 0, "curves", 0);
  EXPECT_EQ(At(curve, "name").string_value(), "energy_autocorrelation");
  const int points = Length(At(curve, "points"));
  EXPECT_GT(points, 10);
  for (int i = 0; i < points; ++i) {
    for (const char* field : {"time", "value", "standard_error", "limit"}) {
      EXPECT_TRUE(Has(At(curve, "points", i), field)) << field << " of point " << i;
    }
  }
  EXPECT_EQ(At(curve, "points", 0, "time").number_value(), 0);
  EXPECT_NEAR(At(curve, "points", 0, "limit").number_value(), 1, 1e-12);
}

TEST_F(LadderTest, RelaxationByTheJumpProcessAgreesWithItsSpectrum) {
  const std::string question = std::string("run energy-relaxation --delta 0.1") + kRadius;
  const auto jumps = Ask(question + " --samples 2000 --model markov");
  EXPECT_EQ(ModelOf(jumps), "MARKOV");
  const Value& time = Estimate(jumps, "relaxation_time");
  EXPECT_LT(std::abs(At(time, "z_score").number_value()), 5);
  EXPECT_GT(At(time, "model_error").number_value(), 0);
  const auto spectrum = Ask(question + " --model spectrum");
  EXPECT_EQ(ModelOf(spectrum), "SPECTRUM");
  EXPECT_EQ(At(spectrum, "points", 0, "samples").number_value(), 0);
  EXPECT_EQ(At(Estimate(spectrum, "relaxation_time"), "value").number_value(),
            At(time, "exact").number_value());
  for (const auto& answer : {jumps, spectrum}) {
    // The six digits that are printed.
    EXPECT_NEAR(At(Estimate(answer, "spectral_gap"), "value").number_value(), 0.152087, 5e-7);
  }
}

TEST_F(LadderTest, ABudgetEndsARunAndItSucceeds) {
  const auto answer = Ask(
      std::string("run first-hit --delta 0.1 --epsilon 0.1 --exponent 1 --budget 0.2") + kRadius);
  EXPECT_EQ(At(answer, "job", "state").string_value(), "SUCCEEDED");
  EXPECT_GT(At(answer, "points", 0, "samples").number_value(), 0);
  EXPECT_GT(At(Estimate(answer, "mean_hit_time"), "standard_error").number_value(), 0);
}

// The result holds the number of samples that the budget permitted. A job with this number of
// samples gives the same values.
TEST_F(LadderTest, TheSamplesOfABudgetGiveTheSameNumbersAgain) {
  const std::string question =
      std::string("run first-hit --delta 0.2 --epsilon 0.1 --exponent 1 --seed 4") + kRadius;
  const auto answer = Ask(question + " --budget 0.05");
  const auto samples = static_cast<int64_t>(At(answer, "points", 0, "samples").number_value());
  const auto again = Ask(question + " --samples " + std::to_string(samples));
  const Value& first = Estimate(answer, "mean_hit_time");
  const Value& second = Estimate(again, "mean_hit_time");
  // The blocks differ, so the same samples are summed in another order.
  EXPECT_NEAR(At(first, "value").number_value() / At(second, "value").number_value(), 1, 1e-12);
}

TEST_F(LadderTest, AToleranceBeyondTheBudgetFailsAndPrintsTheAccuracyReached) {
  const ProcessResult result = server_.Client(
      Split("run first-hit --rho 0.5296 --delta 0.1 --epsilon 0.1 --exponent 1 --tolerance 1e-6 "
            "--budget 0.3 --format json"));
  EXPECT_THAT(result, ExitsWith(4));
  EXPECT_THAT(result.err, HasSubstr("point 0: tolerance 1e-06 was not reached within the budget "
                                    "of 0.3 s: reached "));
  const auto answer = ParseJson(result.out);
  EXPECT_EQ(At(answer, "job", "state").string_value(), "FAILED");
  const Value& time = Estimate(answer, "mean_hit_time");
  const double reached =
      At(time, "standard_error").number_value() / At(time, "value").number_value();
  double told = 0;
  ASSERT_EQ(std::sscanf(result.err.c_str() + result.err.rfind("reached ") + 8, "%lf", &told), 1);
  EXPECT_NEAR(told / reached, 1, 0.05);  // two digits
}

// A pilot of some seconds measures the error of the limit. Then the spectrum answers.
TEST_F(LadderTest, APilotLetsTheSpectrumAnswerATolerance) {
  const std::string question = "energy-relaxation --rho 0.5296 --delta 0.005 --tolerance 0.02";
  const auto plan = Ask("plan " + question);
  EXPECT_THAT(ReasonOf(plan), HasSubstr("expected of a pilot"));
  const Words words = Split("run " + question + " --fresh --format json");
  const ProcessResult first = server_.Client(words);
  ASSERT_THAT(first, ExitsWith(0));
  const auto answer = ParseJson(first.out);
  EXPECT_EQ(ModelOf(answer), "SPECTRUM");
  EXPECT_THAT(ReasonOf(answer), HasSubstr("two sigma of a pilot at delta = "));
  EXPECT_EQ(At(answer, "points", 0, "samples").number_value(), 0);
  const Value& time = Estimate(answer, "relaxation_time");
  const double error = At(time, "model_error").number_value();
  EXPECT_GT(error, 0);
  EXPECT_LT(error, 0.02 * At(time, "value").number_value());
  // The pilot is stored, so no second pilot runs.
  EXPECT_THAT(ReasonOf(Ask("plan " + question)), HasSubstr("two sigma of a pilot at delta = "));
  const ProcessResult again = server_.Client(words);
  EXPECT_EQ(PointsOf(again.out), PointsOf(first.out));
  EXPECT_LT(At(ParseJson(again.out), "job", "work").number_value(),
            0.1 * At(answer, "job", "work").number_value());
  // Another server that runs the pilot itself gives the same bytes.
  const TestServer other(1);
  EXPECT_EQ(PointsOf(other.Client(words).out), PointsOf(first.out));
}

}  // namespace
}  // namespace ballpiston

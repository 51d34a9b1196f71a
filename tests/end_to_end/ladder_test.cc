// Questions that leave the choice of the model to the service. It chooses the cheapest model that
// can answer, and gives its reason.

#include <cstdio>

#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

using google::protobuf::Value;

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

std::string ModelOf(const google::protobuf::Struct& document) {
  return At(document, "points", 0, "model").string_value();
}

std::string ReasonOf(const google::protobuf::Struct& document) {
  return At(document, "points", 0, "reason").string_value();
}

const char kRadius[] = " --rho 0.5296";

TEST_F(LadderTest, APlanNamesTheModelAndMakesNoJob) {
  const std::pair<std::string, std::string> rows[] = {
      {"equilibrium --delta 0.1", "CLOSED_FORM"},
      {"equilibrium --delta 0.1 --verify", "BILLIARD"},
      {"gas-conduction --delta 0.02 --cells 8 --hot 2 --cold 1 --tolerance 0.02", "MARKOV"},
      {"energy-relaxation --delta 0.005 --tolerance 0.02", "SPECTRUM"}};
  for (const auto& [question, model] : rows) {
    const auto plan = Ask("plan " + question + kRadius);
    EXPECT_EQ(ModelOf(plan), model) << question;
    EXPECT_GT(At(plan, "work").number_value(), 0) << question;
  }
  EXPECT_EQ(Length(At(Ask("list"), "jobs")), 0);
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

// Questions that leave the choice of the model to the service. tests/server/compute/
// model_ladder_test.cc tests the choice itself.
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

// A field of the first point that is a text.
std::string TextOf(const google::protobuf::Struct& document, const char* field) {
  return At(document, "points", 0, field).string_value();
}

double NumberOf(const google::protobuf::Struct& document, const char* estimate, const char* field) {
  for (const auto& each : At(document, "points", 0, "estimates").list_value().values()) {
    if (At(each, "name").string_value() == estimate) return At(each, field).number_value();
  }
  ADD_FAILURE() << "no estimate " << estimate;
  return NAN;
}

// The result holds the number of samples that the budget permitted. A job with this number of
// samples gives the same values.
TEST(Budget, ItsNumberOfSamplesGivesTheSameNumbersAgain) {
  const TestServer server;
  const std::string question =
      "run first-hit --rho 0.5296 --delta 0.2 --epsilon 0.1 --exponent 1 --seed 4";
  const auto answer = server.Json(Split(question + " --budget 0.05"));
  const double samples = At(answer, "points", 0, "samples").number_value();
  const auto again = server.Json(Split(absl::StrFormat("%s --samples %.0f", question, samples)));
  // The blocks differ, so the same samples are summed in another order.
  EXPECT_NEAR(NumberOf(answer, "mean_hit_time", "value"), NumberOf(again, "mean_hit_time", "value"),
              1e-12 * NumberOf(answer, "mean_hit_time", "value"));
}

// A pilot of some seconds measures the error of the limit. Then the spectrum answers.
TEST(Pilot, LetsTheSpectrumAnswerATolerance) {
  const TestServer server;
  const std::string question =
      "energy-relaxation --rho 0.5296 --delta 0.005 --tolerance 0.02 --format json";
  const std::string plan = "plan " + question;
  EXPECT_THAT(server.Client(Split(plan)).out, HasSubstr("expected of a pilot"));
  const Words run = Split("run --fresh " + question);
  const ProcessResult first = server.Client(run);
  ASSERT_THAT(first, ExitsWith(0));
  const auto answer = ParseJson(first.out);
  EXPECT_EQ(TextOf(answer, "model"), "SPECTRUM");
  EXPECT_THAT(TextOf(answer, "reason"), HasSubstr("two sigma of a pilot at delta = "));
  const double error = NumberOf(answer, "relaxation_time", "model_error");
  EXPECT_GT(error, 0);
  EXPECT_LT(error, 0.02 * NumberOf(answer, "relaxation_time", "value"));
  // The pilot is stored, so no second pilot runs.
  const ProcessResult again = server.Client(run);
  EXPECT_EQ(PointsOf(again.out), PointsOf(first.out));
  EXPECT_LT(At(ParseJson(again.out), "job", "work").number_value(),
            0.1 * At(answer, "job", "work").number_value());
  // Another server that runs the pilot itself gives the same bytes.
  EXPECT_EQ(PointsOf(TestServer(1).Client(run).out), PointsOf(first.out));
}

}  // namespace
}  // namespace ballpiston

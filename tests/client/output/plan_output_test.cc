#include "client/output/plan_output.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>

#include "tests/support/message_text.h"

namespace ballpiston::client {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

v1::EnsembleSpec Question(const std::string& target = "tolerance: 1e-2 budget { seconds: 90 }") {
  return FromText<v1::EnsembleSpec>("experiment: ENERGY_RELAXATION target {" + target + "}");
}

// The relaxation time near the limit, where the reduced models can be used, and far from it.
constexpr char kLadders[] = R"(
    points {
      parameters { rho: 0.529561127988977 delta: 0.0125 }
      models { model: CLOSED_FORM reason: "no closed form is known" }
      models { model: SPECTRUM answers: true work: 0.0123 relative_statistical_error: 0 relative_model_error: 2.1e-3
               reason: "pilot, 3.0e-04" }
      models { model: MARKOV answers: true samples: 40123 work: 0.21 relative_statistical_error: 1e-2
               relative_model_error: 2.1e-3 }
      models { model: BILLIARD answers: true samples: 40123 work: 192 relative_statistical_error: 1e-2
               relative_model_error: 0 }
      model: SPECTRUM reason: "cheapest within the tolerance" }
    points {
      parameters { rho: 0.529561127988977 delta: 0.2 epsilon: 0.1 }
      models { model: SPECTRUM work: 120e-6 relative_statistical_error: 0 relative_model_error: 0.34
               reason: "off by 3.4e-01, \"too much\"" }
      models { model: BILLIARD answers: true samples: 4.0123e8 work: 15 relative_statistical_error: 1e-2
               relative_model_error: 0 }
      model: BILLIARD reason: "the billiard itself" }
    point_count: 2 work: 15.0123 time: 7.6 workers: 2 memory: 25200000)";

v1::PlanEnsembleJobResponse Plan() { return FromText<v1::PlanEnsembleJobResponse>(kLadders); }

std::string PrintedPlan(Format format, const v1::PlanEnsembleJobResponse& plan = Plan(),
                        const v1::EnsembleSpec& spec = Question()) {
  std::ostringstream out;
  PrintPlan(spec, plan, format, out);
  return out.str();
}

TEST(PlanTable, HeadingNamesTheGivenEstimate) {
  EXPECT_THAT(PrintedPlan(Format::kTable, Plan(), Question("tolerance: 1e-2 estimate: 'current'")),
              StartsWith("energy-relaxation, estimate current, tolerance 0.01, 2 points"));
}

TEST(PlanTable, PrintsTheLadderOfEachPointAndMarksTheChoice) {
  EXPECT_EQ(
      PrintedPlan(Format::kTable),
      R"(energy-relaxation, tolerance 0.01, budget 90 s, 2 points  (work of one core, relative errors)

rho 0.529561128, delta 0.0125
    model        answers  samples     work  stat. error  model error  remark
    closed-form  no                                                   no closed form is known
 >  spectrum     yes                 12 ms            0      2.1e-03  pilot, 3.0e-04
    markov       yes        40123   210 ms      1.0e-02      2.1e-03
    billiard     yes        40123  3.2 min      1.0e-02            0
 > spectrum: cheapest within the tolerance

rho 0.529561128, delta 0.2, epsilon 0.1
    model     answers  samples    work  stat. error  model error  remark
    spectrum  no                120 µs            0      3.4e-01  off by 3.4e-01, "too much"
 >  billiard  yes      4.0e+08    15 s      1.0e-02            0
 > billiard: the billiard itself

2 points: 15 s of one core, 7.6 s with this server's 2 workers, up to 26 MB of memory
)");
}

TEST(PlanTable, NamesTheTarget) {
  const auto heading = [](const std::string& target) {
    const std::string text = PrintedPlan(Format::kTable, {}, Question(target));
    return text.substr(0, text.find("  ("));
  };
  EXPECT_EQ(heading(""), "energy-relaxation, 0 points");
  EXPECT_EQ(heading("samples: 1000000"), "energy-relaxation, 1000000 samples per point, 0 points");
  EXPECT_EQ(heading("collisions: 5"), "energy-relaxation, 5 collisions per point, 0 points");
  EXPECT_EQ(heading("budget { nanos: 500000000 }"), "energy-relaxation, budget 0.5 s, 0 points");
}

TEST(PlanTable, SaysThatNoModelAnswers) {
  const std::string text =
      PrintedPlan(Format::kTable, FromText<v1::PlanEnsembleJobResponse>(
                                      R"(points { models { model: MARKOV } reason: "out of reach" }
                             point_count: 1 workers: 1)"));
  EXPECT_THAT(text, HasSubstr("\n   markov  no\n > none: out of reach\n"));
  EXPECT_THAT(text, HasSubstr("\n1 point: 0 s of one core, 0 s with this server's 1 worker, "));
}

v1::PlanEnsembleJobResponse PlanOfMany(int points) {
  v1::PlanEnsembleJobResponse plan;
  const auto two = Plan();
  for (int i = 0; i < points; ++i) *plan.add_points() = two.points(i == 0 ? 0 : 1);
  plan.set_point_count(points);
  plan.set_workers(2);
  return plan;
}

TEST(PlanTable, ManyPointsHaveOneRowEach) {
  const std::string text = PrintedPlan(Format::kTable, PlanOfMany(kMostLadders + 1));
  EXPECT_THAT(
      text,
      StartsWith(
          R"(energy-relaxation, tolerance 0.01, budget 90 s, 9 points  (work of one core, relative errors)

        rho   delta  epsilon  model     samples   work  stat. error  model error
0.529561128  0.0125           spectrum           12 ms            0      2.1e-03
0.529561128     0.2      0.1  billiard  4.0e+08   15 s      1.0e-02            0
)"));
  EXPECT_THAT(
      text, HasSubstr("\nspectrum (rho 0.529561128, delta 0.0125): cheapest within the tolerance\n"
                      "billiard (rho 0.529561128, delta 0.2, epsilon 0.1 and 7 more points): the "
                      "billiard itself\n"));
  EXPECT_THAT(PrintedPlan(Format::kTable, PlanOfMany(kMostLadders)), Not(HasSubstr("more points")));
}

TEST(PlanTable, SaysThatItShowsOnlySomePoints) {
  v1::PlanEnsembleJobResponse plan = Plan();
  plan.set_point_count(5000);
  const std::string text = PrintedPlan(Format::kTable, plan);
  EXPECT_THAT(text, HasSubstr("\nShown: 2 points, evenly spread over the grid.\n5000 points: "));
}

TEST(PlanCsv, HasARowForEachPointAndModel) {
  EXPECT_EQ(
      PrintedPlan(Format::kCsv),
      R"(rho,delta,epsilon,exponent,model,chosen,answers,samples,work,relative_statistical_error,relative_model_error,reason
0.529561127988977,0.0125,,,closed-form,false,false,,,,,no closed form is known
0.529561127988977,0.0125,,,spectrum,true,true,,0.0123,0,0.0021,"cheapest within the tolerance; pilot, 3.0e-04"
0.529561127988977,0.0125,,,markov,false,true,40123,0.21,0.01,0.0021,
0.529561127988977,0.0125,,,billiard,false,true,40123,192,0.01,0,
0.529561127988977,0.2,0.1,,spectrum,false,false,,0.00012,0,0.34,"off by 3.4e-01, ""too much"""
0.529561127988977,0.2,0.1,,billiard,true,true,401230000,15,0.01,0,the billiard itself
)");
}

TEST(PlanCsv, HasColumnsForTheParametersOfAGas) {
  v1::EnsembleSpec question = Question();
  *question.mutable_grid() = FromText<v1::Grid>("cells: '4x3' temperature: 1");
  const auto plan = FromText<v1::PlanEnsembleJobResponse>(R"(
      points { parameters { rho: 0.53 delta: 0.1 cells: "4x3" temperature: 1 }
               models { model: BILLIARD answers: true } model: BILLIARD })");
  EXPECT_EQ(
      PrintedPlan(Format::kCsv, plan, question),
      R"(rho,delta,epsilon,exponent,cells,temperature,model,chosen,answers,samples,work,relative_statistical_error,relative_model_error,reason
0.53,0.1,,,4x3,1,billiard,true,true,,,,,
)");
}

TEST(PlanJson, IsTheResponseWithTheProtosNames) {
  const std::string text = PrintedPlan(Format::kJson);
  v1::PlanEnsembleJobResponse read;
  ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(text, &read).ok()) << text;
  EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(read, Plan())) << text;
  EXPECT_THAT(text, HasSubstr("\"relative_statistical_error\":0.01"));
  EXPECT_THAT(text, HasSubstr("\"point_count\":2"));
  EXPECT_THAT(text, EndsWith("\n"));
}

TEST(PlanJsonl, HasALineForEachPoint) {
  const std::string text = PrintedPlan(Format::kJsonl);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
  EXPECT_THAT(text, StartsWith("{\"parameters\":{\"rho\":0.529561127988977,"));
  EXPECT_THAT(text, EndsWith("\"model\":\"BILLIARD\",\"reason\":\"the billiard itself\"}\n"));
}

}  // namespace
}  // namespace ballpiston::client

#include "client/command/question.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_split.h"
#include "tests/client/program.h"
#include "tests/support/message_text.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::client {
namespace {

using ::testing::HasSubstr;

class QuestionTest : public ::testing::Test {
 protected:
  // The specification of `run WORDS`.
  static absl::StatusOr<v1::EnsembleSpec> Spec(const std::string& words) {
    const auto line = ParseCommandLine(absl::StrSplit("run " + words, ' ', absl::SkipEmpty()));
    return line.ok() ? SpecOf(line->options) : line.status();
  }

  const EmptyHome home_;
};

TEST_F(QuestionTest, EachFlagReachesItsField) {
  const std::pair<std::string, std::string> table[] = {
      {"", ""},
      {"--rho 0.53 --delta=0.1,0.2", "grid { rho: 0.53 delta: [0.1, 0.2] }"},
      {"--epsilon 0.25 --exponent 0:2:3", "grid { epsilon: 0.25 exponent: [0, 1, 2] }"},
      {"--cells 12,4x3,2:6:3", "grid { cells: ['12', '4x3', '2', '4', '6'] }"},
      {"--temperature 0.5:1.5:3", "grid { temperature: [0.5, 1, 1.5] }"},
      {"--hot 2,3 --cold 1", "grid { hot: [2, 3] cold: 1 }"},
      {"--samples 1e6", "target { samples: 1000000 }"},
      {"--collisions 5", "target { collisions: 5 }"},
      {"--tolerance -1e-3", "target { tolerance: -1e-3 }"},
      {"--budget 90.5", "target { budget { seconds: 90 nanos: 500000000 } }"},
      {"--budget 0.3", "target { budget { nanos: 300000000 } }"},
      {"--budget 1.9999999999", "target { budget { seconds: 2 } }"},
      {"--budget -0.25", "target { budget { nanos: -250000000 } }"},
      {"--budget 1e300", "target { budget { seconds: 315576000000 } }"},
      {"--budget 10 --tolerance 1e-3", "target { tolerance: 1e-3 budget { seconds: 10 } }"},
      {"--estimate conductivity", "target { estimate: 'conductivity' }"},
      {"--tolerance 0.05 --estimate=anything", "target { tolerance: 0.05 estimate: 'anything' }"},
      {"--samples 5 --estimate exchange_rate", "target { samples: 5 estimate: 'exchange_rate' }"},
      {"--seed 18446744073709551615", "seed: 18446744073709551615"},
      {"--model billiard_reference", "model: BILLIARD_REFERENCE"},
      {"--model closed-form", "model: CLOSED_FORM"},
      {"--precision single --verify", "precision: SINGLE verify: true"}};
  for (const auto& [words, text] : table) {
    ASSERT_OK_AND_ASSIGN(const v1::EnsembleSpec spec, Spec("first-hit " + words));
    EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(
        spec, FromText<v1::EnsembleSpec>("experiment: FIRST_HIT " + text)))
        << words << "\n"
        << spec.DebugString();
  }
}

TEST_F(QuestionTest, ExperimentsAreReadInBothSpellings) {
  for (const auto& [word, experiment] :
       {std::pair{"conditional_mean_free_time", v1::EnsembleSpec::CONDITIONAL_MEAN_FREE_TIME},
        {"energy-relaxation", v1::EnsembleSpec::ENERGY_RELAXATION},
        {"equilibrium", v1::EnsembleSpec::EQUILIBRIUM}}) {
    ASSERT_OK_AND_ASSIGN(const v1::EnsembleSpec spec, Spec(word));
    EXPECT_EQ(spec.experiment(), experiment);
  }
}

TEST_F(QuestionTest, TheFirstErrorIsNamed) {
  const std::pair<std::string, std::string> table[] = {
      {"", "name an EXPERIMENT (equilibrium, "},
      {"brownian", "EXPERIMENT: 'brownian' is not one of equilibrium, "},
      {"experiment-unspecified", "is not one of equilibrium, "},
      {"first-hit --delta 0.1,nan", "--delta: 'nan' is not a decimal number"},
      {"first-hit --cells 4x4,4y4", "--cells: '4y4' is not a shape: write N, "},
      {"first-hit --hot inf", "--hot: 'inf' is not a decimal number"},
      {"first-hit --budget soon", "--budget: 'soon' is not a decimal number"},
      {"first-hit --budget 1e-10", "1e-10 is below the least budget; permitted: 1e-9 to 1e6 s"},
      {"first-hit --samples many", "--samples: 'many' is not a whole number"},
      {"first-hit --seed -1", "--seed: '-1' is not a whole number"},
      {"first-hit --model guess", "--model: 'guess' is not one of auto, closed-form, "},
      {"first-hit --precision half", "--precision: 'half' is not one of double, single"}};
  for (const auto& [words, text] : table) {
    EXPECT_THAT(Spec(words), StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(text)));
  }
}

TEST_F(QuestionTest, TargetsExcludeEachOther) {
  const std::pair<std::string, std::string> table[] = {
      {"--samples 10 --tolerance 0.1",
       "--samples and --tolerance exclude each other: give at most"},
      {"--budget 1 --samples 10 --tolerance 1", "--samples and --tolerance and --budget exclude"},
      {"--samples 10 --budget 1", "--samples and --budget exclude each other"},
      {"--collisions 10 --budget 1", "--collisions and --budget exclude each other"}};
  for (const auto& [words, text] : table) {
    EXPECT_THAT(Spec("first-hit " + words),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(text)));
  }
}

TEST_F(QuestionTest, AFileExcludesExperimentGridTargetAndMethod) {
  const std::string file = home_.File("question.json");
  WriteFile(file, R"({"experiment": "FIRST_HIT", "seed": 7})");
  ASSERT_OK_AND_ASSIGN(const v1::EnsembleSpec spec, Spec("--spec " + file + " --priority 3"));
  EXPECT_EQ(spec.seed(), 7u);
  for (const char* word : {" first-hit", " --rho 0.53", " --samples 9", " --seed 1", " --verify",
                           " --estimate conductivity"}) {
    EXPECT_THAT(Spec("--spec " + file + word),
                StatusIs(absl::StatusCode::kInvalidArgument,
                         HasSubstr("--spec holds the whole specification")));
  }
}

class QuestionOfJobTest : public ProgramTest {
 protected:
  QuestionOfJobTest() {
    *job().mutable_spec() = FromText<v1::EnsembleSpec>(
        "experiment: FIRST_HIT seed: 7 grid { rho: 0.53 delta: 0.1 } target { samples: 9 }");
  }
};

TEST_F(QuestionOfJobTest, TheSpecificationOfAJobIsSubmittedAgain) {
  for (const char* verb : {"submit", "run"}) {
    const Outcome outcome = WithServer({verb, "--again", "abc", "--priority", "3"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const v1::CreateEnsembleJobRequest asked = server_.ensemble.Asked().create.back();
    EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(asked.spec(), job().spec()));
    EXPECT_EQ(asked.priority(), 3);
    EXPECT_FALSE(asked.fresh());
  }
}

TEST_F(QuestionOfJobTest, TheSpecificationOfAJobIsPlanned) {
  EXPECT_EQ(WithServer({"plan", "--again", "ensembleJobs/abc"}).code, 0);
  EXPECT_EQ(server_.ensemble.Asked().plan.at(0).spec().seed(), 7u);
}

TEST_F(QuestionOfJobTest, AJobExcludesExperimentGridTargetAndMethod) {
  for (const std::vector<std::string>& words : {std::vector<std::string>{"first-hit"},
                                                {"--rho", "0.53"},
                                                {"--samples", "9"},
                                                {"--seed", "1"},
                                                {"--estimate", "conductivity"},
                                                {"--verify"},
                                                {"--spec", "question.json"}}) {
    std::vector<std::string> all = {"submit", "--again", "abc"};
    all.insert(all.end(), words.begin(), words.end());
    const Outcome outcome = WithServer(all);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.err,
              "ballpiston: --again holds the whole specification: give no EXPERIMENT, grid, "
              "target, --seed, --model, --estimate, --verify, --precision or --spec with it\n");
  }
  EXPECT_EQ(WithServer({"submit", "--again", "a/b"}).code, 2);
  EXPECT_THAT(server_.ensemble.Asked().create, testing::IsEmpty());
}

TEST_F(QuestionOfJobTest, WithAnUnknownJobNothingIsSubmitted) {
  EXPECT_EQ(WithServer({"submit", "--again", "none"}),
            (Outcome{5, "", "ballpiston: no such job: ensembleJobs/none (JOB_NOT_FOUND)\n"}));
  EXPECT_THAT(server_.ensemble.Asked().create, testing::IsEmpty());
}

}  // namespace
}  // namespace ballpiston::client

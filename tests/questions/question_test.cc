#include "tests/questions/question.h"

#include "client/command/spec_file.h"
#include "core/experiment/all_experiments.h"
#include "server/convert/spec.h"
#include "tests/support/message_text.h"

namespace ballpiston::questions {
namespace {

TEST(Question, PrintsItselfAsACommandThatReadsItBack) {
  const auto spec = FromText<v1::EnsembleSpec>(
      "experiment: GAS_CONDUCTION"
      " grid { rho: inf delta: 1e-13 cells: '2x3' hot: 2 cold: 1 }"
      " target { collisions: 1000 } model: BILLIARD_REFERENCE");
  const std::string command = Command(spec), before = "ballpiston run --spec - <<<'";
  ASSERT_THAT(command, StartsWith(before));
  const std::string json = command.substr(before.size(), command.size() - before.size() - 1);
  ASSERT_OK_AND_ASSIGN(const v1::EnsembleSpec read, client::ParseSpec("FILE", json));
  EXPECT_EQ(read.ShortDebugString(), spec.ShortDebugString());
}

constexpr double kMostSeconds = 0.01;

TEST(Draw, GivesTheSameQuestionAgain) {
  for (uint64_t number = 0; number < 20; ++number) {
    EXPECT_EQ(Draw(3, number, kMostSeconds).spec.SerializeAsString(),
              Draw(3, number, kMostSeconds).spec.SerializeAsString());
  }
  EXPECT_NE(Draw(3, 0, kMostSeconds).spec.SerializeAsString(),
            Draw(4, 0, kMostSeconds).spec.SerializeAsString());
}

// 12 of 300 questions are fewer than half of the expected number of each experiment.
TEST(Draw, AsksEveryExperimentByEveryModelWithEveryTarget) {
  std::map<int, int> experiments, models, targets, precisions;
  int permitted = 0;
  for (uint64_t number = 0; number < 300; ++number) {
    const Question question = Draw(1, number, kMostSeconds);
    if (!question.defect.empty()) continue;
    ++experiments[question.spec.experiment()];
    ++models[question.spec.model()];
    ++targets[question.spec.target().kind_case()];
    ++precisions[question.spec.precision()];
    permitted += server::CheckSpec(question.spec).violations.empty();
  }
  EXPECT_EQ(experiments.size(), std::size(kAllExperiments));
  EXPECT_EQ(models.size(), 6);
  EXPECT_EQ(targets.size(), 4);
  EXPECT_EQ(precisions.size(), 2);
  for (const auto& [experiment, count] : experiments) EXPECT_GT(count, 12) << experiment;
  EXPECT_GT(permitted, 150);
}

}  // namespace
}  // namespace ballpiston::questions

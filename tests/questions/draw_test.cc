#include "tests/questions/draw.h"

#include <gtest/gtest.h>

#include <set>

#include "server/convert/spec.h"

namespace ballpiston::questions {
namespace {

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

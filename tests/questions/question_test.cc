#include "tests/questions/question.h"

#include <gtest/gtest.h>

#include <limits>

#include "client/command/spec_file.h"
#include "gmock/gmock.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::questions {
namespace {

v1::EnsembleSpec QuestionOfAGas() {
  v1::EnsembleSpec spec;
  spec.set_experiment(v1::EnsembleSpec::GAS_CONDUCTION);
  spec.mutable_grid()->add_rho(0.53);
  spec.mutable_grid()->add_delta(1e-13);
  spec.mutable_grid()->add_cells("2x3");
  spec.mutable_grid()->add_hot(2);
  spec.mutable_grid()->add_cold(1);
  spec.mutable_target()->set_collisions(1000);
  spec.set_model(v1::EnsembleSpec::BILLIARD_REFERENCE);
  return spec;
}

TEST(Question, PrintsItselfAsACommandThatReadsItBack) {
  v1::EnsembleSpec spec = QuestionOfAGas();
  spec.mutable_grid()->set_rho(0, std::numeric_limits<double>::infinity());
  const std::string command = Command(spec), before = "ballpiston run --spec - <<<'";
  ASSERT_THAT(command, testing::StartsWith(before));
  const std::string json = command.substr(before.size(), command.size() - before.size() - 1);
  ASSERT_OK_AND_ASSIGN(const v1::EnsembleSpec read, client::ParseSpec("FILE", json));
  EXPECT_EQ(read.ShortDebugString(), spec.ShortDebugString());
}

}  // namespace
}  // namespace ballpiston::questions

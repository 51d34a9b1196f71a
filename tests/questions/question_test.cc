#include "tests/questions/question.h"

#include <gtest/gtest.h>

#include <string>

#include "client/command/spec_file.h"
#include "gmock/gmock.h"
#include "tests/support/message_text.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::questions {
namespace {

TEST(Question, PrintsItselfAsACommandThatReadsItBack) {
  const auto spec = FromText<v1::EnsembleSpec>(
      "experiment: GAS_CONDUCTION"
      " grid { rho: inf delta: 1e-13 cells: '2x3' hot: 2 cold: 1 }"
      " target { collisions: 1000 } model: BILLIARD_REFERENCE");
  const std::string command = Command(spec), before = "ballpiston run --spec - <<<'";
  ASSERT_THAT(command, testing::StartsWith(before));
  const std::string json = command.substr(before.size(), command.size() - before.size() - 1);
  ASSERT_OK_AND_ASSIGN(const v1::EnsembleSpec read, client::ParseSpec("FILE", json));
  EXPECT_EQ(read.ShortDebugString(), spec.ShortDebugString());
}

}  // namespace
}  // namespace ballpiston::questions

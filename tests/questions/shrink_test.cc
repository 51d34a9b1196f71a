#include "tests/questions/shrink.h"

#include <gtest/gtest.h>

#include "tests/questions/question.h"

namespace ballpiston::questions {
namespace {

TEST(Shrink, FindsTheSimplestQuestionThatFails) {
  v1::EnsembleSpec spec;
  spec.set_experiment(v1::EnsembleSpec::FIRST_HIT);
  for (const double rho : {0.51234567, 0.6612345}) spec.mutable_grid()->add_rho(rho);
  for (const double delta : {0.1234, 3.21e-7, 0.2}) spec.mutable_grid()->add_delta(delta);
  spec.mutable_grid()->add_epsilon(0.12345678);
  spec.mutable_grid()->add_exponent(2);
  spec.mutable_target()->set_tolerance(0.0123);
  spec.mutable_target()->mutable_budget()->set_seconds(3);
  spec.set_seed(123456789);
  spec.set_model(v1::EnsembleSpec::BILLIARD);
  const auto fails = [](const v1::EnsembleSpec& s) {
    bool has_large_rho = false, has_small_delta = false;
    for (const double rho : s.grid().rho()) has_large_rho |= rho > 0.655 && rho < 0.7;
    for (const double delta : s.grid().delta()) has_small_delta |= delta < 1e-6;
    return has_large_rho && has_small_delta && s.model() == v1::EnsembleSpec::BILLIARD;
  };
  EXPECT_EQ(Command(Shrink(spec, fails, 1000)),
            "ballpiston run first-hit --rho=0.66 --delta=3e-07 --epsilon=0.1 --exponent=2 "
            "--model=billiard");
  EXPECT_EQ(Command(Shrink(spec, fails, 0)), Command(spec));
}

}  // namespace
}  // namespace ballpiston::questions

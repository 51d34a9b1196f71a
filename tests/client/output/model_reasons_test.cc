#include "client/output/model_reasons.h"

#include <gtest/gtest.h>

#include <sstream>

namespace ballpiston::client {
namespace {

using Spec = v1::EnsembleSpec;

v1::PointParameters At(double delta) {
  v1::PointParameters parameters;
  parameters.set_rho(0.53);
  parameters.set_delta(delta);
  return parameters;
}

std::string PrintedReasons(const ModelReasons& reasons) {
  std::ostringstream out;
  reasons.Print(out);
  return out.str();
}

TEST(ModelReasons, AReasonForAllPointsIsPrintedOnce) {
  ModelReasons reasons;
  for (const double delta : {0.1, 0.2}) reasons.Add(At(delta), Spec::CLOSED_FORM, "exact");
  EXPECT_EQ(PrintedReasons(reasons), "closed-form: exact\n");
}

TEST(ModelReasons, SeveralReasonsNameTheirFirstPointAndCountTheOthers) {
  ModelReasons reasons;
  reasons.Add(At(0.0125), Spec::MARKOV, "off by 1e-3");
  reasons.Add(At(0.05), Spec::BILLIARD, "the limit is too far");
  reasons.Add(At(0.1), Spec::BILLIARD, "the limit is too far");
  reasons.Add(At(0.025), Spec::MARKOV, "off by 2e-3");
  reasons.Add(At(0.2), Spec::BILLIARD, "the limit is too far");
  reasons.Add(At(0.021), Spec::MARKOV, "off by 2e-3");
  EXPECT_EQ(PrintedReasons(reasons),
            "markov (rho 0.53, delta 0.0125): off by 1e-3\n"
            "billiard (rho 0.53, delta 0.05 and 2 more points): the limit is too far\n"
            "markov (rho 0.53, delta 0.025 and 1 more point): off by 2e-3\n");
}

TEST(ModelReasons, TheSameTextForTwoModelsMakesTwoReasons) {
  ModelReasons reasons;
  reasons.Add(At(0.1), Spec::MARKOV, "cheapest");
  reasons.Add(At(0.2), Spec::BILLIARD, "cheapest");
  EXPECT_EQ(PrintedReasons(reasons),
            "markov (rho 0.53, delta 0.1): cheapest\n"
            "billiard (rho 0.53, delta 0.2): cheapest\n");
}

TEST(ModelReasons, AnEmptyReasonIsNotPrinted) {
  ModelReasons reasons;
  reasons.Add(At(0.1), Spec::BILLIARD, "");
  EXPECT_EQ(PrintedReasons(reasons), "");
}

TEST(ModelReasons, AnUnspecifiedModelIsCalledNone) {
  ModelReasons reasons;
  reasons.Add(At(0.1), Spec::MODEL_UNSPECIFIED, "out of reach");
  EXPECT_EQ(PrintedReasons(reasons), "none: out of reach\n");
}

}  // namespace
}  // namespace ballpiston::client

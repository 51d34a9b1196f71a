// transcripts/plan.txt shows the plan in every format.
#include "client/output/plan_output.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

std::string PrintedPlan(int points) {
  v1::PlanEnsembleJobResponse plan;
  for (int i = 0; i < points; ++i) plan.add_points();
  std::ostringstream out;
  PrintPlan(v1::EnsembleSpec(), plan, Format::kTable, out);
  return out.str();
}

TEST(PlanTable, HasNoLaddersAboveTheLimitOfPoints) {
  EXPECT_THAT(PrintedPlan(kMostLadders), HasSubstr("answers"));
  EXPECT_THAT(PrintedPlan(kMostLadders + 1), Not(HasSubstr("answers")));
  EXPECT_EQ(kMostLadders, 8);
}

}  // namespace
}  // namespace ballpiston::client

#include "tests/questions/engine.h"

namespace ballpiston::questions {
namespace {

TEST(Child, ReturnsTheReport) {
  const Report report = InChild([] {
    return Report{.outcome = "answered", .findings = {{"finite", "a value\tis\nnan"}}};
  });
  EXPECT_EQ(report.outcome, "answered");
  ASSERT_EQ(report.findings.size(), 1);
  EXPECT_EQ(report.findings[0].check, "finite");
  EXPECT_EQ(report.findings[0].what, "a value\tis\nnan");
}

TEST(Child, ReportsADeath) {
  const Report killed = InChild([]() -> Report {
    raise(SIGKILL);
    return {};
  });
  EXPECT_EQ(killed.outcome, "died");
  EXPECT_TRUE(killed.Breaks(kCrashCheck));
  EXPECT_FALSE(killed.Breaks(kEndCheck));
  const Report late = InChild([]() -> Report {
    raise(SIGXCPU);  // as the kernel does when the time is used up
    return {};
  });
  EXPECT_TRUE(late.Breaks(kEndCheck));
}

}  // namespace
}  // namespace ballpiston::questions

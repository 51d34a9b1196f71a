#include "client/command/violations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/status_matchers.h"

namespace ballpiston::client {
namespace {

using ::testing::EndsWith;
using ::testing::StartsWith;

absl::Status Invalid(const std::string& text) { return absl::InvalidArgumentError(text); }

TEST(Violations, WithoutViolationsTheReportIsOk) {
  const Violations none({absl::OkStatus(), absl::OkStatus()});
  EXPECT_OK(none.Lines());
  EXPECT_OK(none.Report());
}

TEST(Violations, OneIsReportedUnchanged) {
  EXPECT_EQ(Violations({absl::OkStatus(), Invalid("--rho: x")}).Report(), Invalid("--rho: x"));
}

TEST(Violations, SeveralAreCountedAndListed) {
  EXPECT_EQ(Violations({Invalid("--rho: x"), Invalid("--delta: y")}).Report().message(),
            "not valid, 2 violations:\n  --rho: x\n  --delta: y");
}

TEST(Violations, EachLineOfAListCounts) {
  const absl::Status list = Violations({Invalid("--rho: x"), Invalid("--rho: y")}).Lines();
  EXPECT_EQ(list.message(), "--rho: x\n--rho: y");
  EXPECT_EQ(Violations({list, Invalid("--delta: z")}).Report().message(),
            "not valid, 3 violations:\n  --rho: x\n  --rho: y\n  --delta: z");
}

TEST(Violations, ARepeatedOneCountsOnce) {
  EXPECT_EQ(Violations({Invalid("--rho: ''"), Invalid("--rho: ''")}).Report(),
            Invalid("--rho: ''"));
}

// A JSON parser's message is such a text: it quotes the line with the error.
TEST(Violations, ATextOfSeveralLinesIsOneViolation) {
  EXPECT_EQ(Violations({Invalid("no value\n{\n ^")}).Report(), Invalid("no value\n{\n ^"));
}

TEST(Violations, ALongListIsCutAndTheRestCounted) {
  Violations violations;
  for (int i = 0; i < 60; ++i) violations.Add(Invalid("--rho: " + std::to_string(i)));
  const std::string text(violations.Report().message());
  EXPECT_THAT(text, StartsWith("not valid, 60 violations:\n"));
  EXPECT_THAT(text, EndsWith("\n  and 10 more"));
}

}  // namespace
}  // namespace ballpiston::client

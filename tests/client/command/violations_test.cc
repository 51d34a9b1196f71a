#include "client/command/violations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace ballpiston::client {
namespace {

using ::testing::EndsWith;
using ::testing::StartsWith;

absl::Status Bad(const std::string& text) { return absl::InvalidArgumentError(text); }

TEST(Violations, NoneIsOk) {
  const Violations none({absl::OkStatus(), absl::OkStatus()});
  EXPECT_TRUE(none.Lines().ok());
  EXPECT_TRUE(none.Report().ok());
}

TEST(Violations, OneSpeaksForItself) {
  EXPECT_EQ(Violations({absl::OkStatus(), Bad("--rho: x")}).Report(), Bad("--rho: x"));
}

TEST(Violations, SeveralAreCountedAndListed) {
  EXPECT_EQ(Violations({Bad("--rho: x"), Bad("--delta: y")}).Report().message(),
            "not valid, 2 violations:\n  --rho: x\n  --delta: y");
}

TEST(Violations, ThoseOfAListAreCountedOneByOne) {
  const absl::Status list = Violations({Bad("--rho: x"), Bad("--rho: y")}).Lines();
  EXPECT_EQ(list.message(), "--rho: x\n--rho: y");
  EXPECT_EQ(Violations({list, Bad("--delta: z")}).Report().message(),
            "not valid, 3 violations:\n  --rho: x\n  --rho: y\n  --delta: z");
}

TEST(Violations, TheSameOneAgainIsNotAnother) {
  EXPECT_EQ(Violations({Bad("--rho: ''"), Bad("--rho: ''")}).Report(), Bad("--rho: ''"));
}

// As a JSON parser's, which quotes the place.
TEST(Violations, ATextOfSeveralLinesIsOneViolation) {
  EXPECT_EQ(Violations({Bad("no value\n{\n ^")}).Report(), Bad("no value\n{\n ^"));
}

TEST(Violations, WhatIsTooMuchToReadIsCounted) {
  Violations violations;
  for (int i = 0; i < 60; ++i) violations.Add(Bad("--rho: " + std::to_string(i)));
  const std::string text(violations.Report().message());
  EXPECT_THAT(text, StartsWith("not valid, 60 violations:\n"));
  EXPECT_THAT(text, EndsWith("\n  and 10 more"));
}

}  // namespace
}  // namespace ballpiston::client

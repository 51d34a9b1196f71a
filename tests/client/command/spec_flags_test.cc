#include "client/command/spec_flags.h"

#include <gmock/gmock.h>
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/command/spec_file.h"
#include "tests/client/message_text.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::client {
namespace {

using ::testing::HasSubstr;

void ExpectSpec(const SpecFlags& flags, const std::string& text) {
  ASSERT_OK_AND_ASSIGN(const v1::EnsembleSpec spec, SpecOf(flags));
  EXPECT_TRUE(
      google::protobuf::util::MessageDifferencer::Equals(spec, FromText<v1::EnsembleSpec>(text)))
      << spec.DebugString();
}

void ExpectError(const SpecFlags& flags, const std::string& part) {
  EXPECT_THAT(SpecOf(flags), StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(part)));
}

SpecFlags FirstHitFlags() {
  SpecFlags flags;
  flags.experiment = "first-hit";
  return flags;
}

TEST(SpecFlags, EveryFlagReachesItsField) {
  SpecFlags flags = FirstHitFlags();
  flags.rho = "0.53";
  flags.delta = "0.1,0.2";
  flags.epsilon = "0.25";
  flags.exponent = "0:2:3";
  flags.cells = "4";
  flags.samples = "1e6";
  flags.seed = "18446744073709551615";
  flags.model = "billiard_reference";
  flags.verify = true;
  flags.precision = "single";
  ExpectSpec(flags,
             "experiment: FIRST_HIT grid { rho: 0.53 delta: [0.1, 0.2] epsilon: 0.25 "
             "exponent: [0, 1, 2] cells: 4 } target { samples: 1000000 } "
             "seed: 18446744073709551615 model: BILLIARD_REFERENCE precision: SINGLE "
             "verify: true");
}

TEST(SpecFlags, AnAbsentFlagLeavesItsFieldUnset) {
  ExpectSpec(FirstHitFlags(), "experiment: FIRST_HIT grid {}");
}

TEST(SpecFlags, ReadsTargetsOfEachKind) {
  SpecFlags flags = FirstHitFlags();
  flags.collisions = "5";
  ExpectSpec(flags, "experiment: FIRST_HIT grid {} target { collisions: 5 }");
  flags.collisions.reset();
  flags.tolerance = "1e-3";
  ExpectSpec(flags, "experiment: FIRST_HIT grid {} target { tolerance: 1e-3 }");
  flags.tolerance.reset();
  flags.budget = "90.5";
  ExpectSpec(flags,
             "experiment: FIRST_HIT grid {} target { budget { seconds: 90 nanos: 500000000 } }");
}

TEST(SpecFlags, ABudgetIsPermittedBesideATolerance) {
  SpecFlags flags = FirstHitFlags();
  flags.tolerance = "1e-3";
  flags.budget = "10";
  ExpectSpec(flags,
             "experiment: FIRST_HIT grid {} target { tolerance: 1e-3 budget { seconds: 10 } }");
}

TEST(SpecFlags, OtherTargetsExcludeEachOther) {
  SpecFlags flags = FirstHitFlags();
  flags.samples = "10";
  flags.tolerance = "0.1";
  ExpectError(flags,
              "--samples and --tolerance exclude each other: give at most one of --samples, "
              "--collisions, --tolerance, --budget; only --tolerance and --budget may stand "
              "together");
  flags.budget = "1";
  ExpectError(flags, "--samples and --tolerance and --budget exclude each other");
  flags.tolerance.reset();
  ExpectError(flags, "--samples and --budget exclude each other");
  flags.samples.reset();
  flags.collisions = "10";
  ExpectError(flags, "--collisions and --budget exclude each other");
}

TEST(SpecFlags, ExperimentsAreReadInBothSpellings) {
  SpecFlags flags;
  flags.experiment = "conditional_mean_free_time";
  ExpectSpec(flags, "experiment: CONDITIONAL_MEAN_FREE_TIME grid {}");
  flags.experiment = "equilibrium";
  ExpectSpec(flags, "experiment: EQUILIBRIUM grid {}");
  flags.experiment = "energy-relaxation";
  ExpectSpec(flags, "experiment: ENERGY_RELAXATION grid {}");
  flags.experiment = "markov_property";
  ExpectSpec(flags, "experiment: MARKOV_PROPERTY grid {}");
}

TEST(SpecFlags, EveryModelOfTheLadderHasItsName) {
  for (const auto& [name, field] : {std::pair("closed-form", "CLOSED_FORM"),
                                    {"spectrum", "SPECTRUM"},
                                    {"markov", "MARKOV"},
                                    {"billiard", "BILLIARD"}}) {
    SpecFlags flags = FirstHitFlags();
    flags.model = name;
    ExpectSpec(flags, std::string("experiment: FIRST_HIT grid {} model: ") + field);
  }
}

TEST(SpecFlags, ErrorOfAnUnknownNameListsTheKnownOnes) {
  SpecFlags flags;
  flags.experiment = "brownian";
  ExpectError(flags, "experiment 'brownian' is unknown; it offers equilibrium, ");
  flags.experiment = "gas-conduction";
  ExpectError(flags, "'gas-conduction' is not offered by this version; it offers equilibrium, ");
  flags.experiment = "experiment-unspecified";
  ExpectError(flags, "is unknown");
  flags.experiment.reset();
  ExpectError(flags, "name an EXPERIMENT");
  flags = FirstHitFlags();
  flags.model = "guess";
  ExpectError(flags, "--model: 'guess' is not one of auto, closed-form, markov, billiard, ");
  flags = FirstHitFlags();
  flags.precision = "half";
  ExpectError(flags, "--precision: 'half' is not one of double, single");
}

TEST(SpecFlags, BadNumbersNameTheirFlag) {
  SpecFlags flags = FirstHitFlags();
  flags.delta = "nan";
  ExpectError(flags, "--delta: 'nan'");
  flags = FirstHitFlags();
  flags.budget = "1e300";
  ExpectError(flags, "--budget: '1e300'");
  flags = FirstHitFlags();
  flags.samples = "many";
  ExpectError(flags, "--samples: 'many'");
}

TEST(SpecFlags, EveryWrongFlagHasItsLine) {
  SpecFlags flags;
  flags.experiment = "brownian";
  flags.rho = "0.53,nan";
  flags.exponent = "x";
  flags.cells = "1.5";
  flags.samples = "many";
  flags.seed = "-1";
  flags.model = "guess";
  flags.precision = "half";
  const std::string text(SpecOf(flags).status().message());
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 7) << text;
  for (const char* part :
       {"experiment 'brownian'", "--rho: 'nan'", "--exponent: 'x'", "--cells: '1.5'",
        "--samples: 'many'", "--seed: '-1'", "--model: 'guess'", "--precision: 'half'"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

TEST(SpecFlags, ATooLargeSpecificationIsRejected) {
  SpecFlags flags = FirstHitFlags();
  flags.rho = flags.delta = flags.epsilon = flags.exponent = "0:1:100000";
  flags.cells = "-100000:-1:100000";
  ExpectError(flags, "spec: has 42000");
}

TEST(SpecFlags, AFileExcludesOtherFlags) {
  SpecFlags flags;
  flags.file = "spec.json";
  flags.rho = "0.53";
  ExpectError(flags, "--spec holds the whole specification");
  flags.rho.reset();
  flags.seed = "1";
  ExpectError(flags, "--spec holds the whole specification");
  flags.seed.reset();
  flags.verify = true;
  ExpectError(flags, "--spec holds the whole specification");
}

TEST(SpecFile, ReadsProtoJsonWithEitherFieldNames) {
  ASSERT_OK_AND_ASSIGN(const v1::EnsembleSpec spec,
                       ParseSpec("s.json", R"({"experiment": "FIRST_HIT", "grid": {"rho": [0.53]},
                              "target": {"samples": "100"}, "seed": 7})"));
  EXPECT_EQ(spec.target().samples(), 100);
  EXPECT_EQ(spec.seed(), 7u);
}

TEST(SpecFile, ZeroHasNoSignInAnyNotation) {
  for (const char* zero : {"-0", "-0.0", "-.0", "-0e5", "0"}) {
    ASSERT_OK_AND_ASSIGN(
        const v1::EnsembleSpec spec,
        ParseSpec("s.json", absl::StrCat(R"({"grid": {"epsilon": [0.1, )", zero,
                                         R"(]}, "target": {"tolerance": )", zero, "}}")));
    EXPECT_EQ(spec.grid().epsilon(0), 0.1);
    for (const double number : {spec.grid().epsilon(1), spec.target().tolerance()}) {
      EXPECT_EQ(number, 0);
      EXPECT_FALSE(std::signbit(number)) << zero;
    }
  }
  EXPECT_FALSE(ParseSpec("s.json", "{}")->has_grid());
}

TEST(SpecFile, RejectsWhatIsNotASpecification) {
  for (const char* text :
       {"", "   ", "null", "\"FIRST_HIT\"", "[]", "7", "{", "{]", "not json", "{\"sed\": 1}",
        "{\"grid\": {\"rho\": [\"x\"]}}", "{\"experiment\": \"NO_SUCH\"}",
        "{\"target\": {\"samples\": 1, \"tolerance\": 0.1}}", "{\"seed\": -1}", "{} {}"}) {
    EXPECT_THAT(ParseSpec("s.json", text),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("--spec s.json: ")))
        << text;
  }
}

TEST(SpecFile, NamesTheUnknownField) {
  EXPECT_THAT(ParseSpec("s.json", R"({"experiment": "FIRST_HIT", "sed": 1})"),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("sed")));
}

// The message of the JSON parser repeats the whole value.
TEST(SpecFile, ErrorShortensALongValue) {
  const std::string name = "HEAD" + std::string(300'000, 'X') + "TAIL";
  const auto spec = ParseSpec("s.json", R"({"experiment": ")" + name + "\"}");
  const std::string message(spec.status().message());
  EXPECT_LT(message.size(), 1'100u);
  EXPECT_THAT(message, HasSubstr("HEAD"));
  EXPECT_THAT(message, HasSubstr("XTAIL"));
  SpecFlags flags;
  flags.experiment = name;
  EXPECT_LT(SpecOf(flags).status().message().size(), 500u);
}

TEST(SpecFile, ErrorNamesAFileThatCannotBeRead) {
  EXPECT_THAT(
      ReadSpecFile("/no/such/file.json"),
      StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("/no/such/file.json: No such")));
  EXPECT_THAT(ReadSpecFile("/"), StatusIs(absl::StatusCode::kInvalidArgument));
}

}  // namespace
}  // namespace ballpiston::client

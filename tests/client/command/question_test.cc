#include "client/command/question.h"

#include <google/protobuf/util/message_differencer.h>

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

class QuestionTest : public ::testing::Test {
 protected:
  // The specification of `run WORDS`.
  static absl::StatusOr<v1::EnsembleSpec> Spec(const std::string& words) {
    const auto line = ParseCommandLine(absl::StrSplit("run " + words, ' ', absl::SkipEmpty()));
    return line.ok() ? SpecOf(line->options) : line.status();
  }

  const EmptyHome home_;
};

TEST_F(QuestionTest, EachFlagReachesItsField) {
  const std::pair<std::string, std::string> table[] = {
      {"", ""},
      {"--rho 0.53 --delta=0.1,0.2", "grid { rho: 0.53 delta: [0.1, 0.2] }"},
      {"--epsilon 0.25 --exponent 0:2:3", "grid { epsilon: 0.25 exponent: [0, 1, 2] }"},
      {"--cells 12,4x3,2:6:3", "grid { cells: ['12', '4x3', '2', '4', '6'] }"},
      {"--temperature 0.5:1.5:3", "grid { temperature: [0.5, 1, 1.5] }"},
      {"--hot 2,3 --cold 1", "grid { hot: [2, 3] cold: 1 }"},
      {"--samples 1e6", "target { samples: 1000000 }"},
      {"--collisions 5", "target { collisions: 5 }"},
      {"--tolerance -1e-3", "target { tolerance: -1e-3 }"},
      {"--budget 90.5", "target { budget { seconds: 90 nanos: 500000000 } }"},
      {"--budget 0.3", "target { budget { nanos: 300000000 } }"},
      {"--budget 1.9999999999", "target { budget { seconds: 2 } }"},
      {"--budget -0.25", "target { budget { nanos: -250000000 } }"},
      {"--budget 1e300", "target { budget { seconds: 315576000000 } }"},
      {"--budget 10 --tolerance 1e-3", "target { tolerance: 1e-3 budget { seconds: 10 } }"},
      {"--estimate conductivity", "target { estimate: 'conductivity' }"},
      {"--tolerance 0.05 --estimate=anything", "target { tolerance: 0.05 estimate: 'anything' }"},
      {"--samples 5 --estimate exchange_rate", "target { samples: 5 estimate: 'exchange_rate' }"},
      {"--seed 18446744073709551615", "seed: 18446744073709551615"},
      {"--model billiard_reference", "model: BILLIARD_REFERENCE"},
      {"--model closed-form", "model: CLOSED_FORM"},
      {"--precision single --verify", "precision: SINGLE verify: true"}};
  for (const auto& [words, text] : table) {
    ASSERT_OK_AND_ASSIGN(const v1::EnsembleSpec spec, Spec("first-hit " + words));
    EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(
        spec, FromText<v1::EnsembleSpec>("experiment: FIRST_HIT " + text)))
        << words << "\n"
        << spec.DebugString();
  }
}

}  // namespace
}  // namespace ballpiston::client

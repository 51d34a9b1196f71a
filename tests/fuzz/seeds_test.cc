// Runs every target over its seeds and some thousands of changed seeds, with any compiler.
// libFuzzer searches for more (make fuzz).
#include <exception>
#include <ostream>

#include "absl/strings/escaping.h"
#include "ballpiston/storage/tokens.pb.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "google/protobuf/stubs/logging.h"
#include "server/convert/spec.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/mutation.h"
#include "tests/support/message_text.h"

namespace ballpiston::fuzz {

// Prints the target's name instead of its bytes; CTest uses it in the name of the test.
void PrintTo(const FuzzTarget& target, std::ostream* out) { *out << target.name; }

namespace {

const std::string kSeeds = SourcePath("tests/fuzz/seeds");
constexpr int kChangedInputs = 3000;
constexpr size_t kLongestInput = 1 << 14;

// The rule that the target breaks on this input; empty if none.
std::string Fault(const FuzzTarget& target, const std::string& input) {
  try {
    target.check(input);
  } catch (const std::exception& error) {
    return std::string(error.what()) + ", with input \"" + std::string(absl::CHexEscape(input)) +
           "\"";
  }
  return "";
}

std::string Changed(Dice& dice, const FuzzTarget& target, const std::vector<std::string>& seeds) {
  std::string input = seeds[dice.Below(seeds.size())];
  if (target.message != nullptr && !dice.OneIn(4)) MutateFields(dice, *target.message, input);
  for (size_t changes = dice.Below(4); changes > 0; --changes) MutateBytes(dice, input);
  if (dice.OneIn(8)) {  // the beginning of this seed and the end of another
    const std::string& other = seeds[dice.Below(seeds.size())];
    input.resize(dice.Below(input.size() + 1));
    input += other.substr(dice.Below(other.size() + 1));
  }
  if (input.size() > kLongestInput) input.resize(kLongestInput);
  return input;
}

class EveryTarget : public testing::TestWithParam<FuzzTarget> {};

TEST_P(EveryTarget, HoldsForItsSeedsAndMutationsOfThem) {
  const google::protobuf::LogSilencer silence;
  const FuzzTarget& target = GetParam();
  const std::vector<std::string> seeds = SeedsOf(target, kSeeds);
  ASSERT_FALSE(seeds.empty());
  for (const std::string& seed : seeds) EXPECT_EQ(Fault(target, seed), "");
  EXPECT_EQ(Fault(target, ""), "");
  Dice dice(20);
  for (int i = 0; i < kChangedInputs; ++i) {
    ASSERT_EQ(Fault(target, Changed(dice, target, seeds)), "");
  }
}

TEST(Seeds, AFileThatCannotBeReadIsAnError) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.File("text/a_folder"));
  EXPECT_THROW(SeedsOf({"text", nullptr}, folder.path()), std::runtime_error);
}

TEST(Seeds, TheRefusedSeedHasSixteenViolations) {
  const auto request = FromText<v1::CreateEnsembleJobRequest>(
      Contents(kSeeds + "/create_request/refused.textproto"));
  EXPECT_THAT(server::CheckSpec(request.spec()).violations, SizeIs(16));
}

TEST(Mutation, DrawsNumbersAndTextsOfEveryKind) {
  Dice dice(1);
  bool is_large = false;
  bool has_nul = false;
  bool has_line = false;
  storage::ResumeToken token;
  for (int i = 0; i < 10'000; ++i) {
    MutateMessage(dice, token);
    is_large |= token.change() > INT64_MAX;
    has_nul |= absl::StrContains(token.job(), '\0');
    has_line |= absl::StrContains(token.job(), '\n');
  }
  EXPECT_TRUE(is_large && has_nul && has_line);
}

INSTANTIATE_TEST_SUITE_P(Fuzz, EveryTarget, testing::ValuesIn(Targets()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace ballpiston::fuzz

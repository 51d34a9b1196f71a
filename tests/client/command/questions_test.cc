// From flags or a file to the request of a job. transcripts/submit.txt shows the rest.
#include <google/protobuf/util/message_differencer.h>

#include "client/command/question.h"
#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

// ---- question.h ----

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
      {"--rho 0.53 --delta=0.1,0.2", "grid { rho: 0.53 delta: [0.1, 0.2] }"},
      {"--epsilon 0.25 --exponent 0:2:3", "grid { epsilon: 0.25 exponent: [0, 1, 2] }"},
      {"--cells 12,4x3,2:6:3", "grid { cells: ['12', '4x3', '2', '4', '6'] }"},
      {"--temperature 0.5:1.5:3", "grid { temperature: [0.5, 1, 1.5] }"},
      {"--hot 2,3 --cold 1", "grid { hot: [2, 3] cold: 1 }"},
      {"--collisions 5", "target { collisions: 5 }"},
      {"--tolerance -1e-3", "target { tolerance: -1e-3 }"},
      {"--budget 90.5", "target { budget { seconds: 90 nanos: 500000000 } }"},
      {"--budget 0.3", "target { budget { nanos: 300000000 } }"},
      {"--budget 1.9999999999", "target { budget { seconds: 2 } }"},
      {"--budget -0.25", "target { budget { nanos: -250000000 } }"},
      {"--budget 1e300", "target { budget { seconds: 315576000000 } }"},
      {"--budget 10 --tolerance 1e-3", "target { tolerance: 1e-3 budget { seconds: 10 } }"},
      {"--estimate conductivity", "target { estimate: 'conductivity' }"},
      {"--seed 18446744073709551615", "seed: 18446744073709551615"},
      {"--model billiard_reference", "model: BILLIARD_REFERENCE"},
      {"--precision single --verify", "precision: SINGLE verify: true"}};
  for (const auto& [words, text] : table) {
    ASSERT_OK_AND_ASSIGN(const v1::EnsembleSpec spec, Spec("first-hit " + words));
    EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(
        spec, FromText<v1::EnsembleSpec>("experiment: FIRST_HIT " + text)))
        << words << "\n"
        << spec.DebugString();
  }
}

TEST(SpecFile, MayBeginWithAByteOrderMark) {
  const auto spec =
      ParseSpec("s.json", "\xEF\xBB\xBF{\"grid\": {\"cells\": [\"4x3\"], \"rho\": [0]}}");
  ASSERT_OK(spec);
  EXPECT_EQ(spec->ShortDebugString(), R"(grid { rho: 0 cells: "4x3" })");
}

// The JSON parser would take the last value of a repeated key, drop a null and merge the lists.
TEST(SpecFile, AnErrorNamesTheFieldOrTheKey) {
  const std::string list = ": its list contains null or a list";
  const std::pair<std::string, std::string> table[] = {
      {R"({"experiment": "FIRST_HIT", "s\u001bed": 1})", "sed"},
      {R"({"seed": 1, "seed": 1})", "--spec s.json: Repeated map key: 'seed' is already set."},
      {R"({"grid": {"seed": [1], "seed": [2]}})", "Repeated map key: 'seed' is already set."},
      {R"({"grid": {"rho": [0.53, null, 0.6]}})", "grid.rho" + list},
      {R"({"grid": {"rho": [[0.53], [0.54]]}})", "grid.rho" + list},
      {R"({"grid": {"rho": null, "cells": [null]}})", "grid.cells" + list}};
  for (const auto& [json, message] : table) {
    EXPECT_THAT(ParseSpec("s.json", json),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(message)))
        << json;
  }
}

// The message of the JSON parser repeats the whole value.
TEST(SpecFile, ErrorShortensALongValue) {
  const std::string name = "HEAD" + std::string(300'000, 'X') + "TAIL";
  const auto spec = ParseSpec("s.json", R"({"experiment": ")" + name + "\"}");
  const std::string message(spec.status().message());
  EXPECT_LT(message.size(), 1'100u);
  EXPECT_THAT(message, HasSubstr("HEAD"));
  EXPECT_THAT(message, HasSubstr("XTAIL"));
}

// ---- run.cc ----

class CreateJobTest : public ProgramTest {
 protected:
  // The request id of `submit --resume WORDS`.
  std::string IdOfResumed(std::vector<std::string> words) {
    words.insert(words.begin(), {"submit", "--resume"});
    const Outcome outcome = WithServer(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return server_.Asked<v1::CreateEnsembleJobRequest>().back().request_id();
  }
};

TEST_F(CreateJobTest, ResumedJobsOfOneSpecificationHaveOneRequestId) {
  server_.status.set_engine_version("7");
  const std::string id = IdOfResumed({"first-hit", "--rho", "0.53"});
  EXPECT_EQ(IdOfResumed({"first-hit", "--rho=0.53"}), id);
  for (const std::vector<std::string>& other :
       {std::vector<std::string>{"first-hit", "--rho", "0.54"},
        {"first-hit", "--rho", "0.53", "--seed", "1"},
        {"first-hit", "--rho", "0.53", "--fresh"},
        {"first-hit", "--rho", "0.53", "--label", "run=1"},
        {"first-hit", "--rho", "0.53", "--priority", "1"}}) {
    EXPECT_NE(IdOfResumed(other), id);
  }
  server_.status.set_engine_version("8");
  EXPECT_NE(IdOfResumed({"first-hit", "--rho", "0.53"}), id);
}

TEST_F(CreateJobTest, ResumeAfterALostJobCreatesANewJob) {
  server_.created = {JobIn(v1::EnsembleJob::FAILED), JobIn(v1::EnsembleJob::CANCELLED),
                     JobIn(v1::EnsembleJob::CANCELLING),
                     FromText<v1::EnsembleJob>("state: SUCCEEDED results_expired: true")};
  EXPECT_EQ(WithServer({"submit", "--resume", "first-hit"}).code, 0);
  const auto asked = server_.Asked<v1::CreateEnsembleJobRequest>();
  ASSERT_EQ(asked.size(), 5u);
  for (size_t i = 1; i < 5; ++i) EXPECT_NE(asked[i].request_id(), asked[i - 1].request_id());
}

}  // namespace
}  // namespace ballpiston::client

#include "server/convert/errors.h"

#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

TEST(Errors, HaveTheLastArgumentInTheMetadata) {
  EXPECT_THAT(std::string(JobNotFound("ensembleJobs/x").message()), HasSubstr("ensembleJobs/x"));
  EXPECT_THAT(MetadataOf(JobNotFound("ensembleJobs/x")),
              ElementsAre(Pair("name", "ensembleJobs/x")));
  const grpc::Status status = GrpcStatus(JobAlreadyEnded("ensembleJobs/$1", "FAILED"));
  EXPECT_THAT(status, StatusIs(grpc::StatusCode::FAILED_PRECONDITION,
                               "ensembleJobs/$1 has ended already: it is FAILED"));
  EXPECT_EQ(DetailOf<google::rpc::ErrorInfo>(status).domain(), "ballpiston");
  EXPECT_THAT(MetadataOf(status), ElementsAre(Pair("state", "FAILED")));
  EXPECT_THAT(MetadataOf(ShuttingDown()), IsEmpty());
  const absl::Status full = StoreFailure(absl::ResourceExhaustedError("store: disk is full"));
  EXPECT_THAT(full, IsError(absl::StatusCode::kUnavailable, "STORE_FULL"));
  EXPECT_THAT(std::string(full.message()), StartsWith("store: disk is full; delete jobs that "));
}

TEST(Errors, SayHowLongToWaitWhereWaitingHelps) {
  const auto waits = [](const absl::Status& error) {
    return DetailOf<google::rpc::RetryInfo>(error).retry_delay().seconds() > 0;
  };
  const auto limit = [](const std::string& reason) { return LimitExceeded(reason, "it", "f", 1); };
  for (const absl::Status& cured :
       {ShuttingDown(), StoreFailure(absl::ResourceExhaustedError("full")),
        StoreFailure(absl::UnavailableError("fails")), limit("TOO_MANY_CALLS"),
        limit("TOO_MANY_STREAMS"), limit("TOO_MANY_JOBS"), limit("TOO_MANY_ACTIVE_POINTS"),
        limit("TOO_MANY_STORED_BYTES")}) {
    EXPECT_TRUE(waits(cured)) << cured;
  }
  for (const absl::Status& lasting :
       {limit("TOO_MANY_POINTS"), StoreFailure(absl::DataLossError("damaged")), JobNotFound("x")}) {
    EXPECT_FALSE(waits(lasting)) << lasting;
  }
}

TEST(Errors, AToleranceThatWasNotReachedNamesPointToleranceBudgetAndError) {
  EnsembleSpec spec = FakeSpec(1, 0);
  spec.target = {.tolerance = 1e-6, .budget_seconds = 0.25};
  const absl::Status missed =
      ToleranceNotReached(spec, 17, {.name = "time", .value = -8, .standard_error = 0.04});
  EXPECT_THAT(missed,
              StatusIs(absl::StatusCode::kDeadlineExceeded,
                       "point 17: tolerance 1e-06 was not reached within the budget of 0.25 s: "
                       "reached 0.005"));
  const absl::Status without = ToleranceNotReached(spec, 0, {.name = "time", .value = 8});
  EXPECT_THAT(std::string(without.message()), HasSubstr("reached an unknown error"));
  spec.target.budget_seconds.reset();
  EXPECT_THAT(std::string(ToleranceNotReached(spec, 0, {.name = "time", .value = 8}).message()),
              HasSubstr("was not reached with the largest number of samples: reached"));
  // A job's error keeps its reason. An error without a reason gets that of a failed computation.
  EXPECT_EQ(ReasonOf(WithDefaultReason(missed, "COMPUTATION_FAILED")), "TOLERANCE_NOT_REACHED");
  EXPECT_EQ(ReasonOf(WithDefaultReason(absl::InternalError("lost"), "COMPUTATION_FAILED")),
            "COMPUTATION_FAILED");
}

TEST(Errors, ViolationsThatDoNotFitAreCounted) {
  std::vector<FieldViolation> violations;
  for (int i = 0; i < 5000; ++i) {
    violations.push_back({"spec.grid.rho[" + std::to_string(i) + "]", std::string(90, 'x')});
  }
  const grpc::Status status = GrpcStatus(InvalidSpec(violations));
  EXPECT_LT(status.error_details().size(), kMaxErrorDetails);
  const size_t fields = FieldsOf(status).size();
  EXPECT_GT(fields, 20u);
  const std::string left_out = std::to_string(5000 - fields);
  EXPECT_THAT(MetadataOf(status), ElementsAre(Pair("violations_left_out", left_out)));
  EXPECT_THAT(status.error_message(), HasSubstr(left_out));
}

TEST(Errors, TextIsCutBetweenCharacters) {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += "\xc3\xa9";  // e with an accent
  EXPECT_THAT(GrpcStatus(InvalidRequest({{"a", text}})).error_message(), HasSubstr("\xa9..."));
}

}  // namespace
}  // namespace ballpiston::server

// The log lines of calls and jobs.
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "google/protobuf/struct.pb.h"
#include "google/protobuf/util/json_util.h"
#include "gtest/gtest.h"
#include "prometheus/text_serializer.h"
#include "server/observability/call_observer.h"
#include "server/observability/log.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/requests.h"
#include "tests/server/running_server.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using google::protobuf::Struct;
using ::testing::HasSubstr;

std::string FieldOf(const Struct& line, const std::string& name) {
  const auto found = line.fields().find(name);
  return found == line.fields().end() ? "" : found->second.string_value();
}

class CallLog : public testing::Test {
 protected:
  CallLog() { SetLogOptions({.format = LogFormat::kJson}); }
  ~CallLog() override { SetLogOptions({}); }

  // The lines that were written while `act` ran.
  template <typename Act>
  static std::vector<Struct> LinesOf(Act act) {
    testing::internal::CaptureStderr();
    act();
    std::istringstream text(testing::internal::GetCapturedStderr());
    std::vector<Struct> lines;
    for (std::string line; std::getline(text, line);) {
      const auto status = google::protobuf::util::JsonStringToMessage(line, &lines.emplace_back());
      EXPECT_TRUE(status.ok()) << line;
    }
    return lines;
  }

  static std::vector<std::string> Messages(const std::vector<Struct>& lines) {
    std::vector<std::string> messages;
    for (const Struct& line : lines) messages.push_back(FieldOf(line, "message"));
    return messages;
  }
};

FailedCall Failure(absl::StatusCode code, const std::string& reason) {
  return {.method = "GetEnsembleJob",
          .principal = "alice",
          .request_id = "r-1",
          .code = code,
          .reason = reason,
          .message = "why",
          .seconds = 0.5};
}

TEST_F(CallLog, AJobsLifeIsLoggedWithJobPrincipalAndRequest) {
  std::string name;
  const auto lines = LinesOf([&] {
    RunningServer server;
    grpc::ClientContext context;
    context.AddMetadata("x-request-id", "my-request");
    v1::EnsembleJob job;
    ASSERT_OK(
        server.ensemble().CreateEnsembleJob(&context, CreateRequest(Equilibrium(2, 3)), &job));
    name = job.name();
    server.AwaitEnd(name);
    server.Get(name);  // reading is not logged
    ASSERT_OK(server.Delete(name));
  });
  EXPECT_THAT(Messages(lines), testing::UnorderedElementsAre("job accepted", "job running",
                                                             "job succeeded", "job deleted"));
  for (const Struct& line : lines) {
    EXPECT_EQ(FieldOf(line, "job"), name);
    EXPECT_EQ(FieldOf(line, "principal"), "local");
    if (FieldOf(line, "message") == "job accepted") {
      EXPECT_EQ(FieldOf(line, "request_id"), "my-request");
    }
    if (FieldOf(line, "message") == "job succeeded") {
      EXPECT_EQ(line.fields().at("samples").number_value(), 2 * 3 * kFakeSamplesPerBlock);
      EXPECT_GE(line.fields().at("seconds").number_value(), 0);
    }
  }
}

TEST_F(CallLog, AFailedJobSaysWhy) {
  const auto lines = LinesOf([] {
    RunningServer server({.factory = FakeExperiments([](size_t, uint64_t, std::stop_token) {
                            throw std::runtime_error("line one\nline two");
                          })});
    server.AwaitEnd(server.Submit(Equilibrium(1, 3)));
  });
  EXPECT_THAT(Messages(lines),
              testing::UnorderedElementsAre("job accepted", "job running", "job failed"));
  for (const Struct& line : lines) {
    if (FieldOf(line, "message") != "job failed") continue;
    EXPECT_EQ(FieldOf(line, "severity"), "WARNING");
    EXPECT_THAT(FieldOf(line, "error"), HasSubstr("line one\nline two"));
  }
}

TEST_F(CallLog, CallsOverALimitAreLoggedAndInvalidCallsAreNot) {
  const auto lines = LinesOf([&] {
    RunningServer server({.limits = {.max_points_per_job = 10}});
    EXPECT_FALSE(server.Create({}).ok());
    EXPECT_FALSE(server.Create(CreateRequest(Equilibrium(11, 1))).ok());
    grpc::ClientContext context;
    v1::EnsembleJob job;
    v1::GetEnsembleJobRequest none;
    none.set_name("ensembleJobs/none");
    EXPECT_THAT(server.ensemble().GetEnsembleJob(&context, none, &job),
                StatusIs(grpc::StatusCode::NOT_FOUND));
  });
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(FieldOf(lines[0], "message"), HasSubstr("call rejected: the grid has 11 points"));
  EXPECT_EQ(FieldOf(lines[0], "severity"), "WARNING");
  EXPECT_EQ(FieldOf(lines[0], "method"), "CreateEnsembleJob");
  EXPECT_EQ(FieldOf(lines[0], "principal"), "local");
  EXPECT_EQ(FieldOf(lines[0], "code"), "RESOURCE_EXHAUSTED");
  EXPECT_EQ(FieldOf(lines[0], "reason"), "TOO_MANY_POINTS");
  EXPECT_EQ(FieldOf(lines[0], "request_id").size(), 16u);
}

TEST_F(CallLog, OnlyEventsForTheOperatorAreLogged) {
  using absl::StatusCode;
  const auto verdict = [](StatusCode code, const char* reason = "") {
    return VerdictOn(Failure(code, reason));
  };
  EXPECT_EQ(verdict(StatusCode::kInternal), Verdict::kServerFailed);
  EXPECT_EQ(verdict(StatusCode::kUnavailable, "STORE_FAILED"), Verdict::kServerFailed);
  EXPECT_EQ(verdict(StatusCode::kResourceExhausted, "STORE_FULL"), Verdict::kServerFailed);
  EXPECT_EQ(verdict(StatusCode::kUnavailable, "SHUTTING_DOWN"), Verdict::kOrdinary);
  EXPECT_EQ(verdict(StatusCode::kResourceExhausted, "QUEUE_FULL"), Verdict::kLimitReached);
  EXPECT_EQ(verdict(StatusCode::kUnauthenticated, "CREDENTIALS_MISSING"), Verdict::kNotLetIn);
  EXPECT_EQ(verdict(StatusCode::kPermissionDenied, "ROLE_TOO_LOW"), Verdict::kNotLetIn);
  for (const StatusCode code : {StatusCode::kCancelled, StatusCode::kInvalidArgument,
                                StatusCode::kNotFound, StatusCode::kFailedPrecondition,
                                StatusCode::kDeadlineExceeded, StatusCode::kUnimplemented}) {
    EXPECT_EQ(verdict(code), Verdict::kOrdinary) << absl::StatusCodeToString(code);
  }
}

TEST_F(CallLog, AllRefusedCallsAreCountedAndSomeAreLogged) {
  CallObserver calls;
  const auto lines = LinesOf([&] {
    for (int i = 0; i < 500; ++i) {
      calls.Failed(Failure(absl::StatusCode::kUnauthenticated, "CREDENTIALS_INVALID"));
    }
  });
  EXPECT_GE(lines.size(), 1u);
  EXPECT_LT(lines.size(), 500u);
  EXPECT_THAT(
      prometheus::TextSerializer().Serialize(calls.metrics().Collect()),
      HasSubstr("ballpiston_failed_authentications_total{reason=\"CREDENTIALS_INVALID\"} 500\n"));
  // Rejected calls and failed calls have separate budgets of lines.
  EXPECT_EQ(LinesOf([&] { calls.Failed(Failure(absl::StatusCode::kInternal, "")); }).size(), 1u);
}

TEST_F(CallLog, LinesBelowTheLeastSeverityAreNotWritten) {
  SetLogOptions({.format = LogFormat::kJson, .least = Severity::kError});
  const auto lines = LinesOf([] {
    Log(Severity::kInfo, "a");
    Log(Severity::kWarning, "b");
    Log(Severity::kError, "c");
  });
  EXPECT_THAT(Messages(lines), testing::ElementsAre("c"));
}

}  // namespace
}  // namespace ballpiston::server

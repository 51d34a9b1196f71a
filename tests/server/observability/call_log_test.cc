// What the log says of calls and jobs.
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "google/protobuf/struct.pb.h"
#include "google/protobuf/util/json_util.h"
#include "gtest/gtest.h"
#include "server/observability/call_observer.h"
#include "server/observability/log.h"
#include "tests/server/fake_experiments.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::HasSubstr;
using Line = google::protobuf::Struct;

std::string Text(const Line& line, const std::string& name) {
  const auto found = line.fields().find(name);
  return found == line.fields().end() ? "" : found->second.string_value();
}

class CallLog : public testing::Test {
 protected:
  CallLog() { SetLogOptions({.format = LogFormat::kJson}); }
  ~CallLog() override { SetLogOptions({}); }

  // What was written while `act` ran.
  template <typename Act>
  static std::vector<Line> LinesOf(Act act) {
    testing::internal::CaptureStderr();
    act();
    std::istringstream text(testing::internal::GetCapturedStderr());
    std::vector<Line> lines;
    for (std::string line; std::getline(text, line);) {
      const auto status = google::protobuf::util::JsonStringToMessage(line, &lines.emplace_back());
      EXPECT_TRUE(status.ok()) << line;
    }
    return lines;
  }

  static std::vector<std::string> Messages(const std::vector<Line>& lines) {
    std::vector<std::string> messages;
    for (const Line& line : lines) messages.push_back(Text(line, "message"));
    return messages;
  }

  ServerOptions Options() {
    ServerOptions options;
    options.data_dir = folder_.File("data");
    options.factory = FakeExperiments();
    options.limits.max_points_per_job = 10;
    return options;
  }

  TemporaryFolder folder_;
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

TEST_F(CallLog, AJobsLifeIsToldWithJobPrincipalAndRequest) {
  std::string name;
  const auto lines = LinesOf([&] {
    RunningServer server(Options());
    grpc::ClientContext context;
    context.AddMetadata("x-request-id", "my-request");
    v1::CreateEnsembleJobRequest request;
    *request.mutable_spec() = Equilibrium(2, 3);
    v1::EnsembleJob job;
    ASSERT_TRUE(server.ensemble().CreateEnsembleJob(&context, request, &job).ok());
    name = job.name();
    server.AwaitEnd(name);
    server.Get(name);  // reading is not told
    ASSERT_TRUE(server.Delete(name).ok());
  });
  EXPECT_THAT(Messages(lines), testing::UnorderedElementsAre("job accepted", "job running",
                                                             "job succeeded", "job deleted"));
  for (const Line& line : lines) {
    EXPECT_EQ(Text(line, "job"), name);
    EXPECT_EQ(Text(line, "principal"), "local");
    if (Text(line, "message") == "job accepted") {
      EXPECT_EQ(Text(line, "request_id"), "my-request");
    }
    if (Text(line, "message") == "job succeeded") {
      EXPECT_EQ(line.fields().at("samples").number_value(), 2 * 3 * kFakeSamplesPerBlock);
      EXPECT_GE(line.fields().at("seconds").number_value(), 0);
    }
  }
}

TEST_F(CallLog, AFailedJobSaysWhy) {
  ServerOptions options = Options();
  options.factory = FakeExperiments(
      [](size_t, uint64_t, std::stop_token) { throw std::runtime_error("line one\nline two"); });
  const auto lines = LinesOf([&] {
    RunningServer server(options);
    server.AwaitEnd(server.Submit(Equilibrium(1, 3)));
  });
  EXPECT_THAT(Messages(lines),
              testing::UnorderedElementsAre("job accepted", "job running", "job failed"));
  for (const Line& line : lines) {
    if (Text(line, "message") != "job failed") continue;
    EXPECT_EQ(Text(line, "severity"), "WARNING");
    EXPECT_THAT(Text(line, "error"), HasSubstr("line one\nline two"));
  }
}

TEST_F(CallLog, ACallOverALimitIsToldAndOneThatIsMerelyWrongIsNot) {
  const auto lines = LinesOf([&] {
    RunningServer server(Options());
    v1::CreateEnsembleJobRequest request;
    v1::EnsembleJob job;
    EXPECT_FALSE(server.Create(request, &job).ok());
    *request.mutable_spec() = Equilibrium(11, 1);
    EXPECT_FALSE(server.Create(request, &job).ok());
    grpc::ClientContext context;
    v1::GetEnsembleJobRequest none;
    none.set_name("ensembleJobs/none");
    EXPECT_EQ(server.ensemble().GetEnsembleJob(&context, none, &job).error_code(),
              grpc::StatusCode::NOT_FOUND);
  });
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(Text(lines[0], "message"), HasSubstr("call refused: the grid has 11 points"));
  EXPECT_EQ(Text(lines[0], "severity"), "WARNING");
  EXPECT_EQ(Text(lines[0], "method"), "CreateEnsembleJob");
  EXPECT_EQ(Text(lines[0], "principal"), "local");
  EXPECT_EQ(Text(lines[0], "code"), "RESOURCE_EXHAUSTED");
  EXPECT_EQ(Text(lines[0], "reason"), "TOO_MANY_POINTS");
  EXPECT_EQ(Text(lines[0], "request_id").size(), 16u);
}

TEST_F(CallLog, WhatThrowsIsToldAsTheServersFault) {
  ServerOptions options = Options();
  options.compare = [](const MethodComparisonSpec&, const std::stop_token&,
                       const std::function<void(const MethodMeasurement&)>&) -> absl::Status {
    throw std::runtime_error("no memory left");
  };
  const auto lines = LinesOf([&] {
    RunningServer server(options);
    grpc::ClientContext context;
    v1::CompareMethodsRequest request;
    request.set_rho(0.53);
    request.set_delta(0.1);
    request.set_epsilon(0.1);
    const auto stream = server.method().CompareMethods(&context, request);
    v1::MethodMeasurement message;
    while (stream->Read(&message)) {
    }
    EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::INTERNAL);
  });
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(Text(lines[0], "message"), "call failed: no memory left");
  EXPECT_EQ(Text(lines[0], "severity"), "ERROR");
  EXPECT_EQ(Text(lines[0], "method"), "CompareMethods");
  EXPECT_EQ(Text(lines[0], "principal"), "local");
}

TEST_F(CallLog, TheOperatorIsToldOfWhatIsHisConcern) {
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

TEST_F(CallLog, AFloodAtTheDoorIsCountedWholeAndToldInPart) {
  CallObserver calls;
  const auto lines = LinesOf([&] {
    for (int i = 0; i < 500; ++i) {
      calls.Failed(Failure(absl::StatusCode::kUnauthenticated, "CREDENTIALS_INVALID"));
    }
  });
  EXPECT_GE(lines.size(), 1u);
  EXPECT_LT(lines.size(), 500u);
  EXPECT_EQ(calls.not_let_in().at("CREDENTIALS_INVALID"), 500u);
  // Lines of refusals do not use up those of failures.
  EXPECT_EQ(LinesOf([&] { calls.Failed(Failure(absl::StatusCode::kInternal, "")); }).size(), 1u);
}

TEST_F(CallLog, WhatIsLessSevereThanWantedIsNotWritten) {
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

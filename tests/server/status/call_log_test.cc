// The log lines of calls and jobs.
#include "prometheus/text_serializer.h"
#include "server/status/call_observer.h"
#include "server/status/log.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

// The lines that are logged while `act` runs.
template <typename Act>
std::vector<std::string> LinesOf(Act act) {
  testing::internal::CaptureStderr();
  act();
  return absl::StrSplit(testing::internal::GetCapturedStderr(), '\n', absl::SkipEmpty());
}

FailedCall Failure(absl::StatusCode code, const std::string& reason) {
  return {.method = "GetEnsembleJob",
          .principal = "alice",
          .code = code,
          .reason = reason,
          .message = "why",
          .seconds = 0.5};
}

TEST(CallLog, AJobsLifeIsLoggedWithJobAndPrincipal) {
  std::string name;
  const auto lines = LinesOf([&] {
    RunningServer server;
    name = server.Succeeded(Equilibrium(2, 3));
    server.Get(name);  // reading is not logged
    ASSERT_OK(server.Delete(name));
  });
  EXPECT_THAT(lines, UnorderedElementsAre(
                         HasSubstr("job accepted"), HasSubstr("job running"),
                         AllOf(HasSubstr("job succeeded"), HasSubstr(" seconds="),
                               HasSubstr(absl::StrCat(" samples=", 2 * 3 * kFakeSamplesPerBlock))),
                         HasSubstr("job deleted")));
  EXPECT_THAT(lines, Each(AllOf(HasSubstr("job=" + name), HasSubstr("principal=local"))));
}

TEST(CallLog, CallsOverALimitAreLoggedAndInvalidCallsAreNot) {
  const auto lines = LinesOf([&] {
    RunningServer server({.limits = {.max_points_per_job = 10}});
    EXPECT_FALSE(server.Call(v1::CreateEnsembleJobRequest()).ok());
    EXPECT_FALSE(server.Call(CreateRequest(Equilibrium(11, 1))).ok());
    EXPECT_THAT(server.Delete("ensembleJobs/none"), StatusIs(grpc::StatusCode::NOT_FOUND));
  });
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(lines[0],
              AllOf(HasSubstr("warning: call rejected: the grid has 11 points"),
                    HasSubstr("(method=CreateEnsembleJob principal=local code=RESOURCE_EXHAUSTED "
                              "reason=TOO_MANY_POINTS seconds=")));
}

TEST(CallLog, OnlyEventsForTheOperatorAreLogged) {
  using absl::StatusCode;
  const auto verdict = [](StatusCode code, const char* reason = "") {
    return VerdictOn(Failure(code, reason));
  };
  EXPECT_EQ(verdict(StatusCode::kInternal), Verdict::kServerFailed);
  EXPECT_EQ(verdict(StatusCode::kUnavailable, "STORE_FAILED"), Verdict::kServerFailed);
  EXPECT_EQ(verdict(StatusCode::kUnavailable, "SHUTTING_DOWN"), Verdict::kOrdinary);
  EXPECT_EQ(verdict(StatusCode::kResourceExhausted, "TOO_MANY_JOBS"), Verdict::kLimitReached);
  EXPECT_EQ(verdict(StatusCode::kUnauthenticated, "CREDENTIALS_MISSING"), Verdict::kNotLetIn);
  EXPECT_EQ(verdict(StatusCode::kPermissionDenied, "ROLE_TOO_LOW"), Verdict::kNotLetIn);
  for (const StatusCode code : {StatusCode::kCancelled, StatusCode::kInvalidArgument,
                                StatusCode::kNotFound, StatusCode::kFailedPrecondition,
                                StatusCode::kDeadlineExceeded, StatusCode::kUnimplemented}) {
    EXPECT_EQ(verdict(code), Verdict::kOrdinary) << absl::StatusCodeToString(code);
  }
}

TEST(CallLog, AllRefusedCallsAreCountedAndTenASecondLogged) {
  CallObserver calls;
  const FailedCall refused = Failure(absl::StatusCode::kUnauthenticated, "CREDENTIALS_INVALID");
  const absl::Time begin = absl::FromUnixSeconds(1'700'000'000);
  const auto lines = LinesOf([&] {
    for (int i = 0; i < 500; ++i) calls.Failed(refused, begin + absl::Milliseconds(i));
  });
  EXPECT_EQ(lines.size(), 10u);
  EXPECT_THAT(
      prometheus::TextSerializer().Serialize(calls.metrics().Collect()),
      HasSubstr("ballpiston_failed_authentications_total{reason=\"CREDENTIALS_INVALID\"} 500\n"));
  // Calls that failed have lines of their own.
  EXPECT_EQ(LinesOf([&] { calls.Failed(Failure(absl::StatusCode::kInternal, ""), begin); }).size(),
            1u);
  EXPECT_EQ(LinesOf([&] { calls.Failed(refused, begin + absl::Seconds(1)); }).size(), 1u);
}

// ---- log.h ----

// tests/fuzz (log_line) tests that any text gives one line of printable characters.
TEST(LogLine, IsAMessageForPeople) {
  EXPECT_EQ(LogLine(Severity::kWarning, "the server's \"disk\"",
                    {{"job", "ensembleJobs/1"},
                     {"who", "a \"b\""},
                     {"empty", ""},
                     {"n", 3},
                     {"seconds", 0.25}}),
            "ballpistond: warning: the server's \"disk\" "
            "(job=ensembleJobs/1 who=\"a \\\"b\\\"\" n=3 seconds=0.25)\n");
  EXPECT_EQ(LogLine(Severity::kInfo, "stopping"), "ballpistond: stopping\n");
  EXPECT_EQ(LogLine(Severity::kError, "a\n\xC3\xA9"), "ballpistond: error: a\\n\\xc3\\xa9\n");
}

TEST(Log, LinesHaveATimeAndAtLeastTheChosenSeverity) {
  SetLogLevel(Severity::kWarning);
  testing::internal::CaptureStderr();
  Log(Severity::kInfo, "a");
  Log(Severity::kWarning, "b");
  SetLogLevel(Severity::kNone);
  Log(Severity::kError, "c");
  SetLogLevel(Severity::kInfo);
  EXPECT_THAT(
      testing::internal::GetCapturedStderr(),
      testing::MatchesRegex("[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}\\.[0-9]{3}Z "
                            "ballpistond: warning: b\n"));
}

}  // namespace
}  // namespace ballpiston::server

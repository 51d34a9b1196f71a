#include "client/command/print_result.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "absl/strings/str_split.h"
#include "tests/client/program.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// The channel makes up to this number of attempts for a call.
constexpr int kAttemptsOfChannel = 4;

// A job of five points on three pages; the first attempts to list the second page fail.
class PrintResultTest : public ::testing::Test {
 protected:
  PrintResultTest() {
    server_.ensemble.jobs = {JobIn(v1::EnsembleJob::SUCCEEDED)};
    for (int i = 0; i < 5; ++i) server_.ensemble.points.emplace_back().set_index(i);
    server_.ensemble.unavailable_later_pages = kAttemptsOfChannel;
    server_.Start();
  }

  absl::StatusOr<ExitCode> Print() {
    Terminal terminal{out_, err_};
    Options options;
    options.format = Format::kJsonl;
    return PrintResult(connection_, kJobName, options, terminal);
  }

  FakeServer server_;
  const std::shared_ptr<grpc::Channel> channel_ = server_.Channel();
  Connection connection_{.address = server_.Address(),
                         .channel = channel_,
                         .client = Client(channel_),
                         .flags = "",
                         .security = {}};
  std::ostringstream out_, err_;
};

TEST_F(PrintResultTest, RepeatsAPageAfterAPrivateServerWasRevived) {
  connection_.client = Client(channel_, kCallTimeout, [] { return absl::OkStatus(); });
  EXPECT_THAT(Print(), IsOkAndHolds(ExitCode::kDone));
  const std::vector<std::string> lines = absl::StrSplit(out_.str(), '\n', absl::SkipEmpty());
  ASSERT_EQ(lines.size(), 5u) << out_.str();  // each point once
  for (size_t i = 0; i < lines.size(); ++i) {
    EXPECT_THAT(lines[i], HasSubstr("\"index\":" + std::to_string(i)));
  }
}

class PrintPointTest : public ProgramTest {
 protected:
  PrintPointTest() {
    v1::PointResult second = server_.ensemble.points[0];
    second.set_index(1);
    second.mutable_estimates(0)->set_value(2.5);
    server_.ensemble.points.push_back(second);
  }
};

TEST_F(PrintPointTest, EachFormatPrintsOnlyThePoint) {
  for (const std::string format : {"table", "csv", "json", "jsonl"}) {
    const Outcome one = WithServer({"result", "abc", "--point", "1", "--format", format});
    EXPECT_EQ(one.code, 0) << one.err;
    EXPECT_EQ(one.err, "");
    EXPECT_THAT(one.out, AllOf(HasSubstr("mean_hit_time"), HasSubstr("2.5"))) << format;
    EXPECT_THAT(one.out, Not(HasSubstr("1.5"))) << format;
  }
  EXPECT_THAT(server_.ensemble.Asked().results, testing::IsEmpty());
}

TEST_F(PrintPointTest, ASinglePointHasTheSameFormatAsAllPoints) {
  server_.ensemble.points.erase(server_.ensemble.points.begin());
  for (const std::string format : {"table", "csv", "json", "jsonl"}) {
    EXPECT_EQ(WithServer({"result", "abc", "--point", "1", "--format", format}).out,
              WithServer({"result", "abc", "--format", format}).out);
  }
}

TEST_F(PrintPointTest, WithoutThePointOrTheJobExitsWithFiveAndNoOutput) {
  EXPECT_EQ(
      WithServer({"result", "abc", "--point", "2", "--format", "json"}),
      (Outcome{5, "",
               "ballpiston: no such result: ensembleJobs/abc/results/2 (RESULT_NOT_FOUND)\n"}));
  const Outcome unknown = WithServer({"result", "none", "--point", "0"});
  EXPECT_EQ(unknown.code, 5);
  EXPECT_EQ(unknown.err, "ballpiston: no such job: ensembleJobs/none (JOB_NOT_FOUND)\n");
}

TEST_F(PrintPointTest, ANegativePointIsRejected) {
  const Outcome outcome = WithServer({"result", "abc", "--point", "-1"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err, "ballpiston: --point: -1 is below 0\n");
  EXPECT_THAT(server_.ensemble.Asked().result, testing::IsEmpty());
}

TEST_F(PrintResultTest, DoesNotRepeatAPageOfANamedServer) {
  EXPECT_THAT(Print(), StatusIs(absl::StatusCode::kUnavailable));
}

}  // namespace
}  // namespace ballpiston::client

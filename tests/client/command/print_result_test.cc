#include "client/command/print_result.h"

#include "tests/client/preamble.h"

namespace ballpiston::client {
namespace {

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

TEST_F(PrintResultTest, DoesNotRepeatAPageOfANamedServer) {
  EXPECT_THAT(Print(), StatusIs(absl::StatusCode::kUnavailable));
}

}  // namespace
}  // namespace ballpiston::client

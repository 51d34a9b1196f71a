#include "client/command/print_result.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "absl/strings/str_split.h"
#include "tests/client/fake_server.h"

namespace ballpiston::client {
namespace {

constexpr char kName[] = "ensembleJobs/abc";
// As often as the channel itself tries a call before it fails.
constexpr int kAttemptsOfChannel = 4;

// A job of five points on three pages, of which the second is not to be had at once.
class PrintResultTest : public ::testing::Test {
 protected:
  PrintResultTest() {
    server_.ensemble.jobs = {JobIn(v1::EnsembleJob::SUCCEEDED)};
    server_.ensemble.jobs[0].set_name(kName);
    for (int i = 0; i < 5; ++i) server_.ensemble.points.emplace_back().set_index(i);
    server_.ensemble.unavailable_later_pages = kAttemptsOfChannel;
    server_.Start();
    connection_.address = server_.Address();
    connection_.channel = server_.Channel();
  }

  absl::StatusOr<ExitCode> Print() {
    Terminal terminal{out_, err_};
    return PrintResult(connection_, kName, Format::kJsonl, terminal);
  }

  FakeServer server_;
  Connection connection_;
  std::ostringstream out_, err_;
};

TEST_F(PrintResultTest, APageIsAskedForAgainOfAPrivateServerThatWasRevived) {
  connection_.local = LocalServer{
      .folder = "/", .socket = server_.Address().substr(5), .program = "not-to-be-started"};
  const absl::StatusOr<ExitCode> printed = Print();
  ASSERT_TRUE(printed.ok()) << printed.status();
  EXPECT_EQ(*printed, ExitCode::kDone);
  const std::vector<std::string> lines = absl::StrSplit(out_.str(), '\n', absl::SkipEmpty());
  ASSERT_EQ(lines.size(), 5u) << out_.str();  // each point once
  for (size_t i = 0; i < lines.size(); ++i) {
    EXPECT_NE(lines[i].find("\"index\":" + std::to_string(i)), std::string::npos) << lines[i];
  }
}

TEST_F(PrintResultTest, ANamedServerIsNotAskedAgain) {
  EXPECT_EQ(Print().status().code(), absl::StatusCode::kUnavailable);
}

}  // namespace
}  // namespace ballpiston::client

// Ctrl-C while a job is followed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <memory>
#include <string>

#include "absl/strings/str_split.h"
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

using ::testing::HasSubstr;

constexpr char kHint[] = "Press Ctrl-C again within 5 s to cancel the job.";

constexpr std::chrono::seconds kWindow(5);

// Where the machine was so busy that an attempt did not come to its end in the window, which says
// nothing, there is another.
constexpr int kAttempts = 20;

class Stopwatch {
 public:
  bool Within(std::chrono::milliseconds time) const { return Clock::now() - start_ < time; }

 private:
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start_ = Clock::now();
};

class InterruptTest : public ::testing::Test {
 protected:
  InterruptTest() { StartRun(); }

  // A run that takes years; when this returns the job has been accepted and is being watched.
  void StartRun() {
    run_ = server_.StartClient({"run", "equilibrium", "--rho", "0.53", "--delta", "0.05",
                                "--collisions", "1000000000000", "--model", "billiard", "--fresh",
                                "--progress", "json", "--format", "csv"});
    job_ = At(ParseJson(run_->WaitForErrLine([](const std::string&) { return true; })), "job")
               .string_value();
  }

  std::string State() const {
    const auto json = ParseJson(server_.Client({"list", "--format", "json"}).out);
    return At(json, "jobs", 0, "state").string_value();
  }

  const TestServer server_;
  std::unique_ptr<Process> run_;
  std::string job_;
};

TEST_F(InterruptTest, WithoutASecondPressTheClientLetsGoAndTheJobGoesOn) {
  run_->Signal(SIGINT);
  const ProcessResult result = run_->Wait();
  EXPECT_EQ(result.exit_code, 130);
  EXPECT_THAT(result.err,
              HasSubstr("ballpiston watch " + job_ + " --server " + server_.Address() + "\\n"));
  // All of it can be read by a program.
  for (const auto line : absl::StrSplit(result.err, '\n', absl::SkipEmpty())) {
    EXPECT_FALSE(ParseJson(std::string(line)).fields().empty()) << line;
  }
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(State(), "RUNNING");
}

// The client's window begins after the first press was sent: a second one that was sent in this
// test's window is in the client's.
TEST_F(InterruptTest, ASecondPressCancels) {
  bool in_window = false;
  for (int i = 0; i < kAttempts && !in_window; ++i) {
    if (i > 0) StartRun();
    const Stopwatch since_first;
    run_->Signal(SIGINT);
    ASSERT_TRUE(run_->WaitForErr(kHint));
    run_->Signal(SIGINT);
    in_window = since_first.Within(kWindow);
    run_->Wait();
  }
  ASSERT_TRUE(in_window) << "the machine was not quick enough in " << kAttempts << " attempts";
  const ProcessResult result = run_->Wait();
  EXPECT_EQ(result.exit_code, 130);
  EXPECT_THAT(result.err, HasSubstr("cancelled " + job_));
  EXPECT_EQ(server_.Client({"watch", job_}).exit_code, 4);
  EXPECT_EQ(State(), "CANCELLED");
}

// Ended by another client while this one waits for the second press.
TEST_F(InterruptTest, AJobThatEndsMeanwhileIsShown) {
  for (int i = 0; i < kAttempts; ++i) {
    if (i > 0) StartRun();
    const Stopwatch since_first;
    run_->Signal(SIGINT);
    ASSERT_TRUE(run_->WaitForErr(kHint));
    EXPECT_EQ(server_.Client({"cancel", job_}).exit_code, 0);
    const bool in_time = since_first.Within(kWindow / 2);  // the rest is for the client to see it
    const ProcessResult result = run_->Wait();
    if (!in_time) continue;
    EXPECT_EQ(result.exit_code, 4);
    EXPECT_THAT(result.out, HasSubstr("rho,delta,"));
    return;
  }
  FAIL() << "the machine was not quick enough in " << kAttempts << " attempts";
}

}  // namespace
}  // namespace ballpiston

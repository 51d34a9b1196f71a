// Ctrl-C while the client watches a job.
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

// On a busy machine an attempt may last longer than the window. Such an attempt shows nothing and
// is repeated.
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
    run_ = server_.StartClient(
        Joined({{"run"}, kEndlessQuestion, Split("--fresh --progress json --format csv")}));
    job_ = At(ParseJson(run_->WaitForErrLine([](const std::string&) { return true; })), "job")
               .string_value();
  }

  std::string State() const {
    return At(server_.Json({"list"}), "jobs", 0, "state").string_value();
  }

  const TestServer server_;
  std::unique_ptr<Process> run_;
  std::string job_;
};

TEST_F(InterruptTest, WithoutASecondPressTheClientEndsAndTheJobGoesOn) {
  run_->Signal(SIGINT);
  const ProcessResult result = run_->Wait();
  EXPECT_THAT(result, ExitsWith(130));
  EXPECT_THAT(result.err,
              HasSubstr("ballpiston watch " + job_ + " --server " + server_.address() + "\\n"));
  // Every line is JSON.
  for (const auto line : absl::StrSplit(result.err, '\n', absl::SkipEmpty())) {
    EXPECT_FALSE(ParseJson(std::string(line)).fields().empty()) << line;
  }
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(State(), "RUNNING");
}

// The client's window begins after the test sends the first press. A second press within the test's
// window is therefore within the client's window too.
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
  EXPECT_THAT(result, ExitsWith(130));
  EXPECT_THAT(result.err, HasSubstr("cancelled " + job_));
  EXPECT_THAT(server_.Client({"watch", job_}), ExitsWith(4));
  EXPECT_EQ(State(), "CANCELLED");
}

// Another client cancels the job while the first one waits for the second press.
TEST_F(InterruptTest, AJobThatEndsBeforeTheSecondPressIsPrinted) {
  for (int i = 0; i < kAttempts; ++i) {
    if (i > 0) StartRun();
    const Stopwatch since_first;
    run_->Signal(SIGINT);
    ASSERT_TRUE(run_->WaitForErr(kHint));
    EXPECT_THAT(server_.Client({"cancel", job_}), ExitsWith(0));
    const bool in_time = since_first.Within(kWindow / 2);  // the rest is for the client to see it
    const ProcessResult result = run_->Wait();
    if (!in_time) continue;
    EXPECT_THAT(result, ExitsWith(4));
    EXPECT_THAT(result.out, HasSubstr("rho,delta,"));
    return;
  }
  FAIL() << "the machine was not quick enough in " << kAttempts << " attempts";
}

}  // namespace
}  // namespace ballpiston

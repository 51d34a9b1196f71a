// Traces, from the command line to the lines that a pipeline reads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <string>
#include <vector>

#include "absl/strings/str_split.h"
#include "tests/end_to_end/programs.h"
#include "tests/support/await.h"

namespace ballpiston {
namespace {

using ::testing::HasSubstr;

class TraceTest : public ::testing::Test {
 protected:
  static Words Command(const std::string& flags) {
    return Split("trace --rho 0.529561127988977 --delta 0.2 " + flags);
  }

  std::vector<google::protobuf::Struct> Lines(const std::string& flags) const {
    const ProcessResult result = server_.Client(Command(flags));
    EXPECT_THAT(result, ExitsWith(0));
    EXPECT_EQ(result.err, "");
    std::vector<google::protobuf::Struct> lines;
    for (const auto line : absl::StrSplit(result.out, '\n', absl::SkipEmpty())) {
      lines.push_back(ParseJson(std::string(line)));
    }
    return lines;
  }

  double Streams() const {
    return At(server_.Json({"server", "status"}), "streams").number_value();
  }

  const TestServer server_;
};

TEST_F(TraceTest, OfAPairHasItsMeanFreeTime) {
  const auto lines = Lines("--events 20000 --seed 1");
  ASSERT_EQ(lines.size(), 20'001u);
  EXPECT_EQ(At(lines[0], "event").string_value(), "start");
  double sum = 0;
  int exchanges = 0;
  for (const auto& line : lines) {
    if (At(line, "event").string_value() != "ball_piston" || !line.fields().contains("free_time")) {
      continue;
    }
    sum += At(line, "free_time").number_value();
    ++exchanges;
    EXPECT_NEAR(At(line, "ball_energy").number_value() + At(line, "piston_energy").number_value(),
                0.5, 1e-14);
  }
  // Five standard errors: that of a million events is 0.7 %.
  const auto closed_forms = server_.Json(Split("analytic --rho 0.529561127988977 --delta 0.2"));
  const double exact = At(closed_forms, "points", 0, "tau_ball_piston").number_value();
  EXPECT_NEAR(sum / exchanges, exact, 0.25 * exact);
}

TEST_F(TraceTest, OfAGasPrintsTheSameLinesAgain) {
  const Words command = Command("--cells 4x3 --temperature 2 --events 3000");
  const ProcessResult once = server_.Client(command);
  EXPECT_THAT(once, ExitsWith(0));
  EXPECT_THAT(once.out, HasSubstr("\"cells\":\"4x3\""));
  EXPECT_EQ(server_.Client(command).out, once.out);
}

TEST_F(TraceTest, BadFlagsExitWithTwoAndNameTheRange) {
  const ProcessResult gas =
      server_.Client(Split("trace --rho 0.529561127988977 --delta 0.21 --cells 2000 --events 0"));
  EXPECT_THAT(gas, ExitsWith(2));
  EXPECT_EQ(gas.out, "");
  EXPECT_THAT(gas.err, HasSubstr("delta is 0.21; permitted"));
  EXPECT_THAT(gas.err, HasSubstr("permitted in a trace: 1 to 1000"));
  EXPECT_THAT(gas.err, HasSubstr("events: is 0; permitted: 1 to 1000000"));
}

TEST_F(TraceTest, AnInterruptionEndsClientAndTrace) {
  ProcessOptions options = server_.Command(Command("--events 1e6"));
  options.command.insert(options.command.begin(), {"sh", "-c", "exec \"$@\" >/dev/null", "sh"});
  for (const int signal : {SIGINT, SIGTERM}) {
    Process trace(options);
    AwaitThat([this] { return Streams() == 1; });
    trace.Signal(signal);
    EXPECT_THAT(trace.Wait(), ExitsWith(130));
    AwaitThat([this] { return Streams() == 0; });
  }
}

TEST_F(TraceTest, AReaderThatLeavesEndsTheTrace) {
  ProcessOptions options = server_.Command(Command("--events 1e6"));
  options.command.insert(options.command.begin(), {"sh", "-c", "\"$@\" | head -n 1", "sh"});
  const ProcessResult result = RunProgram(options);
  EXPECT_THAT(result, ExitsWith(0));
  EXPECT_EQ(At(ParseJson(result.out), "event").string_value(), "start");
  EXPECT_EQ(result.err, "");
  AwaitThat([this] { return Streams() == 0; });
}

}  // namespace
}  // namespace ballpiston

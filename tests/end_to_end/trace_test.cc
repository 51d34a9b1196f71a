// Traces, from the command line to the lines that a pipeline reads.
#include "tests/end_to_end/programs.h"

namespace ballpiston {
namespace {

class TraceTest : public ::testing::Test {
 protected:
  static Words Command(const std::string& flags) {
    return Split("trace --rho 0.529561127988977 --delta 0.2 " + flags);
  }

  double Streams() const {
    return At(server_.Json({"server", "status"}), "streams").number_value();
  }

  const TestServer server_;
};

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

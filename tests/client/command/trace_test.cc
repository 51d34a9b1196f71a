#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>
#include <streambuf>
#include <string>
#include <vector>

#include "absl/strings/str_split.h"
#include "client/library/client.h"
#include "tests/client/program.h"
#include "tests/support/message_text.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::vector<std::string> kTrace = {
    "trace",         "--rho", "0.53",   "--delta", "0.1",      "--cells", "1e1x02",
    "--temperature", "2",     "--seed", "7",       "--events", "1e3"};

class TraceTest : public ProgramTest {
 protected:
  TraceTest() {
    server_.trace.messages = {
        FromText<v1::TraceOrbitResponse>("start { event: start balls { x: 0.5 } }"),
        FromText<v1::TraceOrbitResponse>("events { time: 1 event: piston_wall piston: 0 } events { "
                                         "time: 2.5 event: ball_wall }"),
        FromText<v1::TraceOrbitResponse>(
            "events { time: 3 event: ball_piston free_time: 0 ball: 1 }")};
  }
};

TEST_F(TraceTest, SendsTheFlags) {
  EXPECT_EQ(WithServer(kTrace).code, 0);
  const v1::TraceOrbitRequest& asked = server_.trace.asked;
  EXPECT_EQ(asked.rho(), 0.53);
  EXPECT_EQ(asked.delta(), 0.1);
  EXPECT_EQ(asked.cells(), "10x2");
  EXPECT_EQ(asked.temperature(), 2);
  EXPECT_EQ(asked.seed(), 7u);
  EXPECT_EQ(asked.events(), 1000);
}

TEST_F(TraceTest, WithoutATemperatureTheServersDefaultIsUsed) {
  EXPECT_EQ(WithServer({"trace", "--rho", "0.53", "--delta", "0.1", "--events", "3"}).code, 0);
  EXPECT_FALSE(server_.trace.asked.has_temperature());
  EXPECT_EQ(server_.trace.asked.cells(), "");
}

// Absent fields are left out; an index or a time of 0 is printed.
TEST_F(TraceTest, PrintsTheStartAndEachEventAsALine) {
  const Outcome outcome = WithServer(kTrace);
  EXPECT_EQ(outcome.err, "");
  const std::vector<std::string> lines = absl::StrSplit(outcome.out, '\n');
  EXPECT_THAT(lines,
              ElementsAre(HasSubstr("{\"time\":0,\"event\":\"start\","),
                          "{\"time\":1,\"event\":\"piston_wall\",\"piston\":0}",
                          "{\"time\":2.5,\"event\":\"ball_wall\"}",
                          "{\"time\":3,\"event\":\"ball_piston\",\"free_time\":0,\"ball\":1}", ""));
  EXPECT_THAT(lines[0], HasSubstr("\"balls\":[{\"x\":0.5,"));
}

TEST_F(TraceTest, AnErrorAfterSomeLinesIsReported) {
  server_.trace.end = grpc::Status(grpc::StatusCode::UNAVAILABLE, "the server is stopping");
  const Outcome outcome = WithServer(kTrace);
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.out, HasSubstr("\"time\":3"));
  EXPECT_THAT(outcome.err, HasSubstr("the server is stopping"));
}

TEST_F(TraceTest, OneShapeIsPermitted) {
  std::vector<std::string> words = kTrace;
  words[6] = "2,3";
  const Outcome outcome = WithServer(words);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--cells: '2,3' is not a shape"));
}

TEST_F(TraceTest, ACallbackEndsTheStream) {
  server_.trace.messages.resize(100'000, server_.trace.messages.back());
  server_.Start();
  int messages = 0;
  EXPECT_OK(Client(server_.Channel()).Trace({}, [&](const v1::TraceOrbitResponse&) {
    return ++messages < 3;
  }));
  EXPECT_EQ(messages, 3);
}

}  // namespace
}  // namespace ballpiston::client

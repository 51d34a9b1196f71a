#include "server/convert/trace.h"
#include "server/rpc/quota.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

v1::TraceOrbitRequest TraceRequest(int64_t events, const std::string& cells = "") {
  v1::TraceOrbitRequest request;
  request.set_rho(kPaperRho);
  request.set_delta(0.15);
  request.set_cells(cells);
  request.set_events(events);
  return request;
}

// Far more than gRPC keeps of a stream whose reader stalls.
const v1::TraceOrbitRequest kLong = TraceRequest(kMaxTracedEvents);

class TraceServiceTest : public testing::Test {
 protected:
  RunningServer server_;
};

// A free time is the time since the last event of the same kind: a pair has one ball and one
// piston.
TEST_F(TraceServiceTest, TheStartComesFirstThenAsManyEventsAsAsked) {
  for (const int64_t events : {1, kEventsOfMessage, kEventsOfMessage + 1, 1000}) {
    const auto messages = TraceStream(server_, TraceRequest(events)).ToTheEnd();
    ASSERT_GE(messages.size(), 2u);
    const v1::TraceStart& start = messages[0].start();
    EXPECT_EQ(start.event(), v1::TraceEvent::start);
    EXPECT_NEAR(start.tip(), (1 - start.lambda()) / 2, 1e-15);
    EXPECT_FALSE(start.has_cells() || start.has_temperature());
    EXPECT_EQ(messages[0].events_size(), 0);
    int64_t told = 0;
    double time = 0;
    std::map<int, double> last;  // by kind
    for (const auto& message : messages) {
      told += message.events_size();
      EXPECT_LE(message.events_size(), kEventsOfMessage);
      for (const v1::TraceEvent& event : message.events()) {
        EXPECT_GE(event.time(), time);
        time = event.time();
        const auto [before, is_first] = last.try_emplace(event.event(), event.time());
        EXPECT_EQ(event.has_free_time(), !is_first);
        EXPECT_NEAR(event.free_time(), event.time() - before->second, 1e-9);
        before->second = event.time();
      }
    }
    EXPECT_EQ(told, events);
  }
}

TEST_F(TraceServiceTest, EventsHaveTheBodiesThatTakePart) {
  int exchanges = 0;
  const auto messages = TraceStream(server_, TraceRequest(2000, "3x3")).ToTheEnd();
  EXPECT_EQ(messages.at(0).start().cells(), "3x3");
  EXPECT_EQ(messages[0].start().temperature(), 1);  // by default
  for (const auto& message : messages) {
    for (const v1::TraceEvent& event : message.events()) {
      EXPECT_EQ(event.has_ball(), event.event() != v1::TraceEvent::piston_wall);
      EXPECT_EQ(event.has_piston(), event.event() != v1::TraceEvent::ball_wall);
      EXPECT_EQ(event.has_ball_energy_before(), event.has_ball());
      if (event.event() != v1::TraceEvent::ball_piston) continue;
      ++exchanges;
      EXPECT_NEAR(event.ball_energy() + event.piston_energy(),
                  event.ball_energy_before() + event.piston_energy_before(), 1e-14);
      EXPECT_NEAR(std::hypot(event.ball_vx(), event.ball_vy()), std::sqrt(2 * event.ball_energy()),
                  1e-14);
    }
  }
  EXPECT_GT(exchanges, 0);
}

// ---- limits, and the end ----

TEST_F(TraceServiceTest, ATraceCountsAsAStreamUntilItsReaderGoes) {
  RunningServer server({.limits = {.max_streams_per_principal = 1}});
  std::optional<TraceStream> first(std::in_place, server, TraceRequest(kMaxTracedEvents, "1000"));
  ASSERT_TRUE(first->Next());
  EXPECT_THAT(TraceStream(server, TraceRequest(1)).End(),
              IsError(grpc::StatusCode::RESOURCE_EXHAUSTED, "TOO_MANY_STREAMS"));
  first.reset();
  // Then the server knows that the trace has ended.
  AwaitThat([&] { return TraceStream(server, TraceRequest(1)).Next().has_value(); });
}

// A call with a large request counts as more than a trace.
TEST_F(TraceServiceTest, TheMemoryOfTracesIsLimited) {
  TestClient reader(OwnChannel(server_.address(), nullptr, SmallWindow()));
  std::vector<std::unique_ptr<TraceStream>> traces;
  v1::EvaluatePairsRequest large;  // 0.8 MB
  large.mutable_rho()->Resize(100'000, kPaperRho);
  for (int64_t mib = 0; mib < kMostMibOfCalls; mib += kMibOfCall) {
    if (mib == kMostMibOfCalls - kMibOfCall) {
      EXPECT_THAT(server_.Call(large),
                  IsError(grpc::StatusCode::RESOURCE_EXHAUSTED, "TOO_MANY_CALLS"));
    }
    traces.push_back(std::make_unique<TraceStream>(reader, kLong));
    ASSERT_TRUE(traces.back()->Next());
  }
  EXPECT_THAT(TraceStream(server_, TraceRequest(1)).End(),
              IsError(grpc::StatusCode::RESOURCE_EXHAUSTED, "TOO_MANY_CALLS"));
}

// A collision exchanges the ball's velocity along x and the piston's. The tolerances are some tens
// of roundings of numbers up to 1.
TEST_F(TraceServiceTest, SampledCollisionsHaveAllColumns) {
  v1::SampleCollisionsRequest request;
  *request.mutable_spec() = Equilibrium(1, 100);
  MessageStream<v1::SampleCollisionsResponse> stream(server_, request);
  v1::SampleCollisionsResponse rows;
  for (const auto& part : stream.ToTheEnd()) rows.MergeFrom(part);
  const auto* columns = rows.GetDescriptor();
  for (int i = 0; i < columns->field_count(); ++i) {
    ASSERT_EQ(rows.GetReflection()->FieldSize(rows, columns->field(i)), 100) << i;
  }
  for (int i = 0; i < rows.sample_size(); ++i) {
    EXPECT_NEAR(rows.ball_vx_after(i), rows.piston_vx(i), 1e-14);
    EXPECT_NEAR(rows.piston_vx_after(i), rows.ball_vx(i), 1e-14);
    EXPECT_DOUBLE_EQ(rows.piston_energy(i), std::pow(rows.piston_vx(i), 2) / 2);
    EXPECT_DOUBLE_EQ(rows.piston_energy_after(i), std::pow(rows.piston_vx_after(i), 2) / 2);
    EXPECT_NEAR(std::pow(rows.ball_vx(i), 2) + std::pow(rows.ball_vy(i), 2),
                1 - std::pow(rows.piston_vx(i), 2), 1e-14);
    EXPECT_GE(rows.time(i), rows.free_time(i));
  }
}

// The reason is lost if the connection closes while the client still writes to it.
TEST_F(TraceServiceTest, AStopEndsTracesThatAreRead) {
  TraceStream stream(server_, kLong);
  ASSERT_TRUE(stream.Next());
  std::thread stop([this] { server_.Shutdown(kUnreachedLimit); });
  EXPECT_THAT(stream.End(), testing::AnyOf(IsError(grpc::StatusCode::UNAVAILABLE, "SHUTTING_DOWN"),
                                           IsError(grpc::StatusCode::UNAVAILABLE, "")));
  stop.join();
}

}  // namespace
}  // namespace ballpiston::server

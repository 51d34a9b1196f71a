#include "client/library/method_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/client/fake_server.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::client {
namespace {

v1::MethodMeasurement WithSamples(uint64_t samples) {
  v1::MethodMeasurement measurement;
  measurement.set_samples(samples);
  return measurement;
}

TEST(MethodClient, ReportsTheMeasurementsInOrder) {
  FakeServer server;
  server.method.measurements = {WithSamples(1), WithSamples(4), WithSamples(16)};
  server.Start();
  v1::CompareMethodsRequest request;
  request.set_epsilon(0.125);
  std::vector<uint64_t> told;
  EXPECT_OK(MethodClient(server.Channel()).CompareMethods(request, [&](const auto& measurement) {
    told.push_back(measurement.samples());
  }));
  EXPECT_THAT(told, testing::ElementsAre(1, 4, 16));
  ASSERT_EQ(server.method.asked.size(), 1u);
  EXPECT_EQ(server.method.asked[0].epsilon(), 0.125);
}

TEST(MethodClient, AStopEndsTheComparison) {
  FakeServer server;
  server.method.measurements = {WithSamples(1)};
  server.method.hangs = true;  // until the client ends the call
  server.Start();
  std::stop_source stop;
  const auto request_stop = [&](const auto&) { stop.request_stop(); };
  EXPECT_THAT(MethodClient(server.Channel()).CompareMethods({}, request_stop, stop.get_token()),
              StatusIs(absl::StatusCode::kCancelled));
}

// The server could reject a second attempt because the first one still runs.
TEST(MethodClient, AComparisonIsNotRepeated) {
  FakeServer server;
  server.method.end = grpc::Status(grpc::StatusCode::UNAVAILABLE, "not now");
  server.Start();
  EXPECT_THAT(MethodClient(server.Channel()).CompareMethods({}, [](const auto&) {}),
              StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_EQ(server.method.asked.size(), 1u);
}

}  // namespace
}  // namespace ballpiston::client

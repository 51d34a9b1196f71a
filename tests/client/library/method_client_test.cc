#include "client/library/method_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/library/error_text.h"
#include "tests/client/fake_server.h"

namespace ballpiston::client {
namespace {

v1::MethodMeasurement Measured(uint64_t samples) {
  v1::MethodMeasurement measurement;
  measurement.set_samples(samples);
  return measurement;
}

TEST(MethodClient, TellsEachMeasurementInOrder) {
  FakeServer server;
  server.method.measurements = {Measured(1), Measured(4), Measured(16)};
  server.Start();
  v1::CompareMethodsRequest request;
  request.set_epsilon(0.125);
  std::vector<uint64_t> told;
  const absl::Status status =
      MethodClient(server.Channel()).CompareMethods(request, [&](const auto& measurement) {
        told.push_back(measurement.samples());
      });
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_THAT(told, testing::ElementsAre(1, 4, 16));
  ASSERT_EQ(server.method.asked.size(), 1u);
  EXPECT_EQ(server.method.asked[0].epsilon(), 0.125);
}

TEST(MethodClient, AStopEndsTheComparison) {
  FakeServer server;
  server.method.measurements = {Measured(1)};
  server.method.hangs = true;  // until the client has left
  server.Start();
  std::stop_source stop;
  const absl::Status status =
      MethodClient(server.Channel())
          .CompareMethods(
              {}, [&](const auto&) { stop.request_stop(); }, stop.get_token());
  EXPECT_TRUE(absl::IsCancelled(status)) << status;
}

// It might find its own first attempt still running.
TEST(MethodClient, AComparisonIsAskedForOnce) {
  FakeServer server;
  server.method.end = grpc::Status(grpc::StatusCode::UNAVAILABLE, "not now");
  server.Start();
  const absl::Status status = MethodClient(server.Channel()).CompareMethods({}, [](const auto&) {});
  EXPECT_TRUE(absl::IsUnavailable(status)) << status;
  EXPECT_EQ(server.method.asked.size(), 1u);
}

}  // namespace
}  // namespace ballpiston::client

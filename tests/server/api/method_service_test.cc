#include <chrono>
#include <future>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/execution/comparison_thread.h"
#include "tests/server/error_details.h"
#include "tests/server/fake_experiments.h"
#include "tests/server/requests.h"
#include "tests/server/running_server.h"
#include "tests/support/status_matchers.h"

namespace ballpiston::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class MethodServiceTest : public testing::Test {
 protected:
  // With a comparison that tells so many measurements, numbered by their samples, and passes the
  // gate before it ends.
  void Start(uint64_t measurements = 1) {
    StartWith([this, measurements](const MethodComparisonSpec& spec, const std::stop_token& stop,
                                   const auto& tell) {
      for (uint64_t i = 0; i < measurements; ++i) tell({.samples = i});
      told_.set_value(spec);
      told_ = {};
      gate_.Pass(stop);
      return stop.stop_requested() ? absl::CancelledError("stopped") : absl::OkStatus();
    });
  }

  void StartWith(MethodComparer compare) {
    server_.emplace(TestServerOptions{.compare = std::move(compare)});
  }

  struct Stream {
    explicit Stream(RunningServer& server,
                    const v1::CompareMethodsRequest& request = SomeComparison())
        : reader(server.method().CompareMethods(&context, request)) {}

    std::optional<v1::MethodMeasurement> Next() {
      v1::MethodMeasurement message;
      if (!reader->Read(&message)) return std::nullopt;
      return message;
    }
    grpc::Status End() {  // whatever comes before it
      while (Next()) {
      }
      return reader->Finish();
    }

    grpc::ClientContext context;
    std::unique_ptr<grpc::ClientReader<v1::MethodMeasurement>> reader;
  };

  ErrorDetails Refusal(const v1::CompareMethodsRequest& request) {
    const grpc::Status status = Stream(*server_, request).End();
    EXPECT_THAT(status, StatusIs(grpc::StatusCode::INVALID_ARGUMENT));
    return DetailsOf(status);
  }

  Gate gate_;
  std::promise<MethodComparisonSpec> told_;  // all, by the comparison that runs
  std::optional<RunningServer> server_;
};

TEST_F(MethodServiceTest, MeasurementsComeInTheOrderTheyAreMade) {
  Start(500);
  gate_.Open();
  Stream stream(*server_);
  for (uint64_t i = 0; i < 500; ++i) {
    const auto message = stream.Next();
    ASSERT_TRUE(message);
    ASSERT_EQ(message->samples(), i);
  }
  EXPECT_FALSE(stream.Next());
  EXPECT_OK(stream.reader->Finish());
}

TEST_F(MethodServiceTest, MeasurementsComeAsSoonAsTheyAreMade) {
  Start(3);
  Stream stream(*server_);
  for (uint64_t i = 0; i < 3; ++i) EXPECT_EQ(stream.Next()->samples(), i);  // the gate is closed
  gate_.Open();
  EXPECT_OK(stream.End());
}

TEST_F(MethodServiceTest, TheComparisonGetsTheRequestsFields) {
  Start();
  auto told = told_.get_future();
  v1::CompareMethodsRequest request = SomeComparison();
  request.set_seconds_per_curve(0.5);
  request.set_seed(7);
  Stream stream(*server_, request);
  const MethodComparisonSpec spec = told.get();
  EXPECT_EQ(spec.rho, 0.53);
  EXPECT_EQ(spec.delta, 0.1);
  EXPECT_EQ(spec.epsilon, 0.125);
  EXPECT_EQ(spec.seconds_per_curve, 0.5);
  EXPECT_EQ(spec.seed, 7u);
}

TEST_F(MethodServiceTest, ByDefaultACurveHasASecond) {
  Start();
  auto told = told_.get_future();
  Stream stream(*server_);
  EXPECT_EQ(told.get().seconds_per_curve, 1);
}

TEST_F(MethodServiceTest, ASecondComparisonIsRefusedUntilTheFirstEnds) {
  Start();
  Stream first(*server_);
  ASSERT_TRUE(first.Next());
  EXPECT_THAT(Stream(*server_).End(),
              IsError(grpc::StatusCode::RESOURCE_EXHAUSTED, "COMPARISON_RUNNING"));
  gate_.Open();
  EXPECT_OK(first.End());
  EXPECT_OK(Stream(*server_).End());  // at once, without a pause
}

TEST_F(MethodServiceTest, AClientThatLeavesStopsTheComparison) {
  std::promise<bool> stopped;
  StartWith([&](const auto&, const std::stop_token& stop, const auto& tell) {
    tell({});
    gate_.Pass(stop);  // nobody opens it
    stopped.set_value(stop.stop_requested());
    return absl::CancelledError("stopped");
  });
  Stream stream(*server_);
  ASSERT_TRUE(stream.Next());
  stream.context.TryCancel();
  EXPECT_TRUE(stopped.get_future().get());
  EXPECT_THAT(stream.End(), StatusIs(grpc::StatusCode::CANCELLED));
}

TEST_F(MethodServiceTest, AfterAClientLeftTheNextOneIsServed) {
  Start();
  {
    Stream stream(*server_);
    ASSERT_TRUE(stream.Next());
    stream.context.TryCancel();
    stream.End();
  }
  gate_.Open();
  grpc::Status status;
  do {  // the thread may still be on its way back
    status = Stream(*server_).End();
  } while (status.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_OK(status);
}

TEST_F(MethodServiceTest, AStoppingServerEndsTheComparison) {
  Start();
  Stream stream(*server_);
  ASSERT_TRUE(stream.Next());
  server_->Shutdown(std::chrono::hours(1));  // hangs for an hour if the stream does not end
  EXPECT_THAT(stream.End(), IsError(grpc::StatusCode::UNAVAILABLE, "SHUTTING_DOWN"));
}

// One that looks for a stop rarely.
TEST_F(MethodServiceTest, AStreamEndsBeforeItsComparisonDoes) {
  std::promise<void> seen;
  StartWith([&](const auto&, const std::stop_token&, const auto& tell) {
    tell({});
    seen.get_future().wait();
    tell({});  // to nobody
    return absl::CancelledError("stopped");
  });
  Stream stream(*server_);
  ASSERT_TRUE(stream.Next());
  std::thread stopping([&] { server_->Shutdown(std::chrono::hours(1)); });
  EXPECT_THAT(stream.End(), StatusIs(grpc::StatusCode::UNAVAILABLE));
  seen.set_value();
  stopping.join();
}

TEST_F(MethodServiceTest, AServerIsNotIdleDuringAComparison) {
  Start();
  Stream stream(*server_);
  ASSERT_TRUE(stream.Next());
  EXPECT_EQ(server_->server().IdleFor(), std::chrono::steady_clock::duration::zero());
}

// More than a stalled stream takes in: some 5 MB.
TEST_F(MethodServiceTest, AStalledReaderDelaysNoComparisonAndGetsEveryMeasurement) {
  constexpr uint64_t kMany = 300'000;
  Start(kMany);
  auto told = told_.get_future();
  Stream stream(*server_);
  told.get();  // before anything is read
  gate_.Open();
  uint64_t read = 0;
  while (const auto message = stream.Next()) {
    ASSERT_EQ(message->samples(), read);
    ++read;
  }
  EXPECT_EQ(read, kMany);
  EXPECT_OK(stream.reader->Finish());
}

TEST_F(MethodServiceTest, AComparisonThatThrowsEndsWithInternal) {
  bool throws = true;
  StartWith([&](const auto&, const auto&, const auto&) {
    if (std::exchange(throws, false)) throw std::runtime_error("no memory left");
    return absl::OkStatus();
  });
  EXPECT_THAT(Stream(*server_).End(),
              StatusIs(grpc::StatusCode::INTERNAL, HasSubstr("no memory left")));
  EXPECT_OK(Stream(*server_).End());
}

TEST_F(MethodServiceTest, AllWrongFieldsAreListed) {
  Start();
  v1::CompareMethodsRequest request;
  request.set_seconds_per_curve(-1);
  const ErrorDetails details = Refusal(request);
  EXPECT_EQ(details.reason, "INVALID_REQUEST");
  EXPECT_THAT(details.fields, ElementsAre("rho", "delta", "epsilon", "seconds_per_curve"));
}

struct BadField {
  const char* field;
  void (v1::CompareMethodsRequest::*set)(double);
  double value;
  const char* permitted;  // part of the message
};

TEST_F(MethodServiceTest, EachFieldHasItsRange) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  using Request = v1::CompareMethodsRequest;
  Start();
  for (const BadField& bad : {
           BadField{"rho", &Request::set_rho, 0.5, "1/2 < rho < 1/sqrt(2)"},
           BadField{"rho", &Request::set_rho, kNan, "nan"},
           BadField{"delta", &Request::set_delta, 0, "0 < delta"},
           BadField{"delta", &Request::set_delta, 0.4, "0.4"},
           BadField{"epsilon", &Request::set_epsilon, 0, "(0, 1/2)"},
           BadField{"epsilon", &Request::set_epsilon, 0.5, "0.5 is not in (0, 1/2)"},
           BadField{"epsilon", &Request::set_epsilon, kNan, "(0, 1/2)"},
           BadField{"seconds_per_curve", &Request::set_seconds_per_curve, 0.009,
                    "0.009 is not in [0.01, 60]"},
           BadField{"seconds_per_curve", &Request::set_seconds_per_curve, 60.1, "[0.01, 60]"},
           BadField{"seconds_per_curve", &Request::set_seconds_per_curve, kNan, "[0.01, 60]"},
       }) {
    Request request = SomeComparison();
    (request.*bad.set)(bad.value);
    EXPECT_THAT(Refusal(request).fields, ElementsAre(bad.field)) << bad.value;
    EXPECT_THAT(Stream(*server_, request).End().error_message(), HasSubstr(bad.permitted));
  }
}

}  // namespace
}  // namespace ballpiston::server

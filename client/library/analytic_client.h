// The closed forms, evaluated by a server.
#ifndef BALLPISTON_CLIENT_LIBRARY_ANALYTIC_CLIENT_H_
#define BALLPISTON_CLIENT_LIBRARY_ANALYTIC_CLIENT_H_

#include <grpcpp/grpcpp.h>

#include <memory>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "ballpiston/v1/analytic.grpc.pb.h"

namespace ballpiston::client {

// Safe to share between threads. Errors are the server's (error_text.h); UNAVAILABLE or
// DEADLINE_EXCEEDED if it does not answer within `timeout`.
class AnalyticClient {
 public:
  explicit AnalyticClient(const std::shared_ptr<grpc::ChannelInterface>& channel,
                          absl::Duration timeout = absl::Seconds(60));

  absl::StatusOr<v1::EvaluatePairsResponse> EvaluatePairs(
      const v1::EvaluatePairsRequest& request) const;

 private:
  std::unique_ptr<v1::AnalyticService::StubInterface> stub_;
  absl::Duration timeout_;
};

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_LIBRARY_ANALYTIC_CLIENT_H_

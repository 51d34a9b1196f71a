#include "client/library/analytic_client.h"

#include "client/library/unary_call.h"

namespace ballpiston::client {

AnalyticClient::AnalyticClient(const std::shared_ptr<grpc::ChannelInterface>& channel,
                               absl::Duration timeout)
    : stub_(v1::AnalyticService::NewStub(channel)), timeout_(timeout) {}

absl::StatusOr<v1::EvaluatePairsResponse> AnalyticClient::EvaluatePairs(
    const v1::EvaluatePairsRequest& request) const {
  return CallUnary(*stub_, &v1::AnalyticService::StubInterface::EvaluatePairs, request, timeout_);
}

}  // namespace ballpiston::client

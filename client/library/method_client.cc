#include "client/library/method_client.h"

#include "client/library/error_text.h"

namespace ballpiston::client {

MethodClient::MethodClient(const std::shared_ptr<grpc::ChannelInterface>& channel)
    : stub_(v1::MethodService::NewStub(channel)) {}

absl::Status MethodClient::CompareMethods(
    const v1::CompareMethodsRequest& request,
    const std::function<void(const v1::MethodMeasurement&)>& tell,
    const std::stop_token& stop) const {
  grpc::ClientContext context;
  const std::stop_callback cancel(stop, [&context] { context.TryCancel(); });
  const auto reader = stub_->CompareMethods(&context, request);
  v1::MethodMeasurement measurement;
  while (reader->Read(&measurement)) tell(measurement);
  return FromGrpc(reader->Finish());
}

}  // namespace ballpiston::client

// The comparison of methods, made by a server.
#ifndef BALLPISTON_CLIENT_LIBRARY_METHOD_CLIENT_H_
#define BALLPISTON_CLIENT_LIBRARY_METHOD_CLIENT_H_

#include <grpcpp/grpcpp.h>

#include <functional>
#include <memory>
#include <stop_token>

#include "absl/status/status.h"
#include "ballpiston/v1/method.grpc.pb.h"

namespace ballpiston::client {

// Safe to share between threads.
class MethodClient {
 public:
  explicit MethodClient(const std::shared_ptr<grpc::ChannelInterface>& channel);

  // Calls `tell` with each measurement as it comes, on this thread, and returns when the comparison
  // has ended. CANCELLED if `stop` was requested, which ends it on the server too; else the
  // server's error (error_text.h), with COMPARISON_RUNNING if it makes one for somebody else.
  absl::Status CompareMethods(const v1::CompareMethodsRequest& request,
                              const std::function<void(const v1::MethodMeasurement&)>& tell,
                              const std::stop_token& stop = {}) const;

 private:
  std::unique_ptr<v1::MethodService::StubInterface> stub_;
};

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_LIBRARY_METHOD_CLIENT_H_

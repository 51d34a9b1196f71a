// CompareMethods: what the comparison's thread tells, in the order it is told.
//
// One write is outstanding; what is told meanwhile waits in a queue without a bound, because a
// comparison has some 250 messages of 60 bytes: a reader that stalls costs 15 KB and holds up
// nobody. If the client leaves or the server stops, the stream ends at once, whatever waits, and
// the comparison is asked to stop: it does so when it looks.
#ifndef BALLPISTON_SERVER_API_COMPARE_METHODS_H_
#define BALLPISTON_SERVER_API_COMPARE_METHODS_H_

#include <chrono>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>

#include "absl/status/status.h"
#include "ballpiston/v1/method.pb.h"
#include "grpcpp/support/server_callback.h"
#include "server/api/call.h"
#include "server/api/service_context.h"

namespace ballpiston::server {

class CompareMethodsReactor : public grpc::ServerWriteReactor<v1::MethodMeasurement>,
                              public Watch,
                              public std::enable_shared_from_this<CompareMethodsReactor> {
 public:
  // Owns itself until gRPC is done with it. A call that was not admitted ends at once.
  static CompareMethodsReactor* Start(ServiceContext& service, const absl::StatusOr<Call>& call,
                                      const v1::CompareMethodsRequest& request);

  void Look(std::chrono::steady_clock::time_point now) override;  // whether the server stops

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  CompareMethodsReactor(ServiceContext& service, const absl::StatusOr<Call>& call);

  absl::Status Begin(const v1::CompareMethodsRequest& request);  // what Start refuses with, if so
  void Tell(v1::MethodMeasurement message);
  void End(const absl::Status& status);  // when all is written; the first one counts
  void Cut(const absl::Status& status);  // now
  void Advance();                        // writes or finishes, if it is time to

  ServiceContext& service_;
  const std::string principal_;         // empty: not let in
  const std::shared_ptr<void> active_;  // for Activity
  std::stop_source stop_;
  std::shared_ptr<CompareMethodsReactor> self_;
  v1::MethodMeasurement message_;  // being written

  std::mutex mutex_;  // never held while gRPC is called
  std::deque<v1::MethodMeasurement> waiting_;
  bool writing_ = false;
  std::optional<absl::Status> end_;
  bool finished_ = false;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_API_COMPARE_METHODS_H_

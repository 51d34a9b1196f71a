// A server in this process, behind a Unix socket, and a client of it.
#ifndef BALLPISTON_TESTS_SERVER_RUNNING_SERVER_H_
#define BALLPISTON_TESTS_SERVER_RUNNING_SERVER_H_

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "ballpiston/v1/analytic.grpc.pb.h"
#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "ballpiston/v1/method.grpc.pb.h"
#include "google/rpc/error_details.pb.h"
#include "grpcpp/channel.h"
#include "server/ballpiston_server.h"

namespace ballpiston::server {

// What an error says of itself.
struct ErrorDetails {
  std::string reason;
  std::vector<std::string> fields;  // of the violations
};

ErrorDetails DetailsOf(const grpc::Status& status);

// A commit that takes long on a busy machine does not tell of a disk that hangs.
inline constexpr std::chrono::hours kNeverStalls(1);

class RunningServer {
 public:
  explicit RunningServer(ServerOptions options);

  BallpistonServer& server() { return *server_; }
  std::shared_ptr<grpc::Channel> channel() const { return channel_; }
  v1::EnsembleService::Stub& ensemble() { return *ensemble_; }
  v1::AnalyticService::Stub& analytic() { return *analytic_; }
  v1::MethodService::Stub& method() { return *method_; }

  grpc::Status Create(const v1::CreateEnsembleJobRequest& request, v1::EnsembleJob* job);
  std::string Submit(const v1::EnsembleSpec& spec);  // a fresh job's name
  v1::EnsembleJob Get(const std::string& name);
  grpc::Status Cancel(const std::string& name, const std::string& request_id = "");
  grpc::Status Delete(const std::string& name);
  v1::EnsembleJob AwaitEnd(const std::string& name);  // by watching it
  // All pages, each point serialized.
  std::vector<std::string> ResultBytes(const std::string& name);

 private:
  std::unique_ptr<BallpistonServer> server_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::EnsembleService::Stub> ensemble_;
  std::unique_ptr<v1::AnalyticService::Stub> analytic_;
  std::unique_ptr<v1::MethodService::Stub> method_;
};

// An equilibrium run that the fake experiments take (fake_experiments.h): so many points, so many
// collisions, or fake blocks, each.
v1::EnsembleSpec Equilibrium(int points, int64_t collisions);

// All three experiments' worth of real work, small.
v1::EnsembleSpec SmallFirstHit();

}  // namespace ballpiston::server

#endif  // BALLPISTON_TESTS_SERVER_RUNNING_SERVER_H_

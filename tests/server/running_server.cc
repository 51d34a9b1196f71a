#include "tests/server/running_server.h"

#include "grpc/grpc.h"
#include "tests/server/factory_opener.h"

namespace ballpiston::server {
namespace {

// gRPC shuts down with the last server of a process. After large answers this may wait 10 s for one
// of gRPC's pollers. The reference that grpc_init takes here keeps gRPC open.
[[maybe_unused]] const bool kGrpcStaysOpen = [] {
  grpc_init();
  return true;
}();

// The data are in `folder` if the options name no data folder.
absl::StatusOr<std::unique_ptr<BallpistonServer>> Start(const TestServerOptions& options,
                                                        const TemporaryFolder& folder) {
  ServerOptions all;
  all.data_dir = options.data_dir.empty() ? folder.path() : options.data_dir;
  all.listen = options.listen;
  all.door = options.door;
  all.door.own_tokens = all.data_dir + "/tokens";
  all.workers = options.workers;
  if (options.factory) all.opener = std::make_shared<FactoryOpener>(options.factory);
  all.watch = options.watch;
  all.limits = options.limits;
  all.metrics_listen = options.metrics_listen;
  all.cluster = options.cluster;
  all.store = options.store;
  return BallpistonServer::Start(all);
}

}  // namespace

RunningServer::RunningServer(const TestServerOptions& options) : TestClient(nullptr) {
  auto started = Start(options, folder_);
  EXPECT_OK(started);
  process_ = std::move(started).value();
  channel_ = OwnChannel(address(), options.credentials);
}

absl::Status StartError(const TestServerOptions& options) {
  return Start(options, TemporaryFolder()).status();
}

}  // namespace ballpiston::server

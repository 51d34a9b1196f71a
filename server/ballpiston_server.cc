#include "server/ballpiston_server.h"

#include <algorithm>
#include <limits>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "grpc/grpc.h"
#include "grpcpp/ext/proto_server_reflection_plugin.h"
#include "grpcpp/health_check_service_interface.h"
#include "grpcpp/resource_quota.h"
#include "grpcpp/server_builder.h"
#include "server/convert/errors.h"
#include "server/rpc/builtin_streams.h"
#include "server/rpc/server_status.h"
#include "server/status/failpoint.h"
#include "server/status/log.h"
#include "server/store/job_name.h"

namespace ballpiston::server {
namespace {

constexpr int kHandshakeTimeoutMs = 20'000;
constexpr int kPingIntervalMs = 60'000;       // silence before the server sends a ping
constexpr int kPingTimeoutMs = 20'000;        // limit for the client's answer
constexpr int kMinPingIntervalMs = 15'000;    // of a client's pings
constexpr int kStreamsPerConnection = 2'048;  // twice what one principal may watch
// Threads for calls that are not streams. One principal can take at most 128 of them with answers
// that it does not read (rpc/quota.h).
constexpr int kOtherThreads = 4'096;
constexpr size_t kTransferBytes = size_t{512} << 20;  // connections, and requests that arrive
constexpr std::chrono::milliseconds kLimitsInterval(1000);
// The longest delay until health reports that the store fails, until a revoked watch ends, and, at
// a stop without calls of the API in progress, until all connections end.
constexpr std::chrono::milliseconds kHealthInterval(200);
constexpr std::chrono::milliseconds kLateCalls(100);  // may still arrive when a stop begins

// Seconds of one core of a lease of the threads. Without a cluster they take all chunks of a point
// at once, which keeps their lanes full.
constexpr double kWholePoint = std::numeric_limits<double>::infinity();
constexpr double kLeaseBesideACluster = 60;

SchedulerOptions OptionsOfScheduler(const ServerOptions& options) {
  SchedulerOptions scheduler;
  if (options.cluster) {
    scheduler.least_seconds_elsewhere =
        std::chrono::duration<double>(options.cluster->least_work).count();
  }
  if (options.limits.max_memory_mib > 0) {
    scheduler.memory_limit = static_cast<double>(options.limits.max_memory_mib) * (1 << 20);
  }
  return scheduler;
}

// The services of the API; the first needs the store.
std::vector<std::string> ServiceNames() {
  return {v1::EnsembleService::service_full_name(), v1::AnalyticService::service_full_name(),
          v1::TraceService::service_full_name(), v1::ServerService::service_full_name()};
}

// The server closes a connection, with its streams, if the client does not answer.
void SetPings(grpc::ServerBuilder& builder) {
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeTimeoutMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kPingIntervalMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kPingTimeoutMs);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);  // no limit
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS,
                             kMinPingIntervalMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
}

// Bounds what clients can use before they are authenticated: streams, memory and threads. Each call
// has a thread. The quota has more than there can be streams, so other calls find a thread. gRPC
// itself refuses requests of more than 4 MiB, but it compares the size before it decompresses. So
// compressed requests are refused.
void SetBounds(grpc::ServerBuilder& builder, const Limits& limits) {
  using Option = grpc::ServerBuilder::SyncServerOption;
  grpc::ResourceQuota quota("ballpiston");
  quota.Resize(kTransferBytes);
  quota.SetMaxThreads(static_cast<int>(MostStreams(limits)) + kOtherThreads);
  builder.SetResourceQuota(quota);
  // One queue, and at most two idle threads that wait for calls. By default gRPC has a queue for
  // each core.
  builder.SetSyncServerOption(Option::NUM_CQS, 1);
  builder.SetSyncServerOption(Option::MIN_POLLERS, 1);
  builder.SetSyncServerOption(Option::MAX_POLLERS, 2);
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);  // no other server shares the port
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kStreamsPerConnection);
  builder.SetCompressionAlgorithmSupportStatus(GRPC_COMPRESS_DEFLATE, false);
  builder.SetCompressionAlgorithmSupportStatus(GRPC_COMPRESS_GZIP, false);
}

absl::StatusOr<ListenAddress> ParseMetricsAddress(const std::string& text) {
  absl::StatusOr<ListenAddress> address = ParseListenAddress(text);
  if (address.ok() && address->IsLoopback()) return address;
  return absl::InvalidArgumentError(absl::StrCat(
      "--metrics-listen=", text,
      " is not a loopback address; permitted: HOST:PORT with the HOST 127.0.0.1, [::1] or "
      "localhost (metrics are not encrypted; let others reach them through a proxy or a tunnel)"));
}

absl::StatusOr<std::unique_ptr<OrbitsOnDevice>> OpenDevice(const ServerOptions& options) {
  if (options.device == kProcessor) return nullptr;
  absl::StatusOr<std::unique_ptr<FlightDevice>> device = OpenCuda();
  if (!device.ok()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "--device=", options.device, ": ", device.status().message(), "; permitted here: cpu"));
  }
  LogInfo(absl::StrCat("flights are computed by ", (*device)->name()));
  return std::make_unique<OrbitsOnDevice>(
      *std::move(device), static_cast<size_t>(options.workers), [](const absl::Status& failure) {
        LogError(absl::StrCat("the GPU fails, and the processor computes until the next start (",
                              failure.message(), ")"));
      });
}

// Names the server on its cluster. A copy of the store, restored elsewhere, is another server.
std::string IdentityOf(const Store& store, const DataDirectory& directory) {
  return absl::StrCat(store.identity(), "-", directory.Inode());
}

absl::Status CannotListen(const ListenAddress& address) {
  return absl::UnavailableError(absl::StrCat(
      "--listen=", address.Text(),
      ": the address is in use, not permitted, or not of this machine; choose another address, "
      "unix:PATH or HOST:PORT"));
}

}  // namespace

absl::StatusOr<std::unique_ptr<BallpistonServer>> BallpistonServer::Start(ServerOptions options) {
  ShuttingDown().IgnoreError();  // builds descriptors that an error may have no memory for
  absl::StatusOr<DataDirectory> directory = DataDirectory::Open(options.data_dir);
  if (!directory.ok()) return directory.status();
  if (options.listen.empty()) {
    options.listen = absl::StrCat("unix:", directory->FilePath("server.socket"));
  }
  const absl::StatusOr<ListenAddress> address = ParseListenAddress(options.listen);
  if (!address.ok()) return address.status();
  auto door = Door::Create(options.door, *address);
  if (!door.ok()) return door.status();
  auto device = OpenDevice(options);
  if (!device.ok()) return device.status();
  absl::StatusOr<std::unique_ptr<Store>> store =
      Store::Open(directory->FilePath(kStoreFile), options.store);
  if (!store.ok()) return store.status();
  try {
    std::unique_ptr<BallpistonServer> server(
        new BallpistonServer(std::move(options), *std::move(directory), *address, *std::move(door),
                             *std::move(device), *std::move(store)));
    absl::Status status = server->book_.Resume();
    if (status.ok()) status = server->StartMetrics();
    if (status.ok()) status = server->Listen();
    if (!status.ok()) return status;
    server->StartThreads();  // a server that cannot listen does not touch the cluster's leases
    return server;
  } catch (const std::system_error& error) {
    return absl::InvalidArgumentError(absl::StrCat("the system cannot start more threads (",
                                                   error.what(), "); choose fewer with --workers"));
  }
}

BallpistonServer::BallpistonServer(ServerOptions options, DataDirectory directory,
                                   ListenAddress address, std::unique_ptr<Door> door,
                                   std::unique_ptr<OrbitsOnDevice> device,
                                   std::unique_ptr<Store> store)
    : options_(std::move(options)),
      directory_(std::move(directory)),
      address_(std::move(address)),
      door_(std::move(door)),
      store_(std::move(store)),
      crashes_(std::make_shared<CrashRecord>(directory_.path())),
      ladder_(options_.workers, OptionsOfScheduler(options_).memory_limit),
      scheduler_(options_.opener ? *options_.opener : static_cast<PointOpener&>(ladder_),
                 options_.workers, OptionsOfScheduler(options_)),
      book_(*store_, options_.limits, scheduler_, crashes_),
      device_(std::move(device)),
      threads_(scheduler_, options_.workers, options_.cluster ? kLeaseBesideACluster : kWholePoint,
               crashes_, device_.get()),
      cluster_(options_.cluster
                   ? std::make_unique<Cluster>(scheduler_, *options_.cluster, options_.slurm,
                                               IdentityOf(*store_, directory_),
                                               [this] { return store_->Flush(); })
                   : nullptr),
      quotas_(options_.limits),
      streams_(door_->authenticator(), options_.watch.heartbeat, draining_),
      context_{door_->authenticator(),
               options_.limits,
               book_,
               scheduler_,
               threads_,
               device_.get(),
               cluster_.get(),
               ladder_,
               quotas_,
               streams_,
               draining_,
               RandomId(),
               options_.watch,
               *store_,
               calls_,
               absl::Now(),
               directory_.FilePath(kStoreFile)},
      ensemble_(context_),
      analytic_(context_),
      trace_(context_),
      server_(context_) {}

void BallpistonServer::StartThreads() {
  if (cluster_ != nullptr) cluster_->Start();
  threads_.Start();
  limits_ =
      std::make_unique<PeriodicThread>(kLimitsInterval, [this] { book_.KeepLimits(absl::Now()); });
}

BallpistonServer::~BallpistonServer() { Shutdown(std::chrono::milliseconds(0)); }

absl::Status BallpistonServer::Listen() {
  const bool is_socket = !address_.socket_path.empty();
  const absl::Status free = is_socket ? CheckSocketIsFree(address_) : absl::OkStatus();
  if (!free.ok()) return free;
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  SetPings(builder);
  SetBounds(builder, options_.limits);
  builder.RegisterService(&ensemble_);
  builder.RegisterService(&analytic_);
  builder.RegisterService(&trace_);
  builder.RegisterService(&server_);
  std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> interceptors;
  interceptors.push_back(calls_.InterceptorFactory());
  interceptors.push_back(std::make_unique<BuiltinStreams>(door_->authenticator()));
  builder.experimental().SetInterceptorCreators(std::move(interceptors));
  int port = 0;
  builder.AddListeningPort(address_.Text(), door_->Credentials(), &port);
  grpc_ = builder.BuildAndStart();
  if (grpc_ == nullptr || port == 0) return CannotListen(address_);
  if (!is_socket) address_.port = port;
  door_->PublishOwnToken(address_);
  StartHealth();
  directory_.TellAddress(address());
  return absl::OkStatus();
}

void BallpistonServer::StartHealth() {
  grpc::HealthCheckServiceInterface* const health = grpc_->GetHealthCheckService();
  for (const std::string& name : ServiceNames()) health->SetServingStatus(name, true);
  looking_ =
      std::make_unique<PeriodicThread>(kHealthInterval, [this, health, served = true]() mutable {
        streams_.EndRevoked();
        // gRPC would also wait for health watches and for clients that do nothing.
        const bool is_quiet = stopping_ && calls_.activity().IdleFor() >= kLateCalls;
        if (is_quiet) grpc_server_cancel_all_calls(grpc_->c_server());
        const bool serves = !store_->failing() && !store_->stalled();
        if (std::exchange(served, serves) == serves) return;
        health->SetServingStatus(ServiceNames().front(), serves);
      });
}

absl::Status BallpistonServer::StartMetrics() {
  if (options_.metrics_listen.empty()) return absl::OkStatus();
  const absl::StatusOr<ListenAddress> address = ParseMetricsAddress(options_.metrics_listen);
  if (!address.ok()) return address.status();
  auto endpoint = MetricsEndpoint::Start(address->Text(), [this] {
    auto metrics = ServerMetrics(context_, door_->CertificateExpiry());
    for (auto& family : calls_.metrics().Collect()) metrics.push_back(std::move(family));
    return metrics;
  });
  if (endpoint.ok()) metrics_ = *std::move(endpoint);
  return endpoint.status();
}

std::chrono::steady_clock::duration BallpistonServer::IdleFor() {
  if (book_.active_jobs() == 0) return calls_.activity().IdleFor();
  calls_.activity().Touch();
  return std::chrono::steady_clock::duration::zero();
}

void BallpistonServer::Shutdown(std::chrono::milliseconds drain) {
  if (std::exchange(shut_down_, true)) return;
  const auto deadline = std::chrono::system_clock::now() + drain;
  if (grpc_ != nullptr) grpc_->GetHealthCheckService()->Shutdown();
  draining_ = true;
  book_.Shutdown();
  limits_.reset();
  Failpoint("stop.before_flush");
  store_->Flush().IgnoreError();
  calls_.activity().Touch();
  stopping_ = true;
  if (grpc_ != nullptr) grpc_->Shutdown(deadline);
  door_->Close();
  if (metrics_ != nullptr) metrics_->Detach();
  cluster_.reset();
  store_->Close();
}

}  // namespace ballpiston::server

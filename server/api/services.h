// The gRPC services: each unary method runs its function of methods.h inside the frame of
// unary_rpc.h; the streams have reactors of their own.
#pragma once

#include "ballpiston/v1/analytic.grpc.pb.h"
#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "ballpiston/v1/server.grpc.pb.h"
#include "ballpiston/v1/trace.grpc.pb.h"
#include "server/api/methods.h"
#include "server/api/service_context.h"
#include "server/api/unary_rpc.h"

namespace ballpiston::server {

#define BALLPISTON_SERVE(name, Request, Response, role, writes)                                \
  grpc::ServerUnaryReactor* name(grpc::CallbackServerContext* context, const Request* request, \
                                 Response* response) override {                                \
    return RunUnary<Request, Response>(service_, context, {#name, role, writes}, request,      \
                                       response, &server::name);                               \
  }

// `service` must outlive all services.
class EnsembleService : public v1::EnsembleService::CallbackService {
 public:
  explicit EnsembleService(ServiceContext& service) : service_(service) {}

  BALLPISTON_ENSEMBLE_METHODS(BALLPISTON_SERVE)
  grpc::ServerWriteReactor<v1::WatchEnsembleJobResponse>* WatchEnsembleJob(
      grpc::CallbackServerContext* context, const v1::WatchEnsembleJobRequest* request) override;

 private:
  ServiceContext& service_;
};

class AnalyticService : public v1::AnalyticService::CallbackService {
 public:
  explicit AnalyticService(ServiceContext& service) : service_(service) {}

  BALLPISTON_ANALYTIC_METHODS(BALLPISTON_SERVE)

 private:
  ServiceContext& service_;
};

class TraceService : public v1::TraceService::CallbackService {
 public:
  explicit TraceService(ServiceContext& service) : service_(service) {}

  grpc::ServerWriteReactor<v1::TraceOrbitResponse>* TraceOrbit(
      grpc::CallbackServerContext* context, const v1::TraceOrbitRequest* request) override;

 private:
  ServiceContext& service_;
};

class ServerService : public v1::ServerService::CallbackService {
 public:
  explicit ServerService(ServiceContext& service) : service_(service) {}

  BALLPISTON_SERVER_METHODS(BALLPISTON_SERVE)

 private:
  ServiceContext& service_;
};

#undef BALLPISTON_SERVE

}  // namespace ballpiston::server

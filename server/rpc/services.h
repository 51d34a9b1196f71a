// The gRPC services: each method runs its function of methods.h in a frame of call.h.
#pragma once

#include "ballpiston/v1/analytic.grpc.pb.h"
#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "ballpiston/v1/server.grpc.pb.h"
#include "ballpiston/v1/trace.grpc.pb.h"
#include "server/rpc/call.h"
#include "server/rpc/methods.h"
#include "server/rpc/service_context.h"

namespace ballpiston::server {

#define BALLPISTON_SERVE(name, Request, Response, role, writes)                               \
  grpc::Status name(grpc::ServerContext* context, const Request* request, Response* response) \
      override {                                                                              \
    return ServeUnary<Request, Response>(service_, *context, {#name, role, writes}, *request, \
                                         *response, &server::name);                           \
  }

#define BALLPISTON_SERVE_STREAM(name, Request, Response, role)                  \
  grpc::Status name(grpc::ServerContext* context, const Request* request,       \
                    grpc::ServerWriter<Response>* writer) override {            \
    return ServeStream(service_, *context, {#name, role}, [&](Stream& stream) { \
      return server::name(service_, stream, *request, *writer);                 \
    });                                                                         \
  }

// `service` must outlive all services.
template <typename Service>
class ServiceOf : public Service {
 public:
  explicit ServiceOf(ServiceContext& service) : service_(service) {}

 protected:
  ServiceContext& service_;
};

class EnsembleService : public ServiceOf<v1::EnsembleService::Service> {
 public:
  using ServiceOf::ServiceOf;
  BALLPISTON_ENSEMBLE_METHODS(BALLPISTON_SERVE)
  BALLPISTON_ENSEMBLE_STREAMS(BALLPISTON_SERVE_STREAM)
};

class AnalyticService : public ServiceOf<v1::AnalyticService::Service> {
 public:
  using ServiceOf::ServiceOf;
  BALLPISTON_ANALYTIC_METHODS(BALLPISTON_SERVE)
};

class TraceService : public ServiceOf<v1::TraceService::Service> {
 public:
  using ServiceOf::ServiceOf;
  BALLPISTON_TRACE_STREAMS(BALLPISTON_SERVE_STREAM)
};

class ServerService : public ServiceOf<v1::ServerService::Service> {
 public:
  using ServiceOf::ServiceOf;
  BALLPISTON_SERVER_METHODS(BALLPISTON_SERVE)
};

#undef BALLPISTON_SERVE
#undef BALLPISTON_SERVE_STREAM

}  // namespace ballpiston::server

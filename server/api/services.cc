#include "server/api/services.h"

#include "server/api/trace_orbit.h"
#include "server/api/watch_ensemble_job.h"

namespace ballpiston::server {

grpc::ServerWriteReactor<v1::WatchEnsembleJobResponse>* EnsembleService::WatchEnsembleJob(
    grpc::CallbackServerContext* context, const v1::WatchEnsembleJobRequest* request) {
  return WatchReactor::Start(service_, *context,
                             AdmitCall(service_, *context, {"WatchEnsembleJob", Role::kRead}),
                             *request);
}

grpc::ServerWriteReactor<v1::TraceOrbitResponse>* TraceService::TraceOrbit(
    grpc::CallbackServerContext* context, const v1::TraceOrbitRequest* request) {
  return TraceReactor::Start(
      service_, *context, AdmitCall(service_, *context, {"TraceOrbit", Role::kSubmit}), *request);
}

}  // namespace ballpiston::server

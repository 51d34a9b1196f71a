#include "server/api/services.h"

#include "server/api/methods.h"
#include "server/api/trace_orbit.h"
#include "server/api/unary_rpc.h"
#include "server/api/watch_ensemble_job.h"

namespace ballpiston::server {

using Context = grpc::CallbackServerContext;
using Unary = grpc::ServerUnaryReactor;

Unary* EnsembleService::CreateEnsembleJob(Context* context,
                                          const v1::CreateEnsembleJobRequest* request,
                                          v1::EnsembleJob* response) {
  return RunUnary(service_, context, {"CreateEnsembleJob", Role::kSubmit, true}, request, response,
                  &server::CreateEnsembleJob);
}

Unary* EnsembleService::GetEnsembleJob(Context* context, const v1::GetEnsembleJobRequest* request,
                                       v1::EnsembleJob* response) {
  return RunUnary(service_, context, {"GetEnsembleJob", Role::kRead}, request, response,
                  &server::GetEnsembleJob);
}

Unary* EnsembleService::ListEnsembleJobs(Context* context,
                                         const v1::ListEnsembleJobsRequest* request,
                                         v1::ListEnsembleJobsResponse* response) {
  return RunUnary(service_, context, {"ListEnsembleJobs", Role::kRead}, request, response,
                  &server::ListEnsembleJobs);
}

Unary* EnsembleService::CancelEnsembleJob(Context* context,
                                          const v1::CancelEnsembleJobRequest* request,
                                          v1::EnsembleJob* response) {
  return RunUnary(service_, context, {"CancelEnsembleJob", Role::kSubmit, true}, request, response,
                  &server::CancelEnsembleJob);
}

Unary* EnsembleService::PinEnsembleJob(Context* context, const v1::PinEnsembleJobRequest* request,
                                       v1::EnsembleJob* response) {
  return RunUnary(service_, context, {"PinEnsembleJob", Role::kSubmit, true}, request, response,
                  &server::PinEnsembleJob);
}

Unary* EnsembleService::DeleteEnsembleJob(Context* context,
                                          const v1::DeleteEnsembleJobRequest* request,
                                          google::protobuf::Empty* response) {
  return RunUnary(service_, context, {"DeleteEnsembleJob", Role::kSubmit, true}, request, response,
                  &server::DeleteEnsembleJob);
}

grpc::ServerWriteReactor<v1::WatchEnsembleJobResponse>* EnsembleService::WatchEnsembleJob(
    Context* context, const v1::WatchEnsembleJobRequest* request) {
  return WatchReactor::Start(service_, *context,
                             AdmitCall(service_, *context, {"WatchEnsembleJob", Role::kRead}),
                             *request);
}

Unary* EnsembleService::PlanEnsembleJob(Context* context, const v1::PlanEnsembleJobRequest* request,
                                        v1::PlanEnsembleJobResponse* response) {
  return RunUnary(service_, context, {"PlanEnsembleJob", Role::kRead}, request, response,
                  &server::PlanEnsembleJob);
}

Unary* EnsembleService::ListResults(Context* context, const v1::ListResultsRequest* request,
                                    v1::ListResultsResponse* response) {
  return RunUnary(service_, context, {"ListResults", Role::kRead}, request, response,
                  &server::ListResults);
}

Unary* EnsembleService::GetResult(Context* context, const v1::GetResultRequest* request,
                                  v1::PointResult* response) {
  return RunUnary(service_, context, {"GetResult", Role::kRead}, request, response,
                  &server::GetResult);
}

Unary* AnalyticService::EvaluatePairs(Context* context, const v1::EvaluatePairsRequest* request,
                                      v1::EvaluatePairsResponse* response) {
  return RunUnary<v1::EvaluatePairsRequest, v1::EvaluatePairsResponse>(
      service_, context, {"EvaluatePairs", Role::kRead}, request, response, &server::EvaluatePairs);
}

grpc::ServerWriteReactor<v1::TraceOrbitResponse>* TraceService::TraceOrbit(
    Context* context, const v1::TraceOrbitRequest* request) {
  return TraceReactor::Start(
      service_, *context, AdmitCall(service_, *context, {"TraceOrbit", Role::kSubmit}), *request);
}

Unary* ServerService::GetServerStatus(Context* context, const v1::GetServerStatusRequest* request,
                                      v1::ServerStatus* response) {
  return RunUnary(service_, context, {"GetServerStatus", Role::kRead}, request, response,
                  &server::GetServerStatus);
}

}  // namespace ballpiston::server

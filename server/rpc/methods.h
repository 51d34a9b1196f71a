// The methods of the API, one row each. A row declares the function that executes the method, and
// the method of its service. To add a method: its proto, a row, a function. The protos have the
// contracts and errors.
#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "ballpiston/v1/analytic.pb.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/server.pb.h"
#include "ballpiston/v1/trace.pb.h"
#include "google/protobuf/empty.pb.h"
#include "grpcpp/support/sync_stream.h"
#include "server/rpc/call.h"
#include "server/rpc/service_context.h"

// METHOD(name, request, response, least role, whether it waits for the disk)
#define BALLPISTON_ENSEMBLE_METHODS(METHOD)                                                        \
  METHOD(CreateEnsembleJob, v1::CreateEnsembleJobRequest, v1::EnsembleJob, Role::kSubmit, true)    \
  METHOD(GetEnsembleJob, v1::GetEnsembleJobRequest, v1::EnsembleJob, Role::kRead, false)           \
  METHOD(ListEnsembleJobs, v1::ListEnsembleJobsRequest, v1::ListEnsembleJobsResponse, Role::kRead, \
         false)                                                                                    \
  METHOD(CancelEnsembleJob, v1::CancelEnsembleJobRequest, v1::EnsembleJob, Role::kSubmit, true)    \
  METHOD(UpdateEnsembleJob, v1::UpdateEnsembleJobRequest, v1::EnsembleJob, Role::kSubmit, true)    \
  METHOD(DeleteEnsembleJob, v1::DeleteEnsembleJobRequest, google::protobuf::Empty, Role::kSubmit,  \
         true)                                                                                     \
  METHOD(PlanEnsembleJob, v1::PlanEnsembleJobRequest, v1::PlanEnsembleJobResponse, Role::kRead,    \
         false)                                                                                    \
  METHOD(ListResults, v1::ListResultsRequest, v1::ListResultsResponse, Role::kRead, false)         \
  METHOD(GetResult, v1::GetResultRequest, v1::PointResult, Role::kRead, false)

#define BALLPISTON_ANALYTIC_METHODS(METHOD) \
  METHOD(EvaluatePairs, v1::EvaluatePairsRequest, v1::EvaluatePairsResponse, Role::kRead, false)

#define BALLPISTON_SERVER_METHODS(METHOD) \
  METHOD(GetServerStatus, v1::GetServerStatusRequest, v1::ServerStatus, Role::kRead, false)

// STREAM(name, request, message, least role)
#define BALLPISTON_ENSEMBLE_STREAMS(STREAM) \
  STREAM(WatchEnsembleJob, v1::WatchEnsembleJobRequest, v1::WatchEnsembleJobResponse, Role::kRead)

#define BALLPISTON_TRACE_STREAMS(STREAM)                                           \
  STREAM(TraceOrbit, v1::TraceOrbitRequest, v1::TraceOrbitResponse, Role::kSubmit) \
  STREAM(SampleCollisions, v1::SampleCollisionsRequest, v1::SampleCollisionsResponse, Role::kSubmit)

namespace ballpiston::server {

#define BALLPISTON_DECLARE(name, Request, Response, role, writes) \
  absl::StatusOr<Response> name(ServiceContext& service, const Call& call, const Request& request);
BALLPISTON_ENSEMBLE_METHODS(BALLPISTON_DECLARE)
BALLPISTON_ANALYTIC_METHODS(BALLPISTON_DECLARE)
BALLPISTON_SERVER_METHODS(BALLPISTON_DECLARE)
#undef BALLPISTON_DECLARE

#define BALLPISTON_DECLARE_STREAM(name, Request, Message, role)                      \
  absl::Status name(ServiceContext& service, Stream& stream, const Request& request, \
                    grpc::ServerWriter<Message>& writer);
BALLPISTON_ENSEMBLE_STREAMS(BALLPISTON_DECLARE_STREAM)
BALLPISTON_TRACE_STREAMS(BALLPISTON_DECLARE_STREAM)
#undef BALLPISTON_DECLARE_STREAM

}  // namespace ballpiston::server

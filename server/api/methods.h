// The unary methods of the API, one file each. The protos have their contracts and errors.
#ifndef BALLPISTON_SERVER_API_METHODS_H_
#define BALLPISTON_SERVER_API_METHODS_H_

#include "absl/status/statusor.h"
#include "ballpiston/v1/analytic.pb.h"
#include "ballpiston/v1/ensemble.pb.h"
#include "ballpiston/v1/server.pb.h"
#include "google/protobuf/empty.pb.h"
#include "server/api/call.h"
#include "server/api/service_context.h"

namespace ballpiston::server {

absl::StatusOr<v1::EnsembleJob> CreateEnsembleJob(ServiceContext& service, const Call& call,
                                                  const v1::CreateEnsembleJobRequest& request);
absl::StatusOr<v1::EnsembleJob> GetEnsembleJob(ServiceContext& service, const Call& call,
                                               const v1::GetEnsembleJobRequest& request);
absl::StatusOr<v1::ListEnsembleJobsResponse> ListEnsembleJobs(
    ServiceContext& service, const Call& call, const v1::ListEnsembleJobsRequest& request);
absl::StatusOr<v1::EnsembleJob> CancelEnsembleJob(ServiceContext& service, const Call& call,
                                                  const v1::CancelEnsembleJobRequest& request);
absl::StatusOr<v1::EnsembleJob> PinEnsembleJob(ServiceContext& service, const Call& call,
                                               const v1::PinEnsembleJobRequest& request);
absl::StatusOr<google::protobuf::Empty> DeleteEnsembleJob(
    ServiceContext& service, const Call& call, const v1::DeleteEnsembleJobRequest& request);
absl::StatusOr<v1::ListResultsResponse> ListResults(ServiceContext& service, const Call& call,
                                                    const v1::ListResultsRequest& request);
absl::StatusOr<v1::PointResult> GetResult(ServiceContext& service, const Call& call,
                                          const v1::GetResultRequest& request);

absl::StatusOr<v1::PlanEnsembleJobResponse> PlanEnsembleJob(
    ServiceContext& service, const Call& call, const v1::PlanEnsembleJobRequest& request);

absl::StatusOr<v1::EvaluatePairsResponse> EvaluatePairs(ServiceContext& service, const Call& call,
                                                        const v1::EvaluatePairsRequest& request);

absl::StatusOr<v1::ServerStatus> GetServerStatus(ServiceContext& service, const Call& call,
                                                 const v1::GetServerStatusRequest& request);

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_API_METHODS_H_

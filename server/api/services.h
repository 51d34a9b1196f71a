// The gRPC services: each unary method runs its function of methods.h inside the frame of
// unary_rpc.h; the streams have reactors of their own.
#ifndef BALLPISTON_SERVER_API_SERVICES_H_
#define BALLPISTON_SERVER_API_SERVICES_H_

#include "ballpiston/v1/analytic.grpc.pb.h"
#include "ballpiston/v1/ensemble.grpc.pb.h"
#include "ballpiston/v1/server.grpc.pb.h"
#include "ballpiston/v1/trace.grpc.pb.h"
#include "server/api/service_context.h"

namespace ballpiston::server {

// `service` must outlive all services.
class EnsembleService : public v1::EnsembleService::CallbackService {
 public:
  explicit EnsembleService(ServiceContext& service) : service_(service) {}

  grpc::ServerUnaryReactor* CreateEnsembleJob(grpc::CallbackServerContext* context,
                                              const v1::CreateEnsembleJobRequest* request,
                                              v1::EnsembleJob* response) override;
  grpc::ServerUnaryReactor* GetEnsembleJob(grpc::CallbackServerContext* context,
                                           const v1::GetEnsembleJobRequest* request,
                                           v1::EnsembleJob* response) override;
  grpc::ServerUnaryReactor* ListEnsembleJobs(grpc::CallbackServerContext* context,
                                             const v1::ListEnsembleJobsRequest* request,
                                             v1::ListEnsembleJobsResponse* response) override;
  grpc::ServerUnaryReactor* CancelEnsembleJob(grpc::CallbackServerContext* context,
                                              const v1::CancelEnsembleJobRequest* request,
                                              v1::EnsembleJob* response) override;
  grpc::ServerUnaryReactor* PinEnsembleJob(grpc::CallbackServerContext* context,
                                           const v1::PinEnsembleJobRequest* request,
                                           v1::EnsembleJob* response) override;
  grpc::ServerUnaryReactor* DeleteEnsembleJob(grpc::CallbackServerContext* context,
                                              const v1::DeleteEnsembleJobRequest* request,
                                              google::protobuf::Empty* response) override;
  grpc::ServerWriteReactor<v1::WatchEnsembleJobResponse>* WatchEnsembleJob(
      grpc::CallbackServerContext* context, const v1::WatchEnsembleJobRequest* request) override;
  grpc::ServerUnaryReactor* PlanEnsembleJob(grpc::CallbackServerContext* context,
                                            const v1::PlanEnsembleJobRequest* request,
                                            v1::PlanEnsembleJobResponse* response) override;
  grpc::ServerUnaryReactor* ListResults(grpc::CallbackServerContext* context,
                                        const v1::ListResultsRequest* request,
                                        v1::ListResultsResponse* response) override;
  grpc::ServerUnaryReactor* GetResult(grpc::CallbackServerContext* context,
                                      const v1::GetResultRequest* request,
                                      v1::PointResult* response) override;

 private:
  ServiceContext& service_;
};

class AnalyticService : public v1::AnalyticService::CallbackService {
 public:
  explicit AnalyticService(ServiceContext& service) : service_(service) {}

  grpc::ServerUnaryReactor* EvaluatePairs(grpc::CallbackServerContext* context,
                                          const v1::EvaluatePairsRequest* request,
                                          v1::EvaluatePairsResponse* response) override;

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

  grpc::ServerUnaryReactor* GetServerStatus(grpc::CallbackServerContext* context,
                                            const v1::GetServerStatusRequest* request,
                                            v1::ServerStatus* response) override;

 private:
  ServiceContext& service_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_API_SERVICES_H_

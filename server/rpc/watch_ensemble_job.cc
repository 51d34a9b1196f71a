// WatchEnsembleJob: a watch (watch.h) over a stream of gRPC.
#include "server/rpc/methods.h"
#include "server/rpc/watch.h"

namespace ballpiston::server {
namespace {

class StreamReader : public WatchReader {
 public:
  StreamReader(const Quota& streams, Stream& stream,
               grpc::ServerWriter<v1::WatchEnsembleJobResponse>& writer)
      : streams_(streams), stream_(stream), writer_(writer) {}

  const Principal& caller() const override { return stream_.caller(); }
  absl::Status Proceed() override { return stream_.Proceed(); }
  Stream::Clock::time_point next_check() const override { return stream_.next_check(); }
  int64_t watches() const override { return streams_.taken(); }
  bool Write(const v1::WatchEnsembleJobResponse& message) override {
    return writer_.Write(message);
  }

 private:
  const Quota& streams_;
  Stream& stream_;
  grpc::ServerWriter<v1::WatchEnsembleJobResponse>& writer_;
};

}  // namespace

absl::Status WatchEnsembleJob(ServiceContext& service, Stream& stream,
                              const v1::WatchEnsembleJobRequest& request,
                              grpc::ServerWriter<v1::WatchEnsembleJobResponse>& writer) {
  StreamReader reader(service.quotas.streams, stream, writer);
  return RunWatch(service.book, service.timing, service.instance, request, reader);
}

}  // namespace ballpiston::server

// A race on purpose: a method of a service, on gRPC's thread, and a worker change the same
// variable. gRPC is not instrumented. The code that prevents false reports about gRPC
// (grpc_handover.cc) must not hide this race.
//
//   seeded_race             the sanitizer must report the race
//   seeded_race --mended    the same with a lock: the sanitizer must report nothing
#include <atomic>
#include <mutex>
#include <string_view>
#include <thread>

#include "ballpiston/v1/analytic.grpc.pb.h"
#include "grpcpp/client_context.h"
#include "grpcpp/server.h"
#include "grpcpp/server_builder.h"

namespace ballpiston {
namespace {

constexpr int kCalls = 20;

class Counter {
 public:
  explicit Counter(bool mended) : mended_(mended) {}

  void CountOne() {
    std::unique_lock lock(mutex_, std::defer_lock);
    if (mended_) lock.lock();
    ++count_;
  }

 private:
  const bool mended_;
  std::mutex mutex_;
  long count_ = 0;
};

class CountingService : public v1::AnalyticService::Service {
 public:
  explicit CountingService(Counter& counter) : counter_(counter) {}

  grpc::Status EvaluatePairs(grpc::ServerContext*, const v1::EvaluatePairsRequest*,
                             v1::EvaluatePairsResponse*) override {
    counter_.CountOne();
    return grpc::Status::OK;
  }

 private:
  Counter& counter_;
};

bool CallWhileCounting(Counter& counter) {
  CountingService service(counter);
  grpc::ServerBuilder builder;
  builder.RegisterService(&service);
  const auto server = builder.BuildAndStart();
  const auto stub = v1::AnalyticService::NewStub(server->InProcessChannel({}));
  // The worker uses no lock, because a lock would order its counts before the calls.
  std::atomic<bool> began = false, done = false;
  std::thread worker([&] {
    while (!done.load(std::memory_order_relaxed)) {
      counter.CountOne();
      began.store(true, std::memory_order_relaxed);
    }
  });
  while (!began.load(std::memory_order_relaxed)) std::this_thread::yield();
  bool all_ok = true;
  for (int i = 0; i < kCalls; ++i) {
    grpc::ClientContext context;
    v1::EvaluatePairsResponse response;
    all_ok &= stub->EvaluatePairs(&context, {}, &response).ok();
  }
  done.store(true, std::memory_order_relaxed);
  worker.join();
  return all_ok;
}

}  // namespace
}  // namespace ballpiston

int main(int argc, char** argv) {
  ballpiston::Counter counter(argc > 1 && std::string_view(argv[1]) == "--mended");
  return ballpiston::CallWhileCounting(counter) ? 0 : 1;
}

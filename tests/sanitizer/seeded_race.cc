// A race on purpose: a method of a service, on gRPC's thread, and a worker change the same
// variable. gRPC is not instrumented. The code that prevents false reports about gRPC
// (grpc_handover.cc) must not hide this race.
//
//   seeded_race             the sanitizer must report the race
//   seeded_race --mended    the same with a lock: the sanitizer must report nothing
#include <atomic>
#include <cstdio>
#include <memory>
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
    if (!mended_) {
      ++count_;
      return;
    }
    std::lock_guard lock(mutex_);
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

std::unique_ptr<grpc::Server> Serve(CountingService& service) {
  grpc::ServerBuilder builder;
  builder.RegisterService(&service);
  return builder.BuildAndStart();
}

// Uses no lock, because a lock would order the worker's counts before the calls.
class Worker {
 public:
  explicit Worker(Counter& counter) : counter_(counter), thread_([this] { Work(); }) {
    while (!began_.load(std::memory_order_relaxed)) std::this_thread::yield();
  }
  ~Worker() {
    done_.store(true, std::memory_order_relaxed);
    thread_.join();
  }

 private:
  void Work() {
    while (!done_.load(std::memory_order_relaxed)) {
      counter_.CountOne();
      began_.store(true, std::memory_order_relaxed);
    }
  }

  Counter& counter_;
  std::atomic<bool> began_ = false, done_ = false;
  std::thread thread_;
};

int CallWhileCounting(Counter& counter) {
  CountingService service(counter);
  const auto server = Serve(service);
  const auto stub = v1::AnalyticService::NewStub(server->InProcessChannel({}));
  const Worker worker(counter);
  for (int i = 0; i < kCalls; ++i) {
    grpc::ClientContext context;
    v1::EvaluatePairsResponse response;
    if (!stub->EvaluatePairs(&context, {}, &response).ok()) return 1;
  }
  std::printf("%d calls answered\n", kCalls);
  return 0;
}

}  // namespace
}  // namespace ballpiston

int main(int argc, char** argv) {
  ballpiston::Counter counter(argc > 1 && std::string_view(argv[1]) == "--mended");
  return ballpiston::CallWhileCounting(counter);
}

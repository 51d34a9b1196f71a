// The threads that answer calls, so that gRPC's own few are never kept waiting for the disk.
//
// Tasks begin in the order of posting. Thread-safe.
#ifndef BALLPISTON_SERVER_API_RPC_EXECUTOR_H_
#define BALLPISTON_SERVER_API_RPC_EXECUTOR_H_

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace ballpiston::server {

class RpcExecutor {
 public:
  explicit RpcExecutor(int threads);
  ~RpcExecutor();  // stops

  void Post(std::function<void()> task);

  // Runs what was posted, then ends the threads; later tasks are dropped.
  void Stop();

 private:
  void Work();

  std::mutex mutex_;
  std::condition_variable posted_;
  std::deque<std::function<void()>> tasks_;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_API_RPC_EXECUTOR_H_

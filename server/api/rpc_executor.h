// The threads that answer calls and those that make the messages of streams, so that gRPC's own few
// are never kept waiting for the disk.
//
// Each kind of task has threads of its own: a thousand watches do not keep a call waiting, nor
// calls that wait for the disk a watch. Tasks of a kind begin in the order of posting. Thread-safe.
#ifndef BALLPISTON_SERVER_API_RPC_EXECUTOR_H_
#define BALLPISTON_SERVER_API_RPC_EXECUTOR_H_

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace ballpiston::server {

class RpcExecutor {
 public:
  using Task = std::function<void()>;

  // So many threads for calls, and half as many for streams.
  explicit RpcExecutor(int threads);
  ~RpcExecutor();  // stops

  void Post(Task task) { calls_.Post(std::move(task)); }
  void PostOfStream(Task task) { streams_.Post(std::move(task)); }

  // Runs what was posted, then ends the threads; later tasks are dropped.
  void Stop();

 private:
  class Lane {
   public:
    explicit Lane(int threads);
    ~Lane() { Stop(); }

    void Post(Task task);
    void Stop();

   private:
    void Work();

    std::mutex mutex_;
    std::condition_variable posted_;
    std::deque<Task> tasks_;
    bool stopping_ = false;
    std::vector<std::thread> threads_;
  };

  Lane calls_;
  Lane streams_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_API_RPC_EXECUTOR_H_

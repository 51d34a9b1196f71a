// The threads that run calls and that make the messages of streams. gRPC's own few threads
// therefore never wait for the disk.
//
// There are three kinds of tasks: calls that read, calls that write, and messages of streams. Each
// kind has threads of its own, so no kind waits for another. Within a kind the principals take
// turns, whatever the number of their tasks. A principal has at most half of the threads of a kind,
// except of those that write. The tasks of one principal begin in the order of posting.
// Thread-safe.
#pragma once

#include <deque>
#include <functional>
#include <list>
#include <map>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/api/held_calls.h"
#include "server/mutex.h"

namespace ballpiston::server {

class RpcExecutor {
 public:
  using Task = std::function<void()>;

  // `threads` threads for calls that read, as many for calls that write, and half as many for
  // streams.
  explicit RpcExecutor(int threads);
  ~RpcExecutor();  // stops

  void Post(const std::string& principal, Task task) { reads_.Post(principal, std::move(task)); }
  // Posts a call that waits for the disk.
  void PostOfWrite(const std::string& principal, Task task) {
    writes_.Post(principal, std::move(task));
  }
  void PostOfStream(const std::string& principal, Task task) {
    streams_.Post(principal, std::move(task));
  }

  // The memory of posted calls, and of stream messages that wait for their readers.
  HeldCalls& held_calls() { return held_calls_; }
  HeldCalls& held_messages() { return held_messages_; }

  // Runs the posted tasks, then ends the threads. Drops later tasks.
  void Stop();

 private:
  class Lane {
   public:
    // A principal has at most `share` of the threads.
    Lane(int threads, int share);
    ~Lane() { Stop(); }

    void Post(const std::string& principal, Task task);
    void Stop();

   private:
    struct Queue {
      std::deque<Task> tasks;
      int running = 0;
    };
    using Queues = std::map<std::string, Queue>;

    void Work();
    bool IsDone() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
      return stopping_ && turns_.empty();
    }
    std::list<Queues::iterator>::iterator NextTurn() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
    Task Take(std::list<Queues::iterator>::iterator turn) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

    const int share_;
    Mutex mutex_;
    Condition changed_;
    Queues queues_ ABSL_GUARDED_BY(mutex_);  // of principals with tasks, waiting or running
    // Principals with waiting tasks. The first is the principal whose last turn was the longest
    // ago.
    std::list<Queues::iterator> turns_ ABSL_GUARDED_BY(mutex_);
    bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
    std::vector<std::thread> threads_ ABSL_GUARDED_BY(mutex_);
  };

  HeldCalls held_calls_;
  HeldCalls held_messages_;
  Lane reads_;
  Lane writes_;
  Lane streams_;
};

}  // namespace ballpiston::server

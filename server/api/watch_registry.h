// All open watches, and the one thread that looks after them.
//
// It looks at each watch a few times a second, and at once when a job changes its state, and asks
// those that have something to tell to do so. Thread-safe.
#ifndef BALLPISTON_SERVER_API_WATCH_REGISTRY_H_
#define BALLPISTON_SERVER_API_WATCH_REGISTRY_H_

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <set>
#include <thread>

namespace ballpiston::server {

class Watch {
 public:
  virtual ~Watch() = default;
  // Quick; no calls into the registry.
  virtual void Look(std::chrono::steady_clock::time_point now) = 0;
};

class WatchRegistry {
 public:
  // `interval`: between two looks.
  explicit WatchRegistry(std::chrono::milliseconds interval);
  ~WatchRegistry();  // stops

  void Add(Watch* watch);
  void Remove(Watch* watch);  // after this it is not looked at any more

  // Has all watches looked at now.
  void LookNow();

  void Stop();
  size_t size() const;

 private:
  void Run();

  const std::chrono::milliseconds interval_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::set<Watch*> watches_;
  bool now_ = false;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_API_WATCH_REGISTRY_H_

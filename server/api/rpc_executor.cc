#include "server/api/rpc_executor.h"

#include <algorithm>

namespace ballpiston::server {
namespace {

int HalfOf(int threads) { return std::max(1, threads / 2); }

}  // namespace

// Calls that write wait for one commit together, so one principal may have all of their threads.
RpcExecutor::RpcExecutor(int threads)
    : reads_(threads, HalfOf(threads)),
      writes_(threads, threads),
      streams_(HalfOf(threads), HalfOf(HalfOf(threads))) {}

RpcExecutor::~RpcExecutor() { Stop(); }

void RpcExecutor::Stop() {
  reads_.Stop();
  writes_.Stop();
  streams_.Stop();
}

RpcExecutor::Lane::Lane(int threads, int share) : share_(share) {
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { Work(); });
}

void RpcExecutor::Lane::Post(const std::string& principal, Task task) {
  MutexLock lock(mutex_);
  if (stopping_) return;
  const auto queue = queues_.try_emplace(principal).first;
  if (queue->second.tasks.empty()) turns_.push_back(queue);
  queue->second.tasks.push_back(std::move(task));
  changed_.NotifyOne();
}

void RpcExecutor::Lane::Stop() {
  std::vector<std::thread> threads;
  {
    MutexLock lock(mutex_);
    stopping_ = true;
    threads.swap(threads_);
  }
  changed_.NotifyAll();
  for (std::thread& thread : threads) thread.join();
}

// The first principal that has fewer threads than its share.
std::list<RpcExecutor::Lane::Queues::iterator>::iterator RpcExecutor::Lane::NextTurn() {
  return std::find_if(turns_.begin(), turns_.end(),
                      [this](const auto& queue) { return queue->second.running < share_; });
}

RpcExecutor::Task RpcExecutor::Lane::Take(std::list<Queues::iterator>::iterator turn) {
  Queue& queue = (*turn)->second;
  Task task = std::move(queue.tasks.front());
  queue.tasks.pop_front();
  ++queue.running;
  if (queue.tasks.empty()) {
    turns_.erase(turn);
  } else {
    turns_.splice(turns_.end(), turns_, turn);
  }
  return task;
}

void RpcExecutor::Lane::Work() {
  MutexLock lock(mutex_);
  while (true) {
    auto turn = NextTurn();
    for (; turn == turns_.end() && !IsDone(); turn = NextTurn()) changed_.Wait(mutex_);
    if (turn == turns_.end()) return;
    const Queues::iterator queue = *turn;
    Task task = Take(turn);
    lock.Unlock();
    task();
    task = nullptr;  // releases its captures without the lock
    lock.Lock();
    // Wakes a thread that waited because this principal had its full share.
    if (queue->second.running-- == share_ && !queue->second.tasks.empty()) changed_.NotifyOne();
    if (queue->second.running == 0 && queue->second.tasks.empty()) queues_.erase(queue);
    if (IsDone()) changed_.NotifyAll();
  }
}

}  // namespace ballpiston::server

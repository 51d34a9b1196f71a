#include "server/api/rpc_executor.h"

#include <algorithm>

namespace ballpiston::server {

RpcExecutor::RpcExecutor(int threads) : calls_(threads), streams_(std::max(1, threads / 2)) {}

RpcExecutor::~RpcExecutor() { Stop(); }

void RpcExecutor::Stop() {
  calls_.Stop();
  streams_.Stop();
}

RpcExecutor::Lane::Lane(int threads) {
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { Work(); });
}

void RpcExecutor::Lane::Post(Task task) {
  std::lock_guard lock(mutex_);
  if (stopping_) return;
  tasks_.push_back(std::move(task));
  posted_.notify_one();
}

void RpcExecutor::Lane::Stop() {
  std::vector<std::thread> threads;
  {
    std::lock_guard lock(mutex_);
    stopping_ = true;
    threads.swap(threads_);
  }
  posted_.notify_all();
  for (std::thread& thread : threads) thread.join();
}

void RpcExecutor::Lane::Work() {
  std::unique_lock lock(mutex_);
  while (true) {
    posted_.wait(lock, [this] { return stopping_ || !tasks_.empty(); });
    if (tasks_.empty()) return;
    Task task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    task();
    task = nullptr;  // what it holds is let go without the lock
    lock.lock();
  }
}

}  // namespace ballpiston::server

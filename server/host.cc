#include "server/host.h"

#include <random>
#include <thread>
#include <utility>

#include "absl/time/clock.h"
#include "server/mutex.h"
#include "server/processor_time.h"

namespace ballpiston::server {

std::chrono::steady_clock::time_point SteadyNow() { return std::chrono::steady_clock::now(); }

absl::Time WallNow() { return absl::Now(); }

double ProcessorSeconds() { return ThreadSeconds(); }

uint64_t RandomBits() {
  std::random_device random;
  const uint64_t high = random();
  return high << 32 | random();
}

void*& PointerOfThread() {
  static constinit thread_local void* pointer = nullptr;
  return pointer;
}

// ---- threads ----

struct Thread::Running {
  std::thread thread;
};

Thread::Thread(std::function<void()> run)
    : running_(std::make_unique<Running>(Running{std::thread(std::move(run))})) {}
Thread::Thread() = default;
Thread::Thread(Thread&&) noexcept = default;
Thread& Thread::operator=(Thread&&) noexcept = default;
Thread::~Thread() = default;

void Thread::join() {
  running_->thread.join();
  running_ = nullptr;
}

// ---- locks ----

void Mutex::Lock() { mutex_.lock(); }
void Mutex::Unlock() { mutex_.unlock(); }

void Condition::Wait(Mutex& mutex) {
  std::unique_lock lock(mutex.mutex_, std::adopt_lock);
  condition_.wait(lock);
  lock.release();
}

bool Condition::WaitUntil(Mutex& mutex, std::chrono::steady_clock::time_point end) {
  std::unique_lock lock(mutex.mutex_, std::adopt_lock);
  const std::cv_status status = condition_.wait_until(lock, end);
  lock.release();
  return status == std::cv_status::no_timeout;
}

void Condition::NotifyOne() { condition_.notify_one(); }
void Condition::NotifyAll() { condition_.notify_all(); }

}  // namespace ballpiston::server

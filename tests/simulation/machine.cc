#include "tests/simulation/machine.h"

#include "server/host.h"
#include "server/mutex.h"

namespace ballpiston::server {
namespace {

// The simulation begins at this time.
constexpr int64_t kStartSeconds = 1'700'000'000;

// The probability that another thread runs before a thread takes a lock.
constexpr double kPreemption = 0.1;

Machine* current = nullptr;

}  // namespace

// A thread of the system, which waits for its turn.
struct Machine::SimulatedThread {
  enum class State { kReady, kWaits, kEnded };

  State state = State::kReady;
  const void* awaited = nullptr;  // this and `until`: set while it waits
  std::optional<Clock::time_point> until = {};
  bool was_notified = false;  // by the end of the last wait
  bool is_joined = false;     // no thread refers to it any more
  std::binary_semaphore turn{0};
  std::jthread thread = {};
};

Machine::Machine(uint64_t seed)
    : Dice(seed), now_(Clock::time_point(std::chrono::seconds(kStartSeconds))) {}
Machine::~Machine() = default;

void Machine::Run(std::function<void()> main) {
  running_ = Start(std::move(main));
  running_->is_joined = true;
  current = this;
  running_->turn.release();
  outside_.acquire();
  current = nullptr;
  if (!is_stuck_) return threads_.clear();
  new auto(std::move(threads_));  // leaked: they wait for ever
  throw std::runtime_error("all threads wait, and no wait has a time limit");
}

Machine::SimulatedThread* Machine::Start(std::function<void()> run) {
  threads_.push_back(std::make_unique<SimulatedThread>());
  SimulatedThread& self = *threads_.back();
  self.thread = std::jthread([this, &self, run = std::move(run)]() mutable {
    self.turn.acquire();
    run();
    run = nullptr;
    self.state = SimulatedThread::State::kEnded;
    NotifyAll(&self);
    Switch();
  });
  return &self;
}

bool Machine::Join(SimulatedThread* thread, Clock::time_point until) {
  const auto end = until == Clock::time_point::max() ? std::nullopt : std::optional(until);
  while (thread->state != SimulatedThread::State::kEnded) {
    if (now_ >= until) return false;
    Await(thread, end);
  }
  thread->is_joined = true;
  return true;
}

void Machine::GiveUp() {
  is_stuck_ = true;
  SimulatedThread& self = *running_;
  outside_.release();
  self.turn.acquire();
}

bool Machine::Await(const void* what, std::optional<Clock::time_point> until) {
  SimulatedThread& self = *running_;
  self.state = SimulatedThread::State::kWaits;
  self.awaited = what;
  self.until = until;
  self.was_notified = false;
  Switch();
  return self.was_notified;
}

bool Machine::NotifyOne(const void* what) {
  std::vector<SimulatedThread*> waiting;
  for (const auto& thread : threads_) {
    const bool waits = thread->state == SimulatedThread::State::kWaits;
    if (waits && thread->awaited == what) waiting.push_back(thread.get());
  }
  if (waiting.empty()) return false;
  SimulatedThread& chosen = *waiting[Below(waiting.size())];
  chosen.state = SimulatedThread::State::kReady;
  chosen.was_notified = true;
  return true;
}

void Machine::NotifyAll(const void* what) {
  while (NotifyOne(what)) {
  }
}

// ---- the next thread ----

void Machine::Switch() {
  SimulatedThread* const self = running_;
  const bool goes_on = self->state != SimulatedThread::State::kEnded;
  SimulatedThread* const next = Choose();
  if (next == self) return;
  ++switches_;
  running_ = next;
  (next != nullptr ? next->turn : outside_).release();
  if (!goes_on) return;
  self->turn.acquire();
  // Now this thread runs again. Others may have ended.
  std::erase_if(threads_, [](const auto& thread) {
    return thread->state == SimulatedThread::State::kEnded && thread->is_joined;
  });
}

Machine::SimulatedThread* Machine::Choose() {
  std::vector<SimulatedThread*> ready;
  do {
    for (const auto& thread : threads_) {
      if (thread->state == SimulatedThread::State::kReady) ready.push_back(thread.get());
    }
  } while (ready.empty() && PassTime());
  return ready.empty() ? nullptr : ready[Below(ready.size())];
}

// Sets the time to the earliest time limit of a wait. False: no wait has a time limit.
bool Machine::PassTime() {
  std::optional<Clock::time_point> first;
  bool all_have_ended = true;
  for (const auto& thread : threads_) {
    all_have_ended = all_have_ended && thread->state == SimulatedThread::State::kEnded;
    if (thread->state == SimulatedThread::State::kWaits && thread->until) {
      first = std::min(first.value_or(*thread->until), *thread->until);
    }
  }
  is_stuck_ = !first && !all_have_ended;
  if (!first) return false;
  now_ = std::max(now_, *first);
  for (const auto& thread : threads_) {
    if (thread->state == SimulatedThread::State::kWaits && thread->until &&
        *thread->until <= now_) {
      thread->state = SimulatedThread::State::kReady;
    }
  }
  return true;
}

// ---- server/host.h and server/mutex.h ----

std::chrono::steady_clock::time_point SteadyNow() {
  return current != nullptr ? current->now() : Machine::Clock::now();
}

absl::Time WallNow() {
  return absl::UnixEpoch() + absl::FromChrono(SteadyNow().time_since_epoch());
}

// The processor time is the simulated time.
double ProcessorSeconds() {
  return std::chrono::duration<double>(SteadyNow().time_since_epoch()).count();
}

uint64_t RandomBits() { return current->Bits(); }

void*& PointerOfThread() {
  static constinit thread_local void* pointer = nullptr;
  return pointer;
}

struct Thread::Running {
  Machine::SimulatedThread* thread;
};

Thread::Thread(std::function<void()> run)
    : running_(std::make_unique<Running>(Running{current->Start(std::move(run))})) {}
Thread::Thread() = default;
Thread::Thread(Thread&&) noexcept = default;
Thread& Thread::operator=(Thread&&) noexcept = default;
Thread::~Thread() = default;

void Thread::join() {
  current->Join(running_->thread);
  running_ = nullptr;
}

void Mutex::Lock() {
  if (current == nullptr) return mutex_.lock();
  if (current->Chance(kPreemption)) current->Yield();
  while (!mutex_.try_lock()) current->Await(&mutex_);
}

void Mutex::Unlock() {
  mutex_.unlock();
  if (current != nullptr) current->NotifyAll(&mutex_);
}

void Condition::Wait(Mutex& mutex) {
  mutex.Unlock();
  current->Await(this);
  mutex.Lock();
}

bool Condition::WaitUntil(Mutex& mutex, std::chrono::steady_clock::time_point end) {
  mutex.Unlock();
  const bool was_notified = current->Await(this, end);
  mutex.Lock();
  return was_notified;
}

void Condition::NotifyOne() {
  if (current != nullptr) current->NotifyOne(this);
}

void Condition::NotifyAll() {
  if (current != nullptr) current->NotifyAll(this);
}

}  // namespace ballpiston::server

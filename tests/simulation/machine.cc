#include "tests/simulation/machine.h"

#include <cxxabi.h>
#include <sys/mman.h>

#include "server/host.h"
#include "server/mutex.h"

namespace ballpiston::server {
namespace {

constexpr size_t kStackBytes = 1 << 20;
constexpr size_t kGuardBytes = 4096;  // at the end of the stack: an overflow is a fault

// The simulation begins at this time.
constexpr int64_t kStartSeconds = 1'700'000'000;

// The probability that another thread runs before a thread takes a lock.
constexpr double kPreemption = 0.1;

Machine* current = nullptr;

}  // namespace

// The exceptions that a simulated thread handles. The C++ runtime keeps them for each thread of the
// system, and all simulated threads share one.
struct Exceptions {
  void* caught = nullptr;
  unsigned uncaught = 0;
};
static Exceptions& ExceptionsNow() {
  return *reinterpret_cast<Exceptions*>(abi::__cxa_get_globals());
}

// The address sanitizer has to know the stack on which the code goes on. Otherwise it takes
// exceptions that unwind a simulated thread's stack for errors.
#ifdef __SANITIZE_ADDRESS__
extern "C" void __sanitizer_start_switch_fiber(void** save, const void* bottom, size_t bytes);
extern "C" void __sanitizer_finish_switch_fiber(void* saved, const void** bottom, size_t* bytes);
static void SwitchContext(ucontext_t& from, const ucontext_t& to) {
  void* fake_stack = nullptr;
  __sanitizer_start_switch_fiber(&fake_stack, to.uc_stack.ss_sp, to.uc_stack.ss_size);
  swapcontext(&from, &to);
  __sanitizer_finish_switch_fiber(fake_stack, nullptr, nullptr);
}
#else
static void SwitchContext(ucontext_t& from, const ucontext_t& to) { swapcontext(&from, &to); }
#endif

class Stack {
 public:
  Stack()
      : memory_(mmap(nullptr, kStackBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1,
                     0)) {
    if (memory_ == MAP_FAILED || mprotect(memory_, kGuardBytes, PROT_NONE) != 0) {
      throw std::bad_alloc();
    }
  }
  ~Stack() { munmap(memory_, kStackBytes); }
  Stack(const Stack&) = delete;
  Stack& operator=(const Stack&) = delete;

  stack_t Get() const { return {.ss_sp = memory_, .ss_flags = 0, .ss_size = kStackBytes}; }

 private:
  void* memory_;
};

struct Machine::Fiber {
  enum class State { kReady, kWaits, kEnded };

  ucontext_t context = {};
  Stack stack;
  std::function<void()> run;
  State state = State::kReady;
  const void* awaited = nullptr;  // this and `until`: set while it waits
  std::optional<Clock::time_point> until = {};
  bool was_notified = false;  // by the end of the last wait
  bool is_joined = false;     // no thread refers to it any more
  Exceptions exceptions = {};
  void* pointer = nullptr;  // PointerOfThread
};

Machine::Machine(uint64_t seed)
    : random_(seed), now_(Clock::time_point(std::chrono::seconds(kStartSeconds))) {}
Machine::~Machine() = default;

void Machine::Run(std::function<void()> main) {
  Fiber* const first = Start(std::move(main));
  first->is_joined = true;
  current = this;
  running_ = first;
  SwitchContext(outside_, first->context);
  current = nullptr;
  if (is_stuck_) throw std::runtime_error("all threads wait, and none for a time");
}

Machine::Fiber* Machine::Start(std::function<void()> run) {
  auto fiber = std::make_unique<Fiber>();
  fiber->run = std::move(run);
  getcontext(&fiber->context);
  fiber->context.uc_stack = fiber->stack.Get();
  makecontext(&fiber->context, &Machine::Enter, 0);
  fibers_.push_back(std::move(fiber));
  return fibers_.back().get();
}

void Machine::Enter() {
#ifdef __SANITIZE_ADDRESS__
  const void* stack = nullptr;
  size_t bytes = 0;
  __sanitizer_finish_switch_fiber(nullptr, &stack, &bytes);
  stack_t& outside = current->outside_.uc_stack;  // the first thread comes from there
  if (outside.ss_sp == nullptr) outside = {const_cast<void*>(stack), 0, bytes};
#endif
  Fiber& self = *current->running_;
  self.run();
  self.run = nullptr;
  self.state = Fiber::State::kEnded;
  current->NotifyAll(&self);
  current->Switch();
}

bool Machine::Join(Fiber* fiber, Clock::time_point until) {
  const auto end = until == Clock::time_point::max() ? std::nullopt : std::optional(until);
  while (fiber->state != Fiber::State::kEnded) {
    if (now_ >= until) return false;
    Await(fiber, end);
  }
  fiber->is_joined = true;
  return true;
}

void Machine::GiveUp() {
  is_stuck_ = true;
  SwitchContext(running_->context, outside_);
}

void*& Machine::pointer_of_thread() { return running_->pointer; }

bool Machine::Await(const void* what, std::optional<Clock::time_point> until) {
  Fiber& self = *running_;
  self.state = Fiber::State::kWaits;
  self.awaited = what;
  self.until = until;
  self.was_notified = false;
  Switch();
  return self.was_notified;
}

void Machine::NotifyOne(const void* what) {
  std::vector<Fiber*> waiting;
  for (const auto& fiber : fibers_) {
    if (fiber->state == Fiber::State::kWaits && fiber->awaited == what) {
      waiting.push_back(fiber.get());
    }
  }
  if (waiting.empty()) return;
  Fiber& chosen = *waiting[Below(waiting.size())];
  chosen.state = Fiber::State::kReady;
  chosen.was_notified = true;
}

void Machine::NotifyAll(const void* what) {
  for (const auto& fiber : fibers_) {
    if (fiber->state != Fiber::State::kWaits || fiber->awaited != what) continue;
    fiber->state = Fiber::State::kReady;
    fiber->was_notified = true;
  }
}

// ---- the next thread ----

void Machine::Switch() {
  Fiber* const self = running_;
  Fiber* const next = Choose();
  if (next == self) return;
  ++switches_;
  self->exceptions = ExceptionsNow();
  running_ = next;
  ExceptionsNow() = next != nullptr ? next->exceptions : Exceptions();
  SwitchContext(self->context, next != nullptr ? next->context : outside_);
  // Now this thread runs again. The thread that ran before it may have ended.
  std::erase_if(fibers_, [](const auto& fiber) {
    return fiber->state == Fiber::State::kEnded && fiber->is_joined;
  });
}

Machine::Fiber* Machine::Choose() {
  std::vector<Fiber*> ready;
  do {
    for (const auto& fiber : fibers_) {
      if (fiber->state == Fiber::State::kReady) ready.push_back(fiber.get());
    }
  } while (ready.empty() && PassTime());
  return ready.empty() ? nullptr : ready[Below(ready.size())];
}

// Sets the time to the earliest time limit of a wait. False: no wait has a time limit.
bool Machine::PassTime() {
  std::optional<Clock::time_point> first;
  bool all_have_ended = true;
  for (const auto& fiber : fibers_) {
    all_have_ended = all_have_ended && fiber->state == Fiber::State::kEnded;
    if (fiber->state == Fiber::State::kWaits && fiber->until) {
      first = std::min(first.value_or(*fiber->until), *fiber->until);
    }
  }
  is_stuck_ = !first && !all_have_ended;
  if (!first) return false;
  now_ = std::max(now_, *first);
  for (const auto& fiber : fibers_) {
    if (fiber->state == Fiber::State::kWaits && fiber->until && *fiber->until <= now_) {
      fiber->state = Fiber::State::kReady;
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

void*& PointerOfThread() { return current->pointer_of_thread(); }

struct Thread::Running {
  Machine::Fiber* fiber;
};

Thread::Thread(std::function<void()> run)
    : running_(std::make_unique<Running>(Running{current->Start(std::move(run))})) {}
Thread::Thread() = default;
Thread::Thread(Thread&&) noexcept = default;
Thread& Thread::operator=(Thread&&) noexcept = default;
Thread::~Thread() = default;

void Thread::join() {
  current->Join(running_->fiber);
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

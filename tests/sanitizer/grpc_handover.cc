// Reports to the thread sanitizer the order that gRPC enforces between threads.
//
// The libraries of gRPC and Abseil are not instrumented, so the sanitizer does not see how they
// order their threads. This library comes before them in the order of symbol look-up, and replaces
// some of their functions:
//   - what a thread did before it released a lock comes before what the next owner does;
//   - what was done before a call was given to gRPC (a write, an end) comes before the reaction.
// If a reaction and a thread of the server use the same variable, they still race
// (seeded_race.cc). Two threads that both call gRPC may be ordered by its locks by chance, as by
// any lock: a race between them is reported in some runs only. Not replaced, because nothing here
// uses them: readers' locks, conditions of absl::Mutex, reactions of the client's callback API.
//
// The names and the layout are those of Debian's gRPC 1.51 and Abseil 20220623.
#include <dlfcn.h>
#include <sanitizer/tsan_interface.h>

#include "absl/time/time.h"
#include "grpc/grpc.h"

#define MUTEX "_ZN4absl7debian35Mutex"
#define CONDITION "_ZN4absl7debian37CondVar"
#define SCHEDULE_ON_DONE "_ZN4grpc8internal18ServerCallbackCall14ScheduleOnDoneEb"
#define RUN_REACTION \
  "_ZN4grpc8internal22CallbackWithSuccessTag9StaticRunEP29grpc_completion_queue_functori"

namespace {

// The function that this library replaces.
template <typename Function>
Function* Next(Function*, const char* symbol) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, symbol));
}

}  // namespace

extern "C" {

// ---- absl::Mutex and absl::CondVar ----

void MutexLock(void* mutex) __asm__(MUTEX "4LockEv");
void MutexLock(void* mutex) {
  static const auto lock = Next(MutexLock, MUTEX "4LockEv");
  lock(mutex);
  __tsan_acquire(mutex);
}

bool MutexTryLock(void* mutex) __asm__(MUTEX "7TryLockEv");
bool MutexTryLock(void* mutex) {
  static const auto try_lock = Next(MutexTryLock, MUTEX "7TryLockEv");
  const bool locked = try_lock(mutex);
  if (locked) __tsan_acquire(mutex);
  return locked;
}

void MutexUnlock(void* mutex) __asm__(MUTEX "6UnlockEv");
void MutexUnlock(void* mutex) {
  static const auto unlock = Next(MutexUnlock, MUTEX "6UnlockEv");
  __tsan_release(mutex);
  unlock(mutex);
}

void Wait(void* condition, void* mutex) __asm__(CONDITION "4WaitEPNS0_5MutexE");
void Wait(void* condition, void* mutex) {
  static const auto wait = Next(Wait, CONDITION "4WaitEPNS0_5MutexE");
  __tsan_release(mutex);
  wait(condition, mutex);
  __tsan_acquire(mutex);
}

bool WaitFor(void* condition, void* mutex,
             absl::Duration timeout) __asm__(CONDITION
                                             "15WaitWithTimeoutEPNS0_5MutexENS0_8DurationE");
bool WaitFor(void* condition, void* mutex, absl::Duration timeout) {
  static const auto wait = Next(WaitFor, CONDITION "15WaitWithTimeoutEPNS0_5MutexENS0_8DurationE");
  __tsan_release(mutex);
  const bool timed_out = wait(condition, mutex, timeout);
  __tsan_acquire(mutex);
  return timed_out;
}

bool WaitUntil(void* condition, void* mutex,
               absl::Time deadline) __asm__(CONDITION "16WaitWithDeadlineEPNS0_5MutexENS0_4TimeE");
bool WaitUntil(void* condition, void* mutex, absl::Time deadline) {
  static const auto wait = Next(WaitUntil, CONDITION "16WaitWithDeadlineEPNS0_5MutexENS0_4TimeE");
  __tsan_release(mutex);
  const bool timed_out = wait(condition, mutex, deadline);
  __tsan_acquire(mutex);
  return timed_out;
}

// ---- calls and their reactions ----

using Functor = grpc_completion_queue_functor;

// grpc::internal::CallbackWithSuccessTag::StaticRun, with which gRPC starts a reaction.
void RunReaction(Functor* tag, int ok) __asm__(RUN_REACTION);

static void RunReactionAfterHandover(Functor* tag, int ok) {
  __tsan_acquire(tag);
  RunReaction(tag, ok);
}

// Other tags than a reaction's are no functors, and begin with something else.
static void ObserveReaction(void* tag) {
  auto* functor = static_cast<Functor*>(tag);
  if (functor->functor_run == RunReaction) functor->functor_run = RunReactionAfterHandover;
}

grpc_call_error grpc_call_start_batch(grpc_call* call, const grpc_op* ops, size_t count, void* tag,
                                      void* reserved) {
  static const auto start = Next(grpc_call_start_batch, "grpc_call_start_batch");
  if (tag != nullptr) {
    ObserveReaction(tag);
    __tsan_release(tag);
  }
  return start(call, ops, count, tag, reserved);
}

// grpc::internal::ServerCallbackCall::ScheduleOnDone. The thread that ends the last outstanding
// reaction calls it; that thread may be in gRPC's library. The count follows the table of virtual
// functions and another count.
void ScheduleOnDone(void* call, bool here) __asm__(SCHEDULE_ON_DONE);
void ScheduleOnDone(void* call, bool here) {
  static const auto schedule = Next(ScheduleOnDone, SCHEDULE_ON_DONE);
  __tsan_acquire(static_cast<char*>(call) + sizeof(void*) + sizeof(int));
  schedule(call, here);
}

}  // extern "C"

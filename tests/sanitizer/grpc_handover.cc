// Reports to the thread sanitizer the order that gRPC enforces between threads.
//
// The libraries of gRPC and Abseil are not instrumented, so the sanitizer does not see their locks,
// by which a call passes from thread to thread. This library comes before them in the order of
// symbol look-up, and replaces the functions of absl::Mutex and absl::CondVar: these report that
// what a thread did before it released a lock comes before what the next owner does.
//
// If a method of a service and a thread of the server use the same variable without a lock, the
// race is still reported (seeded_race.cc). Two threads that both call gRPC may be ordered by its
// locks by chance, as by any lock: a race between them is reported in some runs only. Not replaced,
// because no thread of ours waits for another one in them: readers' locks, conditions of
// absl::Mutex, and gRPC's callback API, in which only its own health service is written.
//
// The names are those of Debian's Abseil 20220623.
#include <dlfcn.h>
#include <sanitizer/tsan_interface.h>

#include "absl/time/time.h"

#define MUTEX "_ZN4absl7debian35Mutex"
#define CONDITION "_ZN4absl7debian37CondVar"

namespace {

// The function that this library replaces.
template <typename Function>
Function* Next(Function*, const char* symbol) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, symbol));
}

}  // namespace

extern "C" {

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

}  // extern "C"

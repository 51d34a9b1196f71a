// How long tests wait.
//
// No result of a test depends on the machine's pace: a test waits until a condition is true. The
// limit of a wait is only for a program that hangs, and the failure of the test then says so.
#pragma once

#include <chrono>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace ballpiston {

// The longest wait for one condition, and the deadline of one call.
inline constexpr std::chrono::minutes kPatience(15);

// A time limit under test that must not be reached.
inline constexpr std::chrono::hours kUnreachedLimit(100);

[[noreturn]] inline void ThrowLongWait(const char* file, int line) {
  std::ostringstream text;
  text << file << ":" << line << ": the condition is still false after " << kPatience.count()
       << " minutes";
  std::cerr << text.str() << std::endl;  // the exception may end the program without a message
  throw std::runtime_error(text.str());
}

// Evaluates the condition every millisecond and returns when it is true. After kPatience it throws
// std::runtime_error, which fails the test. The message names the place of the call; Clang 14
// does not have std::source_location.
template <typename Condition>
void AwaitThat(Condition condition, const char* file = __builtin_FILE(),
               int line = __builtin_LINE()) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) ThrowLongWait(file, line);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

// The same for a condition whose changes are notified. `lock` holds the mutex.
template <typename Changed, typename Lock, typename Condition>
void AwaitNotified(Changed& changed, Lock& lock, Condition condition,
                   const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  if (!changed.wait_for(lock, kPatience, condition)) ThrowLongWait(file, line);
}

}  // namespace ballpiston

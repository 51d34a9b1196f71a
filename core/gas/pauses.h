// Pauses let a long computation return before its end and continue with the next call. The
// computation counts its work; now and then its caller is asked whether to pause.
//
// Work is counted after it is done, so every call makes progress, even if the caller always wants
// a pause. Not thread-safe.
#pragma once

#include <functional>
#include <utility>

namespace ballpiston {

class Pauses {
 public:
  Pauses() = default;  // never pauses
  explicit Pauses(std::function<bool()> is_wanted) : is_wanted_(std::move(is_wanted)) {}

  // Counts work that took about so many nanoseconds. Returns true if the computation must return.
  bool After(double nanoseconds) {
    left_ -= nanoseconds;
    return left_ < 0 && IsWanted();
  }

 private:
  // The counted times are rough. So the caller is asked much more often than every 0.05 s.
  static constexpr double kBetweenQuestions = 2e6;

  bool IsWanted() {
    left_ = kBetweenQuestions;
    return is_wanted_ && is_wanted_();
  }

  std::function<bool()> is_wanted_;
  double left_ = kBetweenQuestions;
};

// For a computation that does not pause.
inline Pauses& NoPauses() {
  thread_local Pauses never;
  return never;
}

}  // namespace ballpiston

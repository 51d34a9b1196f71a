// Settings of this process that have another value for the time of a scope.
#pragma once

#include <signal.h>
#include <sys/resource.h>

#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

namespace ballpiston {

// An environment variable with another value, or without one.
class ScopedVariable {
 public:
  explicit ScopedVariable(std::string name, const std::optional<std::string>& value = {})
      : name_(std::move(name)) {
    if (const char* const old = std::getenv(name_.c_str()); old != nullptr) old_ = old;
    Set(value);
  }
  ~ScopedVariable() { Set(old_); }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;

  void Set(const std::optional<std::string>& value) const {
    if (value) {
      setenv(name_.c_str(), value->c_str(), 1);
    } else {
      unsetenv(name_.c_str());
    }
  }

 private:
  const std::string name_;
  std::optional<std::string> old_;
};

// A limit. A small RLIMIT_FSIZE has the effect of a full disk.
class ScopedLimit {
 public:
  ScopedLimit(int resource, rlim_t value) : resource_(resource) {
    getrlimit(resource_, &before_);
    const rlimit limit = {value, before_.rlim_max};
    setrlimit(resource_, &limit);
  }
  ~ScopedLimit() {
    setrlimit(resource_, &before_);
    signal(SIGXFSZ, handler_);
  }
  ScopedLimit(const ScopedLimit&) = delete;
  ScopedLimit& operator=(const ScopedLimit&) = delete;

 private:
  const int resource_;
  void (*const handler_)(int) = signal(SIGXFSZ, SIG_IGN);  // of a file that would be too large
  rlimit before_{};
};

}  // namespace ballpiston

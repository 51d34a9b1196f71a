// A limit of this process with another value for the time of a scope. A small RLIMIT_FSIZE has the
// effect of a full disk.
#pragma once

#include <signal.h>
#include <sys/resource.h>

namespace ballpiston {

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

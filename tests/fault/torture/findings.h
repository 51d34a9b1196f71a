// A test's counts and errors. The counts are printed when the test ends.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_join.h"

namespace ballpiston::torture {

// Thread-safe.
class Findings {
 public:
  explicit Findings(std::string test) : test_(std::move(test)) {}
  ~Findings() {
    for (const auto& [what, count] : counts_) {
      std::cout << test_ << ": " << what << ": " << count << "\n";
    }
  }

  void Count(const std::string& what, int64_t by = 1) {
    const std::lock_guard lock(mutex_);
    counts_[what] += by;
  }
  void Wrong(const std::string& what) {  // a broken promise
    const std::lock_guard lock(mutex_);
    wrong_.push_back(what);
  }

  int64_t count(const std::string& what) const {
    const std::lock_guard lock(mutex_);
    const auto found = counts_.find(what);
    return found == counts_.end() ? 0 : found->second;
  }

  // The first errors, one a line; empty if there are none.
  std::string Report() const {
    const std::lock_guard lock(mutex_);
    const size_t shown = std::min<size_t>(wrong_.size(), 20);
    return absl::StrJoin(wrong_.begin(), wrong_.begin() + static_cast<ptrdiff_t>(shown), "\n");
  }

 private:
  const std::string test_;
  mutable std::mutex mutex_;
  std::map<std::string, int64_t> counts_;
  std::vector<std::string> wrong_;
};

}  // namespace ballpiston::torture

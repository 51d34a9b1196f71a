// A test's counts and errors, which it prints when it ends.
#pragma once

#include <cstdio>

#include "tests/support/preamble.h"

namespace ballpiston::torture {

// Thread-safe.
class Findings {
 public:
  explicit Findings(std::string section) : section_(std::move(section)) {}
  // Prints the rows.
  ~Findings() {
    for (const auto& [what, count] : counts_) Note(what, absl::StrCat(count));
    for (const auto& [what, value] : notes_) {
      std::printf("| %-32s | %-52s | %19s |\n", section_.c_str(), what.c_str(), value.c_str());
    }
  }

  void Count(const std::string& what, int64_t by = 1) {
    const std::lock_guard lock(mutex_);
    counts_[what] += by;
  }
  // A measured number, as text.
  void Note(const std::string& what, const std::string& value) {
    const std::lock_guard lock(mutex_);
    notes_[what] = value;
  }
  // A broken promise.
  void Wrong(const std::string& what) {
    ADD_FAILURE() << what;
    Count("promises broken");
  }

  int64_t count(const std::string& what) const {
    const std::lock_guard lock(mutex_);
    const auto found = counts_.find(what);
    return found == counts_.end() ? 0 : found->second;
  }

 private:
  const std::string section_;
  mutable std::mutex mutex_;
  std::map<std::string, int64_t> counts_;
  std::map<std::string, std::string> notes_;
};

}  // namespace ballpiston::torture

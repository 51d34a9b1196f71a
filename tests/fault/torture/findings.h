// A test's counts and errors, which it prints when it ends.
#pragma once

#include "tests/support/preamble.h"

namespace ballpiston::torture {

// Thread-safe.
class Findings {
 public:
  explicit Findings(std::string section) : section_(std::move(section)) {}
  ~Findings();  // prints the rows

  void Count(const std::string& what, int64_t by = 1);
  void Note(const std::string& what, const std::string& value);  // a measured number, as text
  void Wrong(const std::string& what);                           // a broken promise

  int64_t count(const std::string& what) const;
  // The first errors, one a line; empty if there are none. Counts them as "promises broken".
  std::string Report();

 private:
  const std::string section_;
  mutable std::mutex mutex_;
  std::map<std::string, int64_t> counts_;
  std::map<std::string, std::string> notes_;
  std::vector<std::string> wrong_;
};

}  // namespace ballpiston::torture

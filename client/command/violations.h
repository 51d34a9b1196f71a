// What is wrong with a command line: all of it, so that one attempt shows every mistake.
//
//   Violations({name.status(), shape.status()}).Report()
//
// A list of numbers has violations of its own: they come as one status, one a line (Lines), and are
// counted one by one.
#ifndef BALLPISTON_CLIENT_COMMAND_VIOLATIONS_H_
#define BALLPISTON_CLIENT_COMMAND_VIOLATIONS_H_

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace ballpiston::client {

class Violations {
 public:
  static constexpr int64_t kMaxShown = 50;  // the rest is counted

  Violations() = default;
  Violations(std::initializer_list<absl::Status> statuses);

  void Add(const absl::Status& status);  // nothing if it is OK, or the same as the last one

  // Both are OK if there is none, else INVALID_ARGUMENT.
  absl::Status Lines() const;   // one violation a line and no more: to be added to others
  absl::Status Report() const;  // as the server reports them: a line that counts, one line each

 private:
  std::vector<std::string> lines_;
};

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_VIOLATIONS_H_

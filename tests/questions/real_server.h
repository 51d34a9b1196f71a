// Asks ballpistond, a process on a Unix socket in a temporary folder.
#pragma once

#include "client/library/client.h"
#include "tests/questions/checks.h"
#include "tests/questions/question.h"
#include "tests/support/server_process.h"

namespace ballpiston::questions {

class RealServer {
 public:
  explicit RealServer(double most_seconds) : most_seconds_(most_seconds) {}

  // Plans the question. Runs it to its end, or starts and cancels it if the planned processor time
  // is above `most_seconds`. If the server dies or never ends, the next question gets a new one.
  Report Ask(const Question& question);

 private:
  void EnsureRunning();

  const double most_seconds_;
  std::unique_ptr<ServerProcess> server_;
  std::unique_ptr<client::Client> client_;
};

}  // namespace ballpiston::questions

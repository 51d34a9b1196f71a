// Clients that hang: a process that opens watches and then stops (SIGSTOP). After that, neither the
// watches nor gRPC read what the server sends. Every other watch has not read its first message
// either, which is as large as the job.
#pragma once

#include <string>

#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::torture {

inline constexpr char kHungReaders[] = "--hung_readers";  // COUNT ADDRESS JOB SILENCE

// The process's main function. The file SILENCE holds the two numbers of WakeAndCountSilent.
int RunHungReaders(const std::string& count, const std::string& address, const std::string& job,
                   const std::string& silence_file);

// Starts the process, which hangs when the constructor returns. The destructor kills it.
class HungReaders {
 public:
  HungReaders(int count, const std::string& address, const std::string& job);

  // Wakes the process; call it once. Each watch reads until a message has at least `last` finished
  // points. Returns the number of watches that got no message with more than `first` and fewer than
  // `last` finished points. For these the server had one message waiting and made no other one.
  int WakeAndCountSilent(int first, int last);

 private:
  const TemporaryFolder folder_;
  Process process_;
};

}  // namespace ballpiston::torture

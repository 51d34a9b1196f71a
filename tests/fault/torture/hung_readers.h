// Clients that hang: a process that opens watches and then stops (SIGSTOP), so that nothing of what
// the server sends is read any more, neither by the watches nor from the sockets. Every other one
// has not even read its first message, which is as large as the job.
#ifndef BALLPISTON_TESTS_FAULT_TORTURE_HUNG_READERS_H_
#define BALLPISTON_TESTS_FAULT_TORTURE_HUNG_READERS_H_

#include <string>

#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::torture {

inline constexpr char kHungReaders[] = "--hung_readers";  // COUNT ADDRESS JOB SILENCE

// The process's main function. The file SILENCE holds the two numbers of WakeAndCountSilent.
int RunHungReaders(const std::string& count, const std::string& address, const std::string& job,
                   const std::string& silence_file);

// The process, from outside: hangs when the constructor returns, is killed by the destructor.
class HungReaders {
 public:
  HungReaders(int count, const std::string& address, const std::string& job);

  // Wakes them, once: each reads until it is told of at least `last` finished points. Returns how
  // many of them find no message from the time when there were more than `first` and fewer than
  // `last`: the server had a message waiting for these all the while, and made no other.
  int WakeAndCountSilent(int first, int last);

 private:
  const TemporaryFolder folder_;
  Process process_;
};

}  // namespace ballpiston::torture

#endif  // BALLPISTON_TESTS_FAULT_TORTURE_HUNG_READERS_H_

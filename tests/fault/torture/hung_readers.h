// Clients that hang: a process that opens watches and then stops (SIGSTOP), so that nothing of what
// the server sends is read any more, neither by the watches nor from the sockets. Every other one
// has not even read its first message, which is as large as the job.
#ifndef BALLPISTON_TESTS_FAULT_TORTURE_HUNG_READERS_H_
#define BALLPISTON_TESTS_FAULT_TORTURE_HUNG_READERS_H_

#include <sys/types.h>

#include <string>

namespace ballpiston::torture {

inline constexpr char kHungReaders[] = "--hung_readers";  // COUNT ADDRESS JOB

// The process's main function.
int RunHungReaders(const std::string& count, const std::string& address, const std::string& job);

// The process, from outside: hangs when the constructor returns, is killed by the destructor.
class HungReaders {
 public:
  HungReaders(int count, const std::string& address, const std::string& job);
  ~HungReaders();
  HungReaders(const HungReaders&) = delete;
  HungReaders& operator=(const HungReaders&) = delete;

  // Wakes them: each reads until it is told of at least `last` finished points. Returns how many of
  // them find nothing that was said when there were more than `first` and fewer than `last`: to
  // these a message was waiting to be sent all the while, and no other was made.
  int WakeAndCountSilent(int first, int last);

 private:
  pid_t pid_ = 0;
  int socket_ = -1;  // to the process's standard input and output
};

}  // namespace ballpiston::torture

#endif  // BALLPISTON_TESTS_FAULT_TORTURE_HUNG_READERS_H_

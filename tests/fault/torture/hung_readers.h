// Clients that hang: a process that opens watches, reads the first message of each, and then stops
// (SIGSTOP), so that nothing of what the server sends is read any more.
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

 private:
  pid_t pid_ = 0;
};

}  // namespace ballpiston::torture

#endif  // BALLPISTON_TESTS_FAULT_TORTURE_HUNG_READERS_H_

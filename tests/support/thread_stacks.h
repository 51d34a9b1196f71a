// Where every thread of this process is.
#ifndef BALLPISTON_TESTS_SUPPORT_THREAD_STACKS_H_
#define BALLPISTON_TESTS_SUPPORT_THREAD_STACKS_H_

#include <string>

namespace ballpiston {

// The stack of each thread but the caller, innermost function first, under the thread's name. A
// thread that does not answer within a second, because it is stopped in the kernel, is named
// without its stack. For a process that is about to end: the signal SIGRTMAX is taken for good, and
// a thread that holds the allocator's lock may make the caller wait for ever.
std::string ThreadStacks();

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_SUPPORT_THREAD_STACKS_H_

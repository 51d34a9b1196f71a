// The stacks of all threads of this process.
#ifndef BALLPISTON_TESTS_SUPPORT_THREAD_STACKS_H_
#define BALLPISTON_TESTS_SUPPORT_THREAD_STACKS_H_

#include <string>

namespace ballpiston {

// The name and the stack of each thread except the caller, innermost function first. The stack is
// missing if the thread does not handle a signal within a second, because it is blocked in the
// kernel. Call this only before the process exits: it replaces the handler of SIGRTMAX, and it may
// wait for ever if a thread holds the allocator's lock.
std::string ThreadStacks();

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_SUPPORT_THREAD_STACKS_H_

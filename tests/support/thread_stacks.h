// The stacks of all threads of this process.
#ifndef BALLPISTON_TESTS_SUPPORT_THREAD_STACKS_H_
#define BALLPISTON_TESTS_SUPPORT_THREAD_STACKS_H_

namespace ballpiston {

// Writes the stack of each thread but the caller to the file descriptor, innermost function first,
// under the thread's name, one thread after the other. A thread that does not answer within
// ten seconds is named without its stack: it is stopped in the kernel or, under the thread
// sanitizer, computes without a call that the sanitizer knows.
//
// For a process that is about to end: the function keeps the signal SIGRTMAX and does not free its
// memory, and a thread that holds the allocator's lock may make the caller wait for ever.
void WriteThreadStacks(int descriptor);

}  // namespace ballpiston

#endif  // BALLPISTON_TESTS_SUPPORT_THREAD_STACKS_H_

// The stacks of all threads of this process.
#pragma once

namespace ballpiston {

// Writes the stack of each thread but the caller to the file descriptor, innermost function first,
// under the thread's name, one thread after the other. A thread that does not answer within ten
// seconds is named without its stack: it is stopped in the kernel or, under the thread sanitizer,
// computes without a call that the sanitizer knows.
//
// The function keeps the signal SIGRTMAX and does not free its memory. A thread that holds the
// allocator's lock may make the caller wait for ever: call it in a thread that nobody waits for.
void WriteThreadStacks(int descriptor);

}  // namespace ballpiston

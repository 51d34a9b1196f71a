// Asks in a process of its own, which may die or not end.
#pragma once

#include <functional>

#include "tests/questions/report.h"

namespace ballpiston::questions {

inline constexpr char kCrashCheck[] = "crash";
inline constexpr char kEndCheck[] = "end";

// A question planned at 0.1 s or less that takes so much processor time never ends.
#ifdef BALLPISTON_SANITIZED
inline constexpr int kMostProcessorSeconds = 200;
#else
inline constexpr int kMostProcessorSeconds = 30;
#endif

// The report of `ask`, which runs in a forked process and must not start threads. If the process
// dies, the finding is "crash"; if it takes more than kMostProcessorSeconds, "end".
Report InChild(const std::function<Report()>& ask);

}  // namespace ballpiston::questions

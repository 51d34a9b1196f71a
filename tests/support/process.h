// Runs a program and reads its output and its exit code.
//
// The program is killed when the thread that started it ends (`setpriv --pdeathsig`). A test that
// crashes or is killed therefore leaves no process. Start the program in the test's main thread.
//
// SIGINT, SIGHUP and SIGTERM have their default effect on the program, also where the tests ignore
// one of them because they run in the background of a shell or under nohup.
#pragma once

#include <sys/types.h>

#include "tests/support/preamble.h"

namespace ballpiston {

struct ProcessOptions {
  std::vector<std::string> command;                     // path, arguments
  std::map<std::string, std::string> environment = {};  // added to the test's; empty: removed
  bool on_terminal = false;                             // runs on its own terminal
};

struct ProcessResult {
  int exit_code = -1;  // 128 + signal if a signal killed it
  std::string out;     // on a terminal: with standard error
  std::string err;
};

// Matches a ProcessResult with this exit code. A mismatch shows the standard error.
MATCHER_P(ExitsWith, code, "") {
  *result_listener << "whose exit code is " << arg.exit_code << " and standard error\n" << arg.err;
  return arg.exit_code == code;
}

// One thread waits. The destructor kills the program if it still runs.
class Process {
 public:
  explicit Process(const ProcessOptions& options);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void Signal(int signal) const;  // no effect after the program's end was noticed
  pid_t pid() const { return pid_; }
  std::string Output() const;  // standard output, then standard error, so far

  // On a terminal.
  void Type(const std::string& keys) const;  // "\x03" is Ctrl-C
  void CloseTerminal();                      // as when its window is closed: SIGHUP

  // Every wait ends after 15 minutes with std::runtime_error.

  // Waits until standard error holds the text. False if the program ended without it.
  bool WaitForErr(const std::string& text) { return WaitFor(err_, text); }
  bool WaitForOut(const std::string& text) { return WaitFor(out_, text); }  // standard output
  // Waits for a line of standard error for which `wanted` is true, and returns it; empty if the
  // program ended without one.
  std::string WaitForErrLine(const std::function<bool(const std::string&)>& wanted);
  // Waits until the program ends, but no longer than this. False if it still runs.
  bool EndsWithin(std::chrono::milliseconds time);
  ProcessResult Wait();  // until the program ends; later calls return the same

 private:
  void Start(const std::vector<std::string>& command, const std::array<int, 3>& streams);
  bool HasEnded();
  bool WaitFor(int stream, const std::string& text);

  pid_t pid_ = 0;
  std::optional<int> exit_code_;
  // Files in memory: the program never waits for a reader. A terminal has one, and what the program
  // writes is copied into it whenever the test looks.
  int out_;
  int err_;
  int terminal_ = -1;
};

ProcessResult RunProgram(const ProcessOptions& options);

// The processes whose command line contains the text; its words end with '\0'.
std::vector<pid_t> ProcessesWith(const std::string& text);

// A line of /proc/PROCESS/status, such as "VmRSS:", in MiB. `process`: a number, or "self".
double MiBOf(const std::string& process, const std::string& line);

}  // namespace ballpiston

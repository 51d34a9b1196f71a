// Runs a program on its own pseudo-terminal, as a user at a keyboard does.
#pragma once

#include <sys/types.h>

#include <string>

#include "tests/support/process.h"

namespace ballpiston {

// The destructor kills the program if it still runs.
class TerminalProcess {
 public:
  explicit TerminalProcess(const ProcessOptions& options);
  ~TerminalProcess();
  TerminalProcess(const TerminalProcess&) = delete;
  TerminalProcess& operator=(const TerminalProcess&) = delete;

  // Every wait ends after 15 minutes with std::runtime_error.

  // Waits until the output holds the text. False if the program ended without it.
  bool WaitFor(const std::string& text);
  void Type(const std::string& keys);  // "\x03" is Ctrl-C
  void CloseTerminal();                // as when a terminal's window is closed: SIGHUP

  struct Outcome {
    int exit_code = -1;  // 128 + signal if a signal killed it
    std::string output;  // standard output and error
  };
  Outcome Wait();  // until the program ends; once

 private:
  bool Read();  // false at the end

  pid_t pid_ = 0;
  int terminal_ = -1;
  std::string output_;
};

}  // namespace ballpiston

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstring>

#include "absl/strings/str_replace.h"
#include "tests/questions/engine.h"

namespace ballpiston::questions {
namespace {

// A report as lines, in memory that child and parent share: the outcome, then check and text of
// each finding.
constexpr size_t kMostText = 1 << 20;

std::string Text(const Report& report) {
  std::string text = report.outcome;
  for (const Finding& finding : report.findings) {
    absl::StrAppend(&text, "\n", finding.check, "\n",
                    absl::StrReplaceAll(finding.what, {{"\n", " "}}));
  }
  return text.substr(0, kMostText - 1);
}

Report ReportFromText(const std::string& text) {
  const std::vector<std::string> lines = absl::StrSplit(text, '\n');
  Report report = {.outcome = lines[0]};
  for (size_t i = 1; i + 1 < lines.size(); i += 2) {
    report.findings.push_back({lines[i], lines[i + 1]});
  }
  return report;
}

[[noreturn]] void SendReport(const std::function<Report()>& ask, char* shared) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit limit = {kMostProcessorSeconds, kMostProcessorSeconds + 1}, no_core = {0, 0};
  setrlimit(RLIMIT_CPU, &limit);
  setrlimit(RLIMIT_CORE, &no_core);
  const std::string text = Text(ask());
  std::copy(text.begin(), text.end(), shared);
  _exit(EXIT_SUCCESS);
}

Finding Death(int status) {
  if (!WIFSIGNALED(status)) return {kCrashCheck, absl::StrCat("exit code ", WEXITSTATUS(status))};
  if (WTERMSIG(status) != SIGXCPU) {
    return {kCrashCheck, absl::StrCat("signal ", strsignal(WTERMSIG(status)))};
  }
  return {kEndCheck, absl::StrCat("no end after ", kMostProcessorSeconds, " s of processor time")};
}

}  // namespace

Report InChild(const std::function<Report()>& ask) {
  void* const shared =
      mmap(nullptr, kMostText, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  const pid_t child = shared == MAP_FAILED ? -1 : fork();
  if (child < 0) throw std::runtime_error(std::strerror(errno));
  if (child == 0) SendReport(ask, static_cast<char*>(shared));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  Report report = ReportFromText(static_cast<char*>(shared));
  munmap(shared, kMostText);
  if (status != 0) {
    report.outcome = "died";
    report.findings.push_back(Death(status));
  }
  return report;
}

}  // namespace ballpiston::questions

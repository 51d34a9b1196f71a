#include <sys/prctl.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstring>

#include "absl/strings/str_join.h"
#include "tests/questions/engine.h"

namespace ballpiston::questions {
namespace {

// The outcome, then check and text of each finding, and back.
std::string Text(const Report& report) {
  std::vector<std::string> words = {report.outcome};
  for (const Finding& finding : report.findings) {
    words.insert(words.end(), {finding.check, finding.what});
  }
  return absl::StrJoin(words, absl::string_view("\0", 1));
}

Report ReportFromText(const std::string& text) {
  const std::vector<std::string> words = absl::StrSplit(text, '\0');
  Report report = {.outcome = words[0]};
  for (size_t i = 1; i + 1 < words.size(); i += 2) {
    report.findings.push_back({words[i], words[i + 1]});
  }
  return report;
}

[[noreturn]] void SendReport(const std::function<Report()>& ask, int pipe) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit limit = {kMostProcessorSeconds, kMostProcessorSeconds + 1};
  setrlimit(RLIMIT_CPU, &limit);
  const rlimit no_core = {0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const std::string text = Text(ask());
  for (size_t sent = 0; sent < text.size();) {
    const ssize_t n = write(pipe, text.data() + sent, text.size() - sent);
    if (n < 0) _exit(EXIT_FAILURE);
    sent += static_cast<size_t>(n);
  }
  _exit(EXIT_SUCCESS);
}

std::string ReadAll(int pipe) {
  std::string text;
  char buffer[4096];
  for (ssize_t n = 1; n != 0;) {
    n = read(pipe, buffer, sizeof buffer);
    if (n < 0 && errno != EINTR) throw std::runtime_error(std::strerror(errno));
    if (n > 0) text.append(buffer, static_cast<size_t>(n));
  }
  return text;
}

Finding Death(int status) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) {
    return {kEndCheck,
            absl::StrCat("no end after ", kMostProcessorSeconds, " s of processor time")};
  }
  if (WIFSIGNALED(status)) {
    return {kCrashCheck, absl::StrCat("signal ", strsignal(WTERMSIG(status)))};
  }
  return {kCrashCheck, absl::StrCat("exit code ", WEXITSTATUS(status))};
}

}  // namespace

Report InChild(const std::function<Report()>& ask) {
  int ends[2] = {};
  if (pipe(ends) != 0) throw std::runtime_error(std::strerror(errno));
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(std::strerror(errno));
  if (child == 0) SendReport(ask, ends[1]);
  close(ends[1]);
  Report report = ReportFromText(ReadAll(ends[0]));
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != EXIT_SUCCESS) {
    report.outcome = "died";
    report.findings.push_back(Death(status));
  }
  return report;
}

}  // namespace ballpiston::questions

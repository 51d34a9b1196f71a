#include "tests/questions/report.h"

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace ballpiston::questions {
namespace {

std::string Unescaped(const std::string& text) {
  std::string plain;
  absl::CUnescape(text, &plain);
  return plain;
}

}  // namespace

std::string Text(const Report& report) {
  std::string text = absl::StrCat("outcome\t", report.outcome, "\n");
  for (const Finding& finding : report.findings) {
    absl::StrAppend(&text, "finding\t", finding.check, "\t", absl::CEscape(finding.what), "\n");
  }
  return text;
}

Report ReportFromText(const std::string& text) {
  Report report;
  for (const auto& line : absl::StrSplit(text, '\n')) {
    const std::vector<std::string> words = absl::StrSplit(line, '\t');
    if (words[0] == "outcome" && words.size() == 2) report.outcome = words[1];
    if (words[0] == "finding" && words.size() == 3) {
      report.findings.push_back({words[1], Unescaped(words[2])});
    }
  }
  return report;
}

}  // namespace ballpiston::questions

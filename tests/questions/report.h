// What became of a question.
#pragma once

#include <string>
#include <vector>

namespace ballpiston::questions {

struct Finding {
  std::string check;  // the name of the rule that is broken
  std::string what;
};

using Findings = std::vector<Finding>;

struct Report {
  std::string outcome;  // answered, refused, stopped, ...
  Findings findings = {};

  bool Breaks(const std::string& check) const {
    for (const Finding& finding : findings) {
      if (finding.check == check) return true;
    }
    return false;
  }
};

// One line of text for each item, and back.
std::string Text(const Report& report);
Report ReportFromText(const std::string& text);

}  // namespace ballpiston::questions

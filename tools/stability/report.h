// All tables of a run, and complaints about their contents.
#pragma once

#include <string>
#include <vector>

namespace ballpiston::stability {

struct Report {
  std::string text;  // Markdown
  // A sentence for each broken promise of an engine (no failures, no loss of energy). Also a
  // sentence for each kind of failure that no method shows: the zeros of this kind prove nothing.
  std::vector<std::string> complaints;
};

// `effort` is the fraction of the starts; 1 takes minutes. Prints progress on standard error.
Report MakeReport(double effort);

}  // namespace ballpiston::stability

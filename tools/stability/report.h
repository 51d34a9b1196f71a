// All tables of a run, and what in them must not be.
#ifndef BALLPISTON_TOOLS_STABILITY_REPORT_H_
#define BALLPISTON_TOOLS_STABILITY_REPORT_H_

#include <string>
#include <vector>

namespace ballpiston::stability {

struct Report {
  std::string text;  // Markdown
  // A sentence for each promise that is broken, and for each look that found no failure of any
  // method: its zeros would say nothing.
  std::vector<std::string> complaints;
};

// `effort` is the fraction of the starts: 1 takes minutes. Tells on standard error how far it is.
Report MakeReport(double effort);

}  // namespace ballpiston::stability

#endif  // BALLPISTON_TOOLS_STABILITY_REPORT_H_

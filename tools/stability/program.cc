#include "tools/stability/program.h"

#include <exception>

namespace ballpiston::stability {
namespace {

constexpr char kHelp[] =
    R"(usage: stability [--quick]

Runs every engine in every precision, and naive methods, in situations in which methods fail.
Counts the failures, measures the errors that models state, and prints tables in Markdown. This
takes about twelve minutes on one core. The starts are fixed: the same program gives the same
tables. Progress and errors go to standard error.

  --quick      run a thousandth of the starts (of slow methods sometimes none), and no model
               errors: seconds instead of minutes
  --help       print this text

Exit status: 0 success; 1 an engine failed although it promises zeros, or a stated model error does
not hold, or no method showed one kind of failure, or the tables cannot be computed or printed; 2
wrong arguments.
tools/stability/README.md explains the counted failures.
)";

// Whether standard output took the text.
bool Print(const std::string& text, std::ostream& out, std::ostream& error) {
  out << text << std::flush;
  if (!out) error << "stability: cannot write to standard output\n";
  return !out.fail();
}

}  // namespace

int RunProgram(const std::vector<std::string>& arguments,
               const std::function<Report(double effort)>& make_report, std::ostream& out,
               std::ostream& error) {
  double effort = 1;
  for (const std::string& argument : arguments) {
    if (argument == "--help" || argument == "-h") return Print(kHelp, out, error) ? 0 : 1;
    if (argument != "--quick") {
      error << "stability: unknown argument '" << argument << "'; see stability --help\n";
      return 2;
    }
    effort = 1e-3;
  }
  try {
    const Report report = make_report(effort);
    const bool printed = Print(report.text, out, error);
    for (const std::string& complaint : report.complaints) {
      error << "stability: " << complaint << "\n";
    }
    return printed && report.complaints.empty() ? 0 : 1;
  } catch (const std::exception& failure) {
    error << "stability: cannot compute the tables: " << failure.what() << "\n";
    return 1;
  }
}

}  // namespace ballpiston::stability

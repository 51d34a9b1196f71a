#include "tools/stability/program.h"

#include <exception>
#include <optional>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "tools/stability/marked_section.h"
#include "tools/stability/output_file.h"

namespace ballpiston::stability {
namespace {

constexpr char kSection[] = "stability";

constexpr char kHelp[] =
    R"(usage: stability [--quick] [--out FILE | --into FILE]

Runs every engine in every precision, and naive methods, in situations in which methods fail.
Counts the failures, measures the errors that models state, and prints tables in Markdown. This
takes about twelve minutes on one core. The starts are fixed: the same program gives the same
tables.

  --quick      run a thousandth of the starts (of slow methods sometimes none) and a tenth of the
               reversals, and no model errors: seconds instead of minutes
  --out FILE   write the tables to FILE instead; an existing FILE is replaced
  --into FILE  write the tables into FILE instead, between the two lines
                 <!-- stability:begin -->
                 <!-- stability:end -->
  --help       print this text

Exit status: 0 success; 1 an engine failed although it promises zeros, or a stated model error does
not hold, or no method showed one kind of failure, or the tables cannot be computed, or FILE cannot
be written; 2 wrong arguments.
tools/stability/README.md explains the counted failures.
)";

struct Options {
  bool help = false;
  bool quick = false;
  std::string out;  // at most one of `out` and `into` is not empty
  std::string into;
};

absl::StatusOr<Options> Parse(const std::vector<std::string>& arguments) {
  Options options;
  for (size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (argument == "--help" || argument == "-h") {
      options.help = true;
    } else if (argument == "--quick") {
      options.quick = true;
    } else if (argument == "--out" || argument == "--into") {
      if (i + 1 == arguments.size() || arguments[i + 1].empty()) {
        return absl::InvalidArgumentError(absl::StrCat(argument, " needs the name of a file"));
      }
      (argument == "--out" ? options.out : options.into) = arguments[++i];
    } else {
      return absl::InvalidArgumentError(absl::StrCat("unknown argument '", argument, "'"));
    }
  }
  if (!options.out.empty() && !options.into.empty()) {
    return absl::InvalidArgumentError("--out and --into exclude each other");
  }
  return options;
}

absl::Status CheckDestination(const Options& options) {
  if (!options.out.empty()) return CheckWritable(options.out);
  if (!options.into.empty()) return CheckMarkedSection(options.into, kSection);
  return absl::OkStatus();
}

absl::Status WriteFile(const Options& options, const std::string& text) {
  if (!options.out.empty()) return WriteWholeFile(options.out, text);
  return ReplaceMarkedSection(options.into, kSection, text);
}

absl::Status Print(const std::string& text, std::ostream& out) {
  out << text << std::flush;
  return out ? absl::OkStatus() : absl::DataLossError("cannot write to standard output");
}

// Writes the tables to their destination, and errors to `error`. False if this destination failed.
bool Deliver(const Options& options, const std::string& text, std::ostream& out,
             std::ostream& error) {
  const bool to_file = !options.out.empty() || !options.into.empty();
  const absl::Status delivered = to_file ? WriteFile(options, text) : Print(text, out);
  if (!delivered.ok()) error << "stability: " << delivered.message() << "\n";
  if (!to_file) return delivered.ok();
  if (delivered.ok()) {
    error << "stability: the tables are in " << options.out << options.into << "\n";
    return true;
  }
  error << "stability: the tables go to standard output instead\n";
  const absl::Status printed = Print(text, out);
  if (!printed.ok()) error << "stability: " << printed.message() << "\n";
  return false;
}

// The report; empty if it cannot be made, and then the reason is written to `error`.
std::optional<Report> Made(const std::function<Report(double effort)>& make_report, double effort,
                           std::ostream& error) {
  try {
    return make_report(effort);
  } catch (const std::exception& failure) {
    error << "stability: cannot compute the tables: " << failure.what() << "\n";
    return std::nullopt;
  }
}

}  // namespace

int RunProgram(const std::vector<std::string>& arguments,
               const std::function<Report(double effort)>& make_report, std::ostream& out,
               std::ostream& error) {
  const absl::StatusOr<Options> options = Parse(arguments);
  if (!options.ok()) {
    error << "stability: " << options.status().message() << "; see stability --help\n";
    return 2;
  }
  if (options->help) return Print(kHelp, out).ok() ? 0 : 1;
  const absl::Status writable = CheckDestination(*options);
  if (!writable.ok()) {
    error << "stability: " << writable.message() << "\n";
    return 1;
  }
  const std::optional<Report> report = Made(make_report, options->quick ? 1e-3 : 1, error);
  if (!report) return 1;
  const bool delivered = Deliver(*options, report->text, out, error);
  for (const std::string& complaint : report->complaints) {
    error << "stability: " << complaint << "\n";
  }
  return delivered && report->complaints.empty() ? 0 : 1;
}

}  // namespace ballpiston::stability

#include "tools/method_comparison/program.h"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "core/arithmetic/number_text.h"
#include "tools/method_comparison/method_comparison.h"

namespace ballpiston::method_comparison {
namespace {

std::string JsonLine(const MethodMeasurement& m) {
  return absl::StrFormat(
      R"({"method":"%s","time_step":%s,"quantity":"%s","delta":%s,"samples":%d,"wall_hits":%d,)"
      R"("work_seconds":%s,"value":%s,"statistical_error":%s})",
      Name(m.method), NumberText(m.time_step), Name(m.quantity), NumberText(m.delta), m.samples,
      m.wall_hits, NumberText(m.work), NumberText(m.value), NumberText(m.statistical_error));
}

void AddFlags(CLI::App& app, MethodComparisonSpec& spec) {
  app.add_option("--rho", spec.rho, "radius of the discs")->capture_default_str();
  app.add_option("--delta", spec.delta, "how far the piston reaches")->capture_default_str();
  app.add_option("--epsilon", spec.epsilon, "energy of the piston, between 0 and 1/2")
      ->capture_default_str();
  app.add_option("--relaxation-delta", spec.relaxation_deltas,
                 "LIST a,b,c of at most 8 delta at which relaxation times are compared; if not "
                 "given those of 0.2,0.1,0.05,0.025 that rho permits")
      ->delimiter(',');
  app.add_option("--seconds", spec.seconds_per_curve,
                 "work of each method's largest run, 0.01 to 60. The program takes some 50 times "
                 "as long, and 10 times more for each delta of a relaxation time")
      ->capture_default_str();
  app.add_option("--seed", spec.seed, "of the random numbers")->capture_default_str();
}

// Prints the measurements; false if they cannot be written.
bool Print(const MethodComparisonSpec& spec, std::ostream& out) {
  CompareMethods(spec, [&out](const MethodMeasurement& measurement) {
    out << JsonLine(measurement) << std::endl;  // whoever reads it gets it now
  });
  return out.good();
}

}  // namespace

int RunProgram(int argc, const char* const* argv, std::ostream& out, std::ostream& error) {
  MethodComparisonSpec spec;
  CLI::App app(
      "Measures what every method of computing the ball-piston pair gives for how much work, on\n"
      "one core of this machine, and prints a JSON object a line for each measurement.",
      "method_comparison");
  AddFlags(app, spec);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& parse_error) {
    return app.exit(parse_error, out, error) == 0 ? 0 : 2;
  }
  if (app.count("--relaxation-delta") == 0) {
    spec.relaxation_deltas = DefaultRelaxationDeltas(spec.rho);
  }
  const std::vector<std::string> violations = Violations(spec);
  for (const std::string& violation : violations) {
    error << "method_comparison: " << violation << "\n";
  }
  if (!violations.empty()) return 2;
  if (Print(spec, out)) return 0;
  error << "method_comparison: cannot write to standard output\n";
  return 1;
}

}  // namespace ballpiston::method_comparison

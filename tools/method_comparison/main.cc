// Measures the error and the work of every method of computing the pair on this machine.
//
// Prints CSV: a header, then one row for each measurement, as soon as it is made:
//
//   rho,delta,epsilon,method,time_step,quantity,samples,wall_hits,work_seconds,value,...
//   0.53,0.1,0.125,billiard,0,mean-free-time,4096,301923,0.0031,0.012,...
//
// The last columns are statistical_error, own_error and bias_resolved (1 or 0). rho and epsilon are
// the values of the spec; method_comparison.h explains the other columns, method.h the names. A
// number reads back as the same double. The field of an unknown value is empty.
//
// Progress is one line on standard error, which is redrawn, and cleared at the end. README.md has
// the exit status. If a panel of the chart would be empty, all rows are still printed.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/arithmetic/number_text.h"
#include "server/number_range.h"
#include "tools/method_comparison/method_comparison.h"

namespace ballpiston::method_comparison {
namespace {

// Errors from fewer samples are too uncertain; the chart does not draw them.
constexpr uint64_t kFewestDrawn = 64;

constexpr char kHeader[] =
    "rho,delta,epsilon,method,time_step,quantity,samples,wall_hits,work_seconds,value,"
    "statistical_error,own_error,bias_resolved";

std::string Row(const MethodComparisonSpec& spec, const MethodMeasurement& m) {
  return absl::StrFormat("%s,%s,%s,%s,%s,%s,%d,%d,%s,%s,%s,%s,%s", NumberText(spec.rho),
                         NumberText(m.delta), NumberText(spec.epsilon), m.method.name,
                         NumberText(m.method.time_step), Name(m.quantity), m.samples, m.wall_hits,
                         NumberText(m.work), NumberText(m.value), NumberText(m.statistical_error),
                         NumberText(m.own_error),
                         m.bias_resolved ? absl::StrCat(*m.bias_resolved) : "");
}

// mean-free-time, fixed-step 0.01: 8192 samples in 0.12 s
std::string ProgressText(const MethodMeasurement& m) {
  return absl::StrFormat("%s, %s%s: %d samples in %.3g s", Name(m.quantity), m.method.name,
                         m.method.time_step > 0 ? absl::StrFormat(" %.4g", m.method.time_step) : "",
                         m.samples, m.work);
}

void AddFlags(CLI::App& app, MethodComparisonSpec& spec, std::string& progress) {
  app.add_option("--rho", spec.rho, "radius of the discs")->capture_default_str();
  app.add_option(
         "--delta", spec.delta,
         "how far the piston reaches, for panels a to d of the chart. It does not change "
         "panel e (see --relaxation-delta), nor f, the heat current, whose delta is 0.2, or "
         "the bound of a gas if that is smaller")
      ->capture_default_str();
  app.add_option("--epsilon", spec.epsilon, "energy of the piston, between 0 and 1/2")
      ->capture_default_str();
  app.add_option("--relaxation-delta", spec.relaxation_deltas,
                 "LIST a,b,c of at most 8 delta at which relaxation times are compared; by default "
                 "(or if empty) 0.2,0.1,0.05,0.025, as far as rho permits them")
      ->delimiter(',')
      ->expected(0, -1);
  app.add_option("--seconds", spec.seconds_per_curve,
                 "work of each method's largest run, 0.01 to 60. The program takes about 70 times "
                 "as long, and 10 times more for each delta of a relaxation time")
      ->capture_default_str();
  app.add_option("--seed", spec.seed, "of the random numbers")
      ->transform(server::Between<uint64_t>(0, 1e15))
      ->capture_default_str();
  app.add_option("--progress", progress,
                 "bar | none, on standard error; bar if it is a terminal and the flag is not given")
      ->check(CLI::IsMember({"bar", "none"}));
}

// Prints the measurements. Returns the quantities that the chart shows, without those that have no
// measurement of kFewestDrawn samples.
std::set<Quantity> Print(const MethodComparisonSpec& spec, bool bar) {
  std::set<Quantity> drawn;
  int measurements = 0;
  std::cout << kHeader << std::endl;
  CompareMethods(spec, [&](const MethodMeasurement& m) {
    std::cout << Row(spec, m) << std::endl;  // std::endl flushes: a reader gets each row at once
    if (m.samples >= kFewestDrawn) drawn.insert(m.quantity);
    if (bar)
      std::cerr << absl::StrFormat("\r%3d measurements  %s\x1b[K", ++measurements, ProgressText(m));
  });
  if (bar) std::cerr << "\r\x1b[K";
  return drawn;
}

int Run(int argc, char** argv) {
  MethodComparisonSpec spec;
  CLI::App app(
      "Measures the error and the work of every method of computing the ball-piston pair, and the\n"
      "gas, on one core of this machine, and prints CSV with a row for each measurement.",
      "method_comparison");
  std::string progress = isatty(STDERR_FILENO) != 0 ? "bar" : "none";
  AddFlags(app, spec, progress);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& parse_error) {
    return app.exit(parse_error) == 0 ? 0 : 2;
  }
  if (absl::StrJoin(app.get_option("--relaxation-delta")->results(), "").empty()) {
    spec.relaxation_deltas = DefaultRelaxationDeltas(spec.rho);
  }
  const std::vector<std::string> violations = Violations(spec);
  for (const std::string& violation : violations) {
    std::cerr << "method_comparison: " << violation << "\n";
  }
  if (!violations.empty()) return 2;
  const std::set<Quantity> drawn = Print(spec, progress == "bar");
  if (!std::cout.good()) {
    std::cerr << "method_comparison: cannot write to standard output\n";
    return 1;
  }
  for (const auto quantity :
       {Quantity::kMeanFreeTime, Quantity::kIngoingLaw, Quantity::kTrajectory}) {
    if (drawn.contains(quantity)) continue;
    std::cerr << absl::StrFormat(
        "method_comparison: no method has %d samples of %s in that time: nothing to draw; choose "
        "more --seconds or a larger --delta\n",
        kFewestDrawn, Name(quantity));
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace ballpiston::method_comparison

int main(int argc, char** argv) { return ballpiston::method_comparison::Run(argc, argv); }

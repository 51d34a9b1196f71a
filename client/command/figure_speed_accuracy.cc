// The chart of speed against accuracy: one comparison of all methods, on this machine.
#include <signal.h>

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/command/comparison_program.h"
#include "client/command/figures.h"
#include "client/command/number_list.h"
#include "client/command/violations.h"
#include "client/figure/comparison_progress.h"
#include "client/figure/speed_accuracy_figure.h"

namespace ballpiston::client {
namespace {

// The program exits with 1 if it cannot write its output, and with this code if a flag is wrong.
constexpr int kWrongFlags = 2;

// Runs the program; `*measurements` are what it printed.
absl::StatusOr<ExitCode> Compare(const SpeedAccuracyQuestion& question, const FigureTools& tools,
                                 std::vector<MethodMeasurement>& measurements) {
  ComparisonProgress progress(tools.style, tools.terminal.err);
  absl::Status parsed;
  const absl::StatusOr<int> status =
      RunComparisonProgram(ComparisonFlags(question), tools.interrupts, [&](const auto& line) {
        auto measurement = ParseMeasurement(line);
        parsed.Update(measurement.status());
        if (!measurement.ok()) return;
        progress.OnMeasurement(*measurement, line);
        measurements.push_back(*std::move(measurement));
      });
  if (!status.ok()) return status.status();
  if (*status == 128 + SIGINT) return ExitCode::kInterrupted;
  if (*status == kWrongFlags) return ExitCode::kUsage;  // the program has named the flags
  if (!parsed.ok()) return parsed;
  if (*status == 0) return ExitCode::kDone;
  return absl::InternalError(absl::StrCat(kComparisonProgram, " ended with exit status ", *status));
}

absl::StatusOr<ExitCode> Make(const SpeedAccuracyQuestion& question, const FigureTools& tools) {
  if (!tools.server.Text().empty()) {
    tools.terminal.err << "ballpiston: the figure " << kSpeedAccuracyFigure
                       << " is measured on this machine, not on a server\n";
  }
  std::vector<MethodMeasurement> measurements;
  const absl::StatusOr<ExitCode> end = Compare(question, tools, measurements);
  if (!end.ok() || *end != ExitCode::kDone) return end;
  const absl::StatusOr<SpeedAccuracyFiles> files = MakeFiles(question, measurements);
  if (!files.ok()) return files.status();
  const std::pair<const char*, const std::string&> contents[] = {{".csv", files->csv},
                                                                 {".gnuplot", files->script}};
  for (const auto& [suffix, content] : contents) {
    const std::string name = absl::StrCat(kSpeedAccuracyFigure, suffix);
    if (absl::Status status = tools.folder.Write(name, content, tools.terminal); !status.ok())
      return status;
  }
  return tools.folder.Draw(kSpeedAccuracyFigure, tools.terminal);
}

}  // namespace

absl::StatusOr<MakeFigure> PlanSpeedAccuracy(const FigureFlags& flags) {
  SpeedAccuracyQuestion question;
  Violations violations;
  const auto take = [&violations](auto parsed, auto& into) {
    if (parsed.ok()) into = *std::move(parsed);
    violations.Add(parsed.status());
  };
  if (flags.rho) take(ParseNumber("--rho", *flags.rho), question.rho);
  if (flags.delta) take(ParseNumber("--delta", *flags.delta), question.delta);
  if (flags.relaxation_delta) {
    take(ParseNumberList("--relaxation-delta", *flags.relaxation_delta),
         question.relaxation_deltas);
  }
  if (flags.epsilon) take(ParseNumber("--epsilon", *flags.epsilon), question.epsilon);
  if (flags.seconds) take(ParseNumber("--seconds", *flags.seconds), question.seconds_per_curve);
  if (flags.seed) take(ParseSeed("--seed", *flags.seed), question.seed);
  violations.Add(RefuseFlag("--samples", flags.samples, kSpeedAccuracyFigure));
  if (absl::Status bad = violations.Lines(); !bad.ok()) return bad;
  return [question](const FigureTools& tools) { return Make(question, tools); };
}

}  // namespace ballpiston::client

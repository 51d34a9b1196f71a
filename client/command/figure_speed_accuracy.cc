// The chart of speed against accuracy: one comparison of all methods. Ctrl-C ends it, on the server
// too.
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/command/figures.h"
#include "client/command/number_list.h"
#include "client/command/violations.h"
#include "client/figure/speed_accuracy_figure.h"
#include "client/library/method_client.h"
#include "client/output/comparison_progress.h"

namespace ballpiston::client {
namespace {

absl::StatusOr<std::vector<v1::MethodMeasurement>> Compare(const SpeedAccuracyQuestion& question,
                                                           const FigureTools& tools) {
  const MethodClient client(tools.connection.channel);
  const v1::CompareMethodsRequest request = ComparisonRequest(question);
  ComparisonProgress progress(tools.style, tools.terminal.err);
  std::vector<v1::MethodMeasurement> measurements;
  const absl::Status ended = tools.connection.Ask([&] {
    measurements.clear();  // of an attempt before
    progress.Begin();
    return client.CompareMethods(request, [&](const v1::MethodMeasurement& measurement) {
      measurements.push_back(measurement);
      progress.OnMeasurement(measurement);
    });
  });
  if (!ended.ok()) return ended;
  return measurements;
}

absl::StatusOr<ExitCode> Make(const SpeedAccuracyQuestion& question, const FigureTools& tools) {
  const auto measurements = Compare(question, tools);
  if (!measurements.ok()) return measurements.status();
  const absl::StatusOr<SpeedAccuracyFiles> files = MakeFiles(question, *measurements);
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

#include "client/figure/speed_accuracy_figure.h"

#include <algorithm>
#include <cmath>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/figure/speed_accuracy_script.h"
#include "client/output/number_text.h"

namespace ballpiston::client {
namespace {

std::string ResolvedText(const MethodMeasurement& measurement) {
  if (measurement.quantity == kTrajectory) return "";
  return IsBiasResolved(measurement) ? "1" : "0";
}

std::string Row(const MethodMeasurement& measurement) {
  return absl::StrJoin({measurement.method, ExactText(measurement.time_step), measurement.quantity,
                        ExactText(measurement.delta), absl::StrCat(measurement.samples),
                        absl::StrCat(measurement.wall_hits), ExactText(measurement.work),
                        ExactText(measurement.value), ExactText(measurement.statistical_error),
                        ResolvedText(measurement)},
                       ",");
}

std::string Csv(const std::vector<MethodMeasurement>& measurements) {
  std::string csv =
      "method,time_step,quantity,delta,samples,wall_hits,work_seconds,value,statistical_error,"
      "bias_resolved\n";
  for (const MethodMeasurement& measurement : measurements) {
    absl::StrAppend(&csv, Row(measurement), "\n");
  }
  return csv;
}

absl::Status CheckEachPanelHasRuns(const std::vector<MethodMeasurement>& measurements) {
  for (const auto quantity : {kMeanFreeTime, kIngoingLaw, kTrajectory}) {
    const auto shows = [quantity](const auto& m) {
      return m.quantity == quantity && m.samples >= kFewestDrawn;
    };
    if (std::any_of(measurements.begin(), measurements.end(), shows)) continue;
    return absl::FailedPreconditionError(
        absl::StrCat("no method has ", kFewestDrawn, " samples of ", quantity,
                     " in that time: nothing to draw; choose more --seconds, or a larger --delta"));
  }
  return absl::OkStatus();
}

}  // namespace

std::vector<std::string> ComparisonFlags(const SpeedAccuracyQuestion& question) {
  std::vector<std::string> flags = {
      absl::StrCat("--rho=", ExactText(question.rho)),
      absl::StrCat("--delta=", ExactText(question.delta)),
      absl::StrCat("--epsilon=", ExactText(question.epsilon)),
      absl::StrCat("--seconds=", ExactText(question.seconds_per_curve)),
      absl::StrCat("--seed=", question.seed)};
  for (const double delta : question.relaxation_deltas) {
    flags.push_back(absl::StrCat("--relaxation-delta=", ExactText(delta)));
  }
  return flags;
}

bool IsBiasResolved(const MethodMeasurement& measurement) {
  return measurement.quantity != kTrajectory &&
         measurement.value > kResolved * measurement.statistical_error;
}

absl::StatusOr<SpeedAccuracyFiles> MakeFiles(const SpeedAccuracyQuestion& question,
                                             const std::vector<MethodMeasurement>& measurements) {
  if (absl::Status bad = CheckEachPanelHasRuns(measurements); !bad.ok()) return bad;
  return SpeedAccuracyFiles{.csv = Csv(measurements),
                            .script = SpeedAccuracyScript(question, measurements)};
}

}  // namespace ballpiston::client

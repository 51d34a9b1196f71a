#include "client/figure/speed_accuracy_figure.h"

#include <algorithm>
#include <cmath>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/figure/speed_accuracy_script.h"
#include "client/output/number_text.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

using v1::MethodMeasurement;

std::string ResolvedText(const MethodMeasurement& measurement) {
  if (measurement.quantity() == MethodMeasurement::TRAJECTORY) return "";
  return IsBiasResolved(measurement) ? "1" : "0";
}

std::string Row(const MethodMeasurement& measurement) {
  return absl::StrJoin({Spelling(measurement.method()), ExactText(measurement.time_step()),
                        Spelling(measurement.quantity()), ExactText(measurement.delta()),
                        absl::StrCat(measurement.samples()), absl::StrCat(measurement.wall_hits()),
                        ExactText(measurement.work()), ExactText(measurement.value()),
                        ExactText(measurement.statistical_error()), ResolvedText(measurement)},
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
  for (const auto quantity : {MethodMeasurement::MEAN_FREE_TIME, MethodMeasurement::INGOING_LAW,
                              MethodMeasurement::TRAJECTORY}) {
    const auto shows = [quantity](const auto& m) {
      return m.quantity() == quantity && m.samples() >= kFewestDrawn;
    };
    if (std::any_of(measurements.begin(), measurements.end(), shows)) continue;
    return absl::FailedPreconditionError(
        absl::StrCat("no method has ", kFewestDrawn, " samples of ", Spelling(quantity),
                     " in that time: nothing to draw; choose more --seconds, or a larger --delta"));
  }
  return absl::OkStatus();
}

}  // namespace

v1::CompareMethodsRequest ComparisonRequest(const SpeedAccuracyQuestion& question) {
  v1::CompareMethodsRequest request;
  request.set_rho(question.rho);
  request.set_delta(question.delta);
  request.set_epsilon(question.epsilon);
  request.set_seconds_per_curve(question.seconds_per_curve);
  request.set_seed(question.seed);
  request.mutable_relaxation_delta()->Add(question.relaxation_deltas.begin(),
                                          question.relaxation_deltas.end());
  return request;
}

bool IsBiasResolved(const MethodMeasurement& measurement) {
  return measurement.quantity() != MethodMeasurement::TRAJECTORY &&
         measurement.value() > kResolved * measurement.statistical_error();
}

absl::StatusOr<SpeedAccuracyFiles> MakeFiles(const SpeedAccuracyQuestion& question,
                                             const std::vector<MethodMeasurement>& measurements) {
  if (absl::Status bad = CheckEachPanelHasRuns(measurements); !bad.ok()) return bad;
  return SpeedAccuracyFiles{.csv = Csv(measurements),
                            .script = SpeedAccuracyScript(question, measurements)};
}

}  // namespace ballpiston::client

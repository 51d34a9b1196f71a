#include <algorithm>

#include "server/api/methods.h"
#include "server/convert/errors.h"
#include "server/convert/plan.h"
#include "server/convert/spec.h"

namespace ballpiston::server {
namespace {

// More points than this are planned by as many of them, evenly spread.
constexpr size_t kMostPoints = 1000;

}  // namespace

absl::StatusOr<v1::PlanEnsembleJobResponse> PlanEnsembleJob(
    ServiceContext& service, const v1::PlanEnsembleJobRequest& request) {
  const CheckedSpec checked = CheckSpec(request.spec());
  if (!checked.violations.empty()) return InvalidSpec(checked.violations);
  const size_t points = PointCount(checked.spec), planned = std::min(points, kMostPoints);
  v1::PlanEnsembleJobResponse response;
  double work = 0;
  for (size_t i = 0; i < planned; ++i) {
    const PointParameters point = PointAt(checked.spec, i * points / planned);
    const Ladder ladder = service.ladder.LadderOf(checked.spec, point);
    work += ladder.Chosen().work.value_or(0);
    *response.add_points() = PointPlanMessage(point, ladder);
  }
  const Machine& machine = service.ladder.machine();
  response.set_point_count(static_cast<int32_t>(points));
  response.set_work(machine.rates.first_point +
                    work * static_cast<double>(points) / static_cast<double>(planned));
  response.set_time(response.work() / machine.workers);
  response.set_workers(machine.workers);
  *response.mutable_rates() = RatesMessage(machine.rates);
  return response;
}

}  // namespace ballpiston::server

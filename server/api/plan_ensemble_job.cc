#include <algorithm>
#include <set>

#include "server/api/methods.h"
#include "server/convert/errors.h"
#include "server/convert/plan.h"
#include "server/convert/spec.h"

namespace ballpiston::server {
namespace {

// More points than this are planned by as many of them, evenly spread.
constexpr size_t kMostPoints = 1000;

struct PlannedWork {
  double points = 0;
  double pilots = 0;  // each run once, by one worker
};

}  // namespace

absl::StatusOr<v1::PlanEnsembleJobResponse> PlanEnsembleJob(
    ServiceContext& service, const Call&, const v1::PlanEnsembleJobRequest& request) {
  const CheckedSpec checked = CheckSpec(request.spec());
  if (!checked.violations.empty()) return InvalidSpec(checked.violations);
  const size_t points = PointCount(checked.spec), planned = std::min(points, kMostPoints);
  v1::PlanEnsembleJobResponse response;
  PlannedWork work;
  std::set<PilotPlace> pilots;
  for (size_t i = 0; i < planned; ++i) {
    const PointParameters point = PointAt(checked.spec, i * points / planned);
    Ladder ladder = service.ladder.LadderOf(checked.spec, point);
    if (ladder.pilot && !pilots.insert(*ladder.pilot).second) ladder.DropPilot();
    work.pilots += ladder.work_of_pilot;
    work.points += ladder.Chosen().work.value_or(0) - ladder.work_of_pilot;
    *response.add_points() = PointPlanMessage(point, ladder);
  }
  const Machine& machine = service.ladder.machine();
  work.points *= static_cast<double>(points) / static_cast<double>(planned);
  work.points += machine.rates.first_point;
  response.set_point_count(static_cast<int32_t>(points));
  response.set_work(work.points + work.pilots);
  response.set_time(work.points / machine.workers + work.pilots);
  response.set_workers(machine.workers);
  *response.mutable_rates() = RatesMessage(machine.rates);
  return response;
}

}  // namespace ballpiston::server

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/convert/errors.h"
#include "server/convert/plan.h"
#include "server/convert/spec.h"
#include "server/machine_limits.h"
#include "server/rpc/methods.h"

namespace ballpiston::server {
namespace {

// A plan uses at most this many points of the grid.
constexpr size_t kMostPoints = 1000;

// Seconds of the store's thread to store one of many results of points without samples, while other
// threads compute. Measured as the mean over 30,000 results that are recorded and flushed, on a
// Xeon with a virtual disk: 7 and 11 us of processor time. The rest is the time of the disk.
constexpr double kSecondsToStoreClosedForm = 1e-5;
constexpr double kSecondsToStoreSpectrum = 1.5e-5;  // its result has curves
// Additional seconds of a job's first point, because caches are cold. Measured on the same machine
// as the time to serve a closed form after the caches were overwritten: 60 to 120 us.
constexpr double kSecondsOfAFirstPoint = 8e-5;

// In seconds of processor time.
struct PlannedWork {
  double points = 0;
  double stored = 0;   // of the store's thread
  double longest = 0;  // by the clock, of a point with few samples, which do not occupy all workers

  // Workers and the store's thread share the cores.
  double Time(int workers) const {
    static const double cores = MachineCores();
    return std::max({points / workers, stored, (points + stored) / cores, longest});
  }
};

// The index of point i of `planned`, each in one of as many equal parts of the grid. Its place in
// its part follows the golden ratio, so that no list of the grid is seen at one of its values only.
size_t IndexOf(size_t i, size_t planned, size_t points) {
  const auto part = static_cast<double>(i);
  const double place = part + std::fmod(part * (std::numbers::phi - 1), 1.0);
  return static_cast<size_t>(place * static_cast<double>(points) / static_cast<double>(planned));
}

double SecondsToStore(const Ladder& ladder) {
  return ladder.answer.model == Model::kSpectrum ? kSecondsToStoreSpectrum
                                                 : kSecondsToStoreClosedForm;
}

}  // namespace

absl::StatusOr<v1::PlanEnsembleJobResponse> PlanEnsembleJob(
    ServiceContext& service, const Call& call, const v1::PlanEnsembleJobRequest& request) {
  CheckedSpec checked = CheckSpec(request.spec());
  if (checked.violations.empty()) {
    AddViolations(service.ladder.ViolationsHere(checked.spec), checked);
  }
  if (!checked.violations.empty()) return InvalidSpec(checked.violations);
  const size_t points = PointCount(checked.spec), planned = std::min(points, kMostPoints);
  v1::PlanEnsembleJobResponse response;
  PlannedWork work;
  const Machine& machine = service.ladder.machine();
  for (size_t i = 0; i < planned; ++i) {
    if (call.is_abandoned()) return absl::CancelledError("the client is gone");
    const PointParameters point = PointAt(checked.spec, IndexOf(i, planned, points));
    const Ladder ladder = LadderFor(checked.spec, point, machine);
    work.points += ladder.Chosen().work.value_or(0);
    work.longest = std::max(work.longest, ladder.Chosen().time);
    work.stored += SecondsToStore(ladder);
    response.set_memory(std::max(response.memory(), ladder.Chosen().memory));
    *response.add_points() = PointPlanMessage(point, ladder);
  }
  const double share = static_cast<double>(points) / static_cast<double>(planned);
  work.points *= share;
  work.stored *= share;
  work.points += kSecondsOfAFirstPoint;
  response.set_point_count(static_cast<int32_t>(points));
  response.set_work(work.points);
  response.set_time(work.Time(machine.workers));
  response.set_workers(machine.workers);
  return response;
}

}  // namespace ballpiston::server

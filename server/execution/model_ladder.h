// Chooses the model that answers a point, with the rates of this server and the pilots that it has
// run.
//
// The server measures rates when they are first needed (about 0.3 s) and keeps them until it stops.
// The rates of points without samples include all work to serve them. The store keeps pilots. The
// first worker that needs a pilot runs it, once for each place; other workers that need the same
// pilot wait. If a pilot cannot be read, it is run again; if it cannot be stored, its result is
// still used. Thread-safe.
#ifndef BALLPISTON_SERVER_EXECUTION_MODEL_LADDER_H_
#define BALLPISTON_SERVER_EXECUTION_MODEL_LADDER_H_

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>

#include "core/model_choice/ladder.h"
#include "server/execution/run.h"
#include "server/store/store.h"

namespace ballpiston::server {

using PilotRunner = std::function<std::optional<Pilot>(const PilotPlace&, std::stop_token)>;

class ModelLadder {
 public:
  // The store must outlive the ladder, and the ladder its factory. `run_pilot` runs pilots.
  ModelLadder(Store& store, int workers, PilotRunner run_pilot = RunPilot);

  // The core's experiments, each by the model that was asked for or chosen.
  ExperimentFactory ChosenExperiments();

  // Runs nothing but the measurement of the rates.
  Ladder LadderOf(const EnsembleSpec& spec, const PointParameters& point);

  const Machine& machine();

 private:
  void Measure();
  // Does all the work that serves a point without samples.
  void Serve(const EnsembleSpec& spec);
  std::unique_ptr<const PointExperiment> Create(const EnsembleSpec& spec, size_t index,
                                                const std::stop_token& stop);
  std::optional<Pilot> Known(const PilotPlace& place);
  // Empty if stop was requested.
  std::optional<Pilot> Get(const PilotPlace& place, const std::stop_token& stop);
  std::optional<Pilot> Run(const PilotPlace& place, const std::stop_token& stop);
  void Keep(const PilotPlace& place, const Pilot& pilot);

  Store& store_;
  const int workers_;
  const PilotRunner run_pilot_;
  std::once_flag measured_;
  Machine machine_;

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::map<PilotPlace, Pilot> pilots_;  // a cache of the store
  std::set<PilotPlace> running_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_EXECUTION_MODEL_LADDER_H_

// The ladder of models on this server: which model answers a point, with the server's own rates and
// the pilots that it has run.
//
// Rates are measured when they are first needed (some 0.3 s), and kept for the server's life; those
// of points without samples with all that it takes to serve them.
// Pilots are kept in the store: one is run once for each place, by the worker that first needs it;
// others that need the same wait for it. A pilot that cannot be stored or read is none the worse
// for its own question. Thread-safe.
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
  // The store has to outlive this, and this the factory. Pilots are run by `run_pilot`.
  ModelLadder(Store& store, int workers, PilotRunner run_pilot = RunPilot);

  // The core's experiments, each by the model that was asked for or chosen.
  ExperimentFactory ChosenExperiments();

  // Runs nothing but the measurement of the rates.
  Ladder LadderOf(const EnsembleSpec& spec, const PointParameters& point);

  const Machine& machine();

 private:
  void Measure();
  // All that a point without samples takes.
  void Serve(const EnsembleSpec& spec);
  std::unique_ptr<const PointExperiment> Create(const EnsembleSpec& spec, size_t index,
                                                const std::stop_token& stop);
  std::optional<Pilot> Known(const PilotPlace& place);
  // Empty if it was told to stop.
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
  std::map<PilotPlace, Pilot> pilots_;  // as in the store, as far as they were asked for
  std::set<PilotPlace> running_;
};

}  // namespace ballpiston::server

#endif  // BALLPISTON_SERVER_EXECUTION_MODEL_LADDER_H_

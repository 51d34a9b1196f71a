#include "core/ensemble/block_run.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_fold.h"
#include "core/model_choice/sampling_cost.h"
#include "server/convert/point_result.h"
#include "tests/questions/engine.h"

namespace ballpiston::questions {
namespace {

// Hands out all blocks, and asks for a pause at once.
class ImpatientQueue : public BlockQueue {
 public:
  explicit ImpatientQueue(LocalPoint& point) : point_(point) {}

  std::optional<Block> Next() override { return point_.NextBlock(); }
  void Done(const Block& block, BlockResult result) override {
    point_.Add(block, std::move(result));
  }
  bool Pause() override {
    stop_.request_stop();
    return true;
  }
  std::stop_token stop() const override { return stop_.get_token(); }

 private:
  LocalPoint& point_;
  std::stop_source stop_;
};

}  // namespace

ComputedPoint ComputePoint(const EnsembleSpec& spec, size_t index, const Answer& answer) {
  const auto point = PointExperiment::Create(spec, index, answer);
  const PointSummary summary = point->Summarize(*FoldPoint(*point));
  return {server::WithDetails(server::ResultOf(index, *point, summary), server::DetailsOf(summary),
                              *spec.experiment),
          CheckFinite(summary)};
}

void StartAndStop(const EnsembleSpec& spec, size_t index, const Answer& answer) {
  const auto point = PointExperiment::Create(spec, index, answer);
  LocalPoint local(*point);
  ImpatientQueue queue(local);
  point->StartRun(queue)->Advance();
}

double SamplesIn(double seconds, const EnsembleSpec& spec, size_t index, Model model,
                 const Machine& machine) {
  if (!TakesSamples(model)) return std::numeric_limits<double>::infinity();
  const PointParameters point = PointAt(spec, index);
  return CostOfSampling(OnePointSpec(spec, point, model), point, machine.rates)
      .SamplesIn(seconds, machine.workers);
}

EnsembleSpec WithSamples(EnsembleSpec spec, double samples) {
  const auto count =
      static_cast<int64_t>(std::clamp(samples, 1.0, static_cast<double>(kMaxSamples)));
  const std::string estimate = spec.target.estimate;
  spec.target = {.samples = count, .estimate = estimate};
  return spec;
}

}  // namespace ballpiston::questions

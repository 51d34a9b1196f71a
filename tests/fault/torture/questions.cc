#include "tests/fault/torture/questions.h"

#include "absl/strings/str_cat.h"
#include "client/library/client.h"
#include "core/ensemble/point_experiment.h"
#include "core/geometry/paper.h"
#include "server/convert/spec.h"
#include "tests/fault/torture/connected_server.h"
#include "tests/fault/torture/sizes.h"

namespace ballpiston::torture {
namespace {

using v1::EnsembleSpec;

EnsembleSpec Question(EnsembleSpec::Experiment experiment, EnsembleSpec::Model model,
                      const std::vector<double>& deltas, const std::vector<double>& energies = {}) {
  EnsembleSpec spec;
  spec.set_experiment(experiment);
  spec.set_model(model);
  spec.set_seed(7);
  spec.mutable_grid()->add_rho(kPaperRho);
  for (const double delta : deltas) spec.mutable_grid()->add_delta(delta);
  for (const double energy : energies) spec.mutable_grid()->add_epsilon(energy);
  return spec;
}

EnsembleSpec Gas(EnsembleSpec::Experiment experiment, EnsembleSpec::Model model) {
  EnsembleSpec spec = Question(experiment, model, {0.2});
  spec.mutable_grid()->add_cells("4");
  if (experiment == EnsembleSpec::GAS_EQUILIBRIUM) {
    spec.mutable_grid()->add_temperature(1);
  } else {
    spec.mutable_grid()->add_hot(1.5);
    spec.mutable_grid()->add_cold(0.5);
  }
  return spec;
}

EnsembleSpec WithSamples(EnsembleSpec spec, int64_t samples) {
  spec.mutable_target()->set_samples(samples);
  return spec;
}

EnsembleSpec WithCollisions(EnsembleSpec spec, int64_t collisions) {
  spec.mutable_target()->set_collisions(collisions);
  return spec;
}

EnsembleSpec WithTolerance(EnsembleSpec spec, double tolerance) {
  spec.mutable_target()->set_tolerance(tolerance);
  return spec;
}

EnsembleSpec FirstHit(const std::vector<double>& energies) {
  EnsembleSpec spec = Question(EnsembleSpec::FIRST_HIT, EnsembleSpec::BILLIARD, {0.2}, energies);
  spec.mutable_grid()->add_exponent(1);
  return spec;
}

// In the short form an eighth of the samples.
int64_t Samples(int full) { return Size(full / 8, full); }
double Tolerance(double full) { return ShareOfFullSize() > 0 ? full : 2 * full; }

// Each point must have the planned number of samples: none missing, none twice.
void CheckCounts(const EnsembleSpec& message, const std::vector<v1::PointResult>& points) {
  const ballpiston::EnsembleSpec spec = server::CheckSpec(message).spec;
  if (points.size() != PointCount(spec)) throw std::runtime_error("points are missing");
  for (const v1::PointResult& point : points) {
    const auto experiment = PointExperiment::Create(spec, static_cast<size_t>(point.index()));
    const ChunkPlan& plan = experiment->plan();
    const auto planned = static_cast<double>(plan.samples() - plan.warm_up());
    if (spec.target.IsOpenEnded() || planned == point.samples()) continue;
    throw std::runtime_error(absl::StrCat("point ", point.index(), " of ",
                                          message.ShortDebugString(), " has ", point.samples(),
                                          " samples, not ", planned));
  }
}

}  // namespace

std::vector<EnsembleSpec> Questions() {
  const auto billiard = EnsembleSpec::BILLIARD;
  const auto markov = EnsembleSpec::MARKOV;
  const auto returns = EnsembleSpec::CONDITIONAL_MEAN_FREE_TIME;
  const auto relaxation = EnsembleSpec::ENERGY_RELAXATION;
  return {
      WithCollisions(Question(EnsembleSpec::EQUILIBRIUM, billiard, {0.2, 0.1}), Samples(100'000)),
      Question(EnsembleSpec::EQUILIBRIUM, EnsembleSpec::CLOSED_FORM, {0.2, 0.1, 0.05}),
      WithSamples(Question(returns, billiard, {0.2}, {0.1, 0.4}), Samples(100'000)),
      WithSamples(Question(returns, billiard, {0.2, 0.15, 0.1}, {0.1, 0.2, 0.3, 0.4}),
                  Samples(10'000)),
      WithTolerance(Question(returns, billiard, {0.2}, {0.25}), Tolerance(0.005)),
      WithSamples(Question(returns, billiard, {0.2}, {0.3}),
                  Size(3'000'000, 10'000'000)),  // for checkpoints
      WithSamples(FirstHit({0.1, 0.4}), Samples(50'000)),
      WithTolerance(FirstHit({0.2}), Tolerance(0.01)),
      WithSamples(Question(relaxation, markov, {0.1}), Samples(1'000)),
      WithTolerance(Question(relaxation, markov, {0.1}), Tolerance(0.1)),
      WithSamples(Question(relaxation, billiard, {0.2}), Samples(500)),
      WithCollisions(Question(EnsembleSpec::MARKOV_PROPERTY, markov, {0.2}), Samples(20'000)),
      WithSamples(Gas(EnsembleSpec::GAS_EQUILIBRIUM, billiard), Size(1'000, 20'000)),
      WithSamples(Gas(EnsembleSpec::GAS_CONDUCTION, billiard), Size(100, 5'000))};
}

std::vector<EnsembleSpec> LargeQuestions() {
  const auto returns = EnsembleSpec::CONDITIONAL_MEAN_FREE_TIME;
  return {WithSamples(FirstHit({0.1, 0.2, 0.3, 0.4}), 300'000),
          WithSamples(Question(returns, EnsembleSpec::BILLIARD, {0.2, 0.1}, {0.1, 0.2, 0.3, 0.4}),
                      300'000)};
}

EnsembleSpec ManyPoints(int points, int64_t samples) {
  EnsembleSpec spec =
      Question(EnsembleSpec::CONDITIONAL_MEAN_FREE_TIME, EnsembleSpec::BILLIARD, {0.2});
  for (int i = 0; i < points; ++i) spec.mutable_grid()->add_epsilon(0.25 + 0.01 * i / points);
  return WithSamples(std::move(spec), samples);
}

EnsembleSpec Endless() {
  return WithSamples(
      Question(EnsembleSpec::CONDITIONAL_MEAN_FREE_TIME, EnsembleSpec::BILLIARD, {0.2}, {0.25}),
      1'000'000'000'000);
}

Answer AnswerOf(const std::vector<v1::PointResult>& points) {
  Answer answer;
  for (v1::PointResult point : points) {
    point.clear_name();  // it has the job's
    answer[point.index()] = point.SerializeAsString();
  }
  return answer;
}

std::vector<Answer> UndisturbedAnswers(const std::vector<EnsembleSpec>& questions) {
  ConnectedServer server;
  server.Start();
  const client::Client client = server.NewClient();
  std::vector<Answer> answers;
  for (const EnsembleSpec& question : questions) {
    const std::string name = OrThrow(client.Create(question)).name();
    const v1::EnsembleJob job =
        OrThrow(client.Watch(name, {}, {.give_up_after = absl::FromChrono(kPatience)}));
    if (job.state() != v1::EnsembleJob::SUCCEEDED) throw std::runtime_error(job.ShortDebugString());
    const std::vector<v1::PointResult> points = OrThrow(client.Results(name));
    CheckCounts(question, points);
    answers.push_back(AnswerOf(points));
  }
  return answers;
}

}  // namespace ballpiston::torture

#include "server/convert/collision_messages.h"

#include <algorithm>
#include <optional>

#include "absl/strings/str_cat.h"
#include "core/ensemble/experiment_kind.h"
#include "core/experiment/all_experiments.h"
#include "server/convert/errors.h"
#include "server/convert/spec.h"

namespace ballpiston::server {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kTurnOfASampler(50);

// An orbit of lyapunov has collisions that its estimates leave out.
bool HasCollisionsToRead(const ExperimentKind& kind) {
  return &kind != &kLyapunov && std::ranges::none_of(kind.parameters, [](const ParameterUse& use) {
    return use.parameter == &kCells;
  });
}

void CheckForCollisions(CheckedSpec& checked) {
  if (!checked.violations.empty()) return;
  const EnsembleSpec& spec = checked.spec;
  std::vector<FieldViolation> found;
  if (!HasCollisionsToRead(*spec.experiment)) {
    found.push_back(
        {"experiment", absl::StrCat("is ", spec.experiment->name,
                                    "; permitted: an experiment with a pair, except lyapunov")});
  }
  if (!IsABilliard(spec.model)) {
    found.push_back({"model", absl::StrCat("is ", Name(spec.model),
                                           "; permitted: auto, billiard, billiard_reference")});
  }
  if (PointCount(spec) != 1) {
    found.push_back({"grid", absl::StrCat("has ", PointCount(spec), " points; permitted: one")});
  }
  if (spec.target.IsOpenEnded()) {
    found.push_back({"target", "has a tolerance or a budget; permitted: samples or collisions"});
  }
  AddViolations(std::move(found), checked);
}

void AddRow(const CollisionRecord& record, v1::SampleCollisionsResponse& message) {
  const PairState &before = record.before, &after = record.after;
  message.add_sample(record.sample);
  message.add_time(record.time);
  message.add_free_time(record.free_time);
  message.add_x(before.piston);
  message.add_y(before.position.y());
  message.add_ball_vx(before.ball_speed * before.direction.x());
  message.add_ball_vy(before.ball_speed * before.direction.y());
  message.add_piston_vx(before.piston_velocity);
  message.add_ball_vx_after(after.ball_speed * after.direction.x());
  message.add_piston_vx_after(after.piston_velocity);
  message.add_piston_energy(before.piston_velocity * before.piston_velocity / 2);
  message.add_piston_energy_after(after.piston_velocity * after.piston_velocity / 2);
}

}  // namespace

CollisionMessages::CollisionMessages(const EnsembleSpec& spec)
    : experiment_(PointExperiment::Create(spec, 0)),
      end_of_turn_(std::make_unique<Clock::time_point>()),
      sampler_(std::make_unique<CollisionSampler>(
          *experiment_, *spec.experiment,
          [end = end_of_turn_.get()] { return Clock::now() >= *end; })) {}

absl::StatusOr<CollisionMessages> CollisionMessages::Create(
    const v1::SampleCollisionsRequest& request) {
  v1::EnsembleSpec message = request.spec();
  const bool is_auto = message.model() == v1::EnsembleSpec::AUTO ||
                       message.model() == v1::EnsembleSpec::MODEL_UNSPECIFIED;
  if (is_auto) {  // the samples are simulated with or without `verify`
    message.set_model(v1::EnsembleSpec::BILLIARD);
    message.clear_verify();
  }
  CheckedSpec checked = CheckSpec(message);
  CheckForCollisions(checked);
  if (!checked.violations.empty()) return InvalidSpec(checked.violations);
  return CollisionMessages(checked.spec);
}

bool CollisionMessages::FillNext(v1::SampleCollisionsResponse& message) {
  if (next_ == records_.size()) {
    *end_of_turn_ = Clock::now() + kTurnOfASampler;
    std::optional<std::vector<CollisionRecord>> records = sampler_->NextRecords();
    if (!records) return false;
    records_ = *std::move(records);
    next_ = 0;
  }
  const size_t end = std::min(records_.size(), next_ + kCollisionsOfMessage);
  for (; next_ < end; ++next_) AddRow(records_[next_], message);
  return true;
}

}  // namespace ballpiston::server

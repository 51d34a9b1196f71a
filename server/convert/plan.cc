#include "server/convert/plan.h"

#include "server/convert/spec.h"

namespace ballpiston::server {
namespace {

v1::ModelPlan ModelPlanMessage(const Rung& rung) {
  v1::ModelPlan message;
  message.set_model(ModelMessage(rung.model));
  message.set_answers(rung.answers);
  message.set_reason(rung.reason);
  if (rung.samples) message.set_samples(*rung.samples);
  if (rung.work) message.set_work(*rung.work);
  if (rung.statistical_error) message.set_relative_statistical_error(*rung.statistical_error);
  message.set_memory(rung.memory);
  if (rung.model_error) message.set_relative_model_error(*rung.model_error);
  return message;
}

}  // namespace

v1::PointPlan PointPlanMessage(const PointParameters& point, const Ladder& ladder) {
  v1::PointPlan message;
  *message.mutable_parameters() = ParametersMessage(point);
  for (const Rung& rung : ladder.rungs) *message.add_models() = ModelPlanMessage(rung);
  message.set_model(ModelMessage(ladder.answer.model));
  message.set_reason(ladder.answer.reason);
  return message;
}

v1::ComputingRates RatesMessage(const MachineRates& rates) {
  v1::ComputingRates message;
  message.set_closed_form(rates.closed_form);
  message.set_spectrum(rates.spectrum);
  message.set_jump(rates.jump);
  message.set_wall_hit(rates.lanes.wall_hit);
  message.set_collision(rates.lanes.collision);
  message.set_sample(rates.lanes.sample);
  message.set_wall_hit_single(rates.lanes_single.wall_hit);
  message.set_event_reference(rates.reference.wall_hit);
  message.set_first_point(rates.first_point);
  message.set_stored_closed_form(rates.stored_closed_form);
  message.set_stored_spectrum(rates.stored_spectrum);
  return message;
}

}  // namespace ballpiston::server

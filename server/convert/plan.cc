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

}  // namespace ballpiston::server

#include "tests/server/preamble.h"
#include "tests/server/worker/sample_leases.h"

namespace ballpiston::server {
namespace {

v1::EnsembleSpec QuestionOf(const ExperimentKind& kind, Model model = Model::kAuto) {
  EnsembleSpec spec = SpecOf(kind, model);
  spec.target = {};
  return SpecMessage(spec);
}

double WorkOfPoints(const v1::PlanEnsembleJobResponse& plan) {
  double work = 0;
  for (const v1::PointPlan& point : plan.points()) {
    for (const v1::ModelPlan& model : point.models()) {
      if (model.model() == point.model()) work += model.work();
    }
  }
  return work;
}

class PlanServiceTest : public testing::Test {
 protected:
  static v1::PlanEnsembleJobRequest Request(const v1::EnsembleSpec& spec) {
    v1::PlanEnsembleJobRequest request;
    *request.mutable_spec() = spec;
    return request;
  }

  v1::PlanEnsembleJobResponse PlanOf(const v1::EnsembleSpec& spec) const {
    return server_.Answered<v1::PlanEnsembleJobResponse>(Request(spec));
  }

  // The extra time of a job's first point, because caches are cold.
  double FirstPoint() const {
    const v1::PlanEnsembleJobResponse plan = PlanOf(QuestionOf(kEquilibrium));
    return plan.work() - WorkOfPoints(plan);
  }

  const RunningServer server_{{.factory = nullptr}};  // the core's experiments
};

TEST_F(PlanServiceTest, EveryExperimentHasItsLadderCheapestFirst) {
  for (const ExperimentKind* kind : AllExperiments()) {
    const v1::EnsembleSpec question = QuestionOf(*kind);
    const v1::PlanEnsembleJobResponse plan = PlanOf(question);
    SCOPED_TRACE(kind->name);
    ASSERT_EQ(plan.points_size(), 1);
    EXPECT_EQ(plan.point_count(), 1);
    // On one core the store's thread adds some 10 us.
    EXPECT_GE(plan.time(), plan.work() / 2);
    EXPECT_LE(plan.time(), plan.work() + 1e-4);
    const v1::PointPlan& point = plan.points(0);
    EXPECT_NE(point.reason(), "");
    EXPECT_EQ(point.parameters().delta(), question.grid().delta(0));
    std::vector<v1::EnsembleSpec::Model> order;
    for (const v1::ModelPlan& model : point.models()) {
      order.push_back(model.model());
      EXPECT_TRUE(model.answers() || model.model() != point.model());
      EXPECT_EQ(model.has_work(), model.answers());
      EXPECT_NE(model.reason(), "");
      EXPECT_EQ(model.work() > 0, model.answers());
    }
    EXPECT_THAT(order, ElementsAre(v1::EnsembleSpec::CLOSED_FORM, v1::EnsembleSpec::SPECTRUM,
                                   v1::EnsembleSpec::MARKOV, v1::EnsembleSpec::BILLIARD,
                                   v1::EnsembleSpec::BILLIARD_REFERENCE));
  }
}

// At delta = 3e-5 the lanes of a worker need more than a minute until their first orbits end.
TEST_F(PlanServiceTest, ABudgetBelowTheFirstSamplesIsRejected) {
  v1::EnsembleSpec spec = QuestionOf(kEquilibrium);
  spec.mutable_grid()->set_delta(0, 3e-5);
  spec.set_model(v1::EnsembleSpec::BILLIARD);
  spec.mutable_target()->mutable_budget()->set_seconds(1);
  for (const grpc::Status& status :
       {server_.Call(Request(spec)), server_.Call(CreateRequest(spec))}) {
    EXPECT_THAT(status, StatusIs(grpc::StatusCode::INVALID_ARGUMENT, HasSubstr("budget >= ")));
    EXPECT_THAT(FieldsOf(status), ElementsAre("spec.target.budget"));
  }
  spec.set_model(v1::EnsembleSpec::AUTO);  // the closed form needs no samples
  PlanOf(spec);
}

TEST_F(PlanServiceTest, MemoryIsThatOfTheLargestGas) {
  v1::EnsembleSpec spec = QuestionOf(kGasEquilibrium, Model::kMarkov);
  const double small = PlanOf(spec).memory();
  spec.mutable_grid()->add_cells("1000x100");
  const v1::PlanEnsembleJobResponse plan = PlanOf(spec);
  EXPECT_GT(plan.memory(), small + 1e7);
  EXPECT_LT(plan.memory(), 1e9);
}

TEST_F(PlanServiceTest, ALargeGridIsPlannedByAThousandOfItsPoints) {
  v1::EnsembleSpec spec = QuestionOf(kEnergyRelaxation);
  spec.set_model(v1::EnsembleSpec::BILLIARD);
  spec.mutable_target()->set_tolerance(0.01);
  spec.mutable_grid()->clear_delta();
  for (int i = 0; i < 100'000; ++i) spec.mutable_grid()->add_delta(0.001 + 1e-6 * i);
  const v1::PlanEnsembleJobResponse plan = PlanOf(spec);
  EXPECT_EQ(plan.point_count(), 100'000);
  ASSERT_EQ(plan.points_size(), 1000);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_GE(plan.points(i).parameters().delta(), spec.grid().delta(100 * i));
    EXPECT_LE(plan.points(i).parameters().delta(), spec.grid().delta(100 * i + 99));
  }
  EXPECT_NEAR((plan.work() - FirstPoint()) / (100 * WorkOfPoints(plan)), 1, 1e-9);
  EXPECT_EQ(plan.workers(), 2);
  EXPECT_EQ(server_.List().jobs_size(), 0);  // a plan creates no job
}

// Every second point takes 150 times as long.
TEST_F(PlanServiceTest, TheOrderOfAListDoesNotMatter) {
  std::vector<double> works;
  for (const auto& deltas : {std::vector{0.1, 0.008}, {0.008, 0.1}}) {
    v1::EnsembleSpec spec = QuestionOf(kEquilibrium);
    spec.set_model(v1::EnsembleSpec::BILLIARD);
    spec.mutable_grid()->clear_rho();
    for (int i = 0; i < 1000; ++i) spec.mutable_grid()->add_rho(0.51 + 9e-5 * i);
    spec.mutable_grid()->mutable_delta()->Assign(deltas.begin(), deltas.end());
    works.push_back(PlanOf(spec).work());
  }
  EXPECT_NEAR(works[0] / works[1], 1, 0.05);
}

}  // namespace
}  // namespace ballpiston::server

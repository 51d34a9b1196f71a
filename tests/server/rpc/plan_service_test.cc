#include <vector>

#include "gmock/gmock.h"
#include "tests/server/error_details.h"
#include "tests/server/requests.h"
#include "tests/server/running_server.h"
#include "tests/support/status_matchers.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;

// One server for all: measuring its rates takes some 0.3 s.
class PlanServiceTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    // The core's experiments.
    server_ = new RunningServer({.data_dir = folder_->path(), .factory = nullptr});
  }
  static void TearDownTestSuite() {
    delete server_;
    delete folder_;
  }

  static grpc::Status Plan(const v1::EnsembleSpec& spec, v1::PlanEnsembleJobResponse* plan) {
    grpc::ClientContext context;
    v1::PlanEnsembleJobRequest request;
    *request.mutable_spec() = spec;
    return server_->ensemble().PlanEnsembleJob(&context, request, plan);
  }

  static v1::PlanEnsembleJobResponse PlanOf(const v1::EnsembleSpec& spec) {
    v1::PlanEnsembleJobResponse plan;
    EXPECT_OK(Plan(spec, &plan));
    return plan;
  }

  static double FirstPoint();

  static inline TemporaryFolder* folder_ = nullptr;
  static inline RunningServer* server_ = nullptr;
};

v1::EnsembleSpec PlanQuestion(v1::EnsembleSpec::Experiment experiment) {
  v1::EnsembleSpec spec;
  spec.set_experiment(experiment);
  spec.mutable_grid()->add_rho(0.53);
  spec.mutable_grid()->add_delta(0.1);
  const bool from_energy = experiment == v1::EnsembleSpec::CONDITIONAL_MEAN_FREE_TIME ||
                           experiment == v1::EnsembleSpec::FIRST_HIT;
  if (from_energy) spec.mutable_grid()->add_epsilon(0.1);
  if (experiment == v1::EnsembleSpec::FIRST_HIT) spec.mutable_grid()->add_exponent(1);
  if (experiment == v1::EnsembleSpec::GAS_EQUILIBRIUM ||
      experiment == v1::EnsembleSpec::GAS_LYAPUNOV) {
    spec.mutable_grid()->add_cells("4x3");
    spec.mutable_grid()->add_temperature(2);
  }
  if (experiment == v1::EnsembleSpec::GAS_CONDUCTION) {
    spec.mutable_grid()->add_cells("4");
    spec.mutable_grid()->add_hot(1.5);
    spec.mutable_grid()->add_cold(0.5);
  }
  return spec;
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

TEST_F(PlanServiceTest, EveryExperimentHasItsLadderCheapestFirst) {
  for (int number = v1::EnsembleSpec_Experiment_Experiment_MIN + 1;
       number <= v1::EnsembleSpec_Experiment_Experiment_MAX; ++number) {
    const auto experiment = static_cast<v1::EnsembleSpec::Experiment>(number);
    const v1::PlanEnsembleJobResponse plan = PlanOf(PlanQuestion(experiment));
    SCOPED_TRACE(v1::EnsembleSpec::Experiment_Name(experiment));
    ASSERT_EQ(plan.points_size(), 1);
    EXPECT_EQ(plan.point_count(), 1);
    const v1::PointPlan& point = plan.points(0);
    EXPECT_NE(point.reason(), "");
    EXPECT_EQ(point.parameters().delta(), 0.1);
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

// The extra time of a job's first point, because caches are cold.
double PlanServiceTest::FirstPoint() {
  const v1::PlanEnsembleJobResponse plan = PlanOf(PlanQuestion(v1::EnsembleSpec::EQUILIBRIUM));
  return plan.work() - WorkOfPoints(plan);
}

TEST_F(PlanServiceTest, TheWorkIsThatOfTheChosenOneOverAllPoints) {
  v1::EnsembleSpec spec = PlanQuestion(v1::EnsembleSpec::FIRST_HIT);
  for (const double delta : {0.2, 0.05}) spec.mutable_grid()->add_delta(delta);
  const v1::PlanEnsembleJobResponse plan = PlanOf(spec);
  ASSERT_EQ(plan.points_size(), 3);
  EXPECT_NEAR(plan.work(), FirstPoint() + WorkOfPoints(plan), 1e-9);
  EXPECT_EQ(plan.workers(), 2);
  // The store's thread may share the workers' cores.
  EXPECT_GE(plan.time(), plan.work() / 2);
  EXPECT_LE(plan.time(), plan.work() + 0.1);
}

// At delta = 1e-6 the lanes of a worker need many minutes until their first orbits end.
TEST_F(PlanServiceTest, ABudgetBelowTheFirstSamplesIsRejected) {
  v1::EnsembleSpec spec = PlanQuestion(v1::EnsembleSpec::EQUILIBRIUM);
  spec.mutable_grid()->set_delta(0, 1e-6);
  spec.set_model(v1::EnsembleSpec::BILLIARD);
  spec.mutable_target()->mutable_budget()->set_seconds(1);
  v1::PlanEnsembleJobResponse plan;
  const grpc::Status status = Plan(spec, &plan);
  EXPECT_THAT(status, StatusIs(grpc::StatusCode::INVALID_ARGUMENT, HasSubstr("budget >= ")));
  EXPECT_THAT(DetailsOf(status).fields, ElementsAre("spec.target.budget"));
  const grpc::Status created = server_->Create(CreateRequest(spec));
  EXPECT_THAT(created, StatusIs(grpc::StatusCode::INVALID_ARGUMENT, HasSubstr("budget >= ")));
  spec.set_model(v1::EnsembleSpec::AUTO);  // the closed form needs no samples
  EXPECT_OK(Plan(spec, &plan));
}

TEST_F(PlanServiceTest, MemoryIsThatOfTheLargestGas) {
  v1::EnsembleSpec spec = PlanQuestion(v1::EnsembleSpec::GAS_EQUILIBRIUM);
  spec.set_model(v1::EnsembleSpec::MARKOV);
  const double small = PlanOf(spec).memory();
  spec.mutable_grid()->add_cells("1000x100");
  const v1::PlanEnsembleJobResponse plan = PlanOf(spec);
  EXPECT_GT(plan.memory(), small + 1e7);
  EXPECT_LT(plan.memory(), 1e9);
}

TEST_F(PlanServiceTest, AnInvalidSpecIsRefusedAsByCreate) {
  v1::EnsembleSpec spec = PlanQuestion(v1::EnsembleSpec::ENERGY_RELAXATION);
  spec.mutable_grid()->set_rho(0, 0.4);
  spec.mutable_grid()->add_epsilon(0.7);
  spec.mutable_target()->set_tolerance(0);
  v1::PlanEnsembleJobResponse plan;
  const grpc::Status status = Plan(spec, &plan);
  EXPECT_THAT(status, IsError(grpc::StatusCode::INVALID_ARGUMENT, "INVALID_SPEC"));
  EXPECT_THAT(DetailsOf(status).fields,
              IsSupersetOf({"spec.grid.rho[0]", "spec.grid.epsilon[0]", "spec.target.tolerance"}));
  EXPECT_THAT(Plan({}, &plan), StatusIs(grpc::StatusCode::INVALID_ARGUMENT));
}

TEST_F(PlanServiceTest, ALargeGridIsPlannedByAThousandPointsEvenlySpread) {
  v1::EnsembleSpec spec = PlanQuestion(v1::EnsembleSpec::ENERGY_RELAXATION);
  // The billiard needs no pilots; the number of pilots is not the number of points.
  spec.set_model(v1::EnsembleSpec::BILLIARD);
  spec.mutable_target()->set_tolerance(0.01);
  spec.mutable_grid()->clear_delta();
  for (int i = 0; i < 100'000; ++i) spec.mutable_grid()->add_delta(0.001 + 1e-6 * i);
  const v1::PlanEnsembleJobResponse plan = PlanOf(spec);
  EXPECT_EQ(plan.point_count(), 100'000);
  ASSERT_EQ(plan.points_size(), 1000);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(plan.points(i).parameters().delta(), spec.grid().delta(100 * i));
  }
  EXPECT_NEAR((plan.work() - FirstPoint()) / (100 * WorkOfPoints(plan)), 1, 1e-9);
}

}  // namespace
}  // namespace ballpiston::server

#include <map>
#include <set>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace ballpiston::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsSupersetOf;
using v1::EnsembleSpec;

// One server for all: measuring its rates takes some 0.3 s.
class PlanServiceTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    ServerOptions options;
    options.data_dir = folder_->File("data");
    options.workers = 2;
    server_ = new RunningServer(options);
  }
  static void TearDownTestSuite() {
    delete server_;
    delete folder_;
  }

  static grpc::Status Plan(const EnsembleSpec& spec, v1::PlanEnsembleJobResponse* plan) {
    grpc::ClientContext context;
    v1::PlanEnsembleJobRequest request;
    *request.mutable_spec() = spec;
    return server_->ensemble().PlanEnsembleJob(&context, request, plan);
  }

  static v1::PlanEnsembleJobResponse PlanOf(const EnsembleSpec& spec) {
    v1::PlanEnsembleJobResponse plan;
    const grpc::Status status = Plan(spec, &plan);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return plan;
  }

  static inline TemporaryFolder* folder_ = nullptr;
  static inline RunningServer* server_ = nullptr;
};

EnsembleSpec Question(EnsembleSpec::Experiment experiment) {
  EnsembleSpec spec;
  spec.set_experiment(experiment);
  spec.mutable_grid()->add_rho(0.53);
  spec.mutable_grid()->add_delta(0.1);
  const bool from_energy = experiment == EnsembleSpec::CONDITIONAL_MEAN_FREE_TIME ||
                           experiment == EnsembleSpec::FIRST_HIT;
  if (from_energy) spec.mutable_grid()->add_epsilon(0.1);
  if (experiment == EnsembleSpec::FIRST_HIT) spec.mutable_grid()->add_exponent(1);
  return spec;
}

struct Expected {
  EnsembleSpec::Model chosen;
  std::set<EnsembleSpec::Model> answering;
};

const std::map<EnsembleSpec::Experiment, Expected>& ExpectedOfAll() {
  using E = EnsembleSpec;
  static const std::map<E::Experiment, Expected> all = {
      {E::EQUILIBRIUM, {E::CLOSED_FORM, {E::CLOSED_FORM, E::BILLIARD, E::BILLIARD_REFERENCE}}},
      {E::CONDITIONAL_MEAN_FREE_TIME,
       {E::CLOSED_FORM, {E::CLOSED_FORM, E::BILLIARD, E::BILLIARD_REFERENCE}}},
      {E::FIRST_HIT, {E::BILLIARD, {E::BILLIARD, E::BILLIARD_REFERENCE}}},
      {E::ENERGY_RELAXATION,
       {E::BILLIARD, {E::SPECTRUM, E::MARKOV, E::BILLIARD, E::BILLIARD_REFERENCE}}},
      {E::MARKOV_PROPERTY, {E::BILLIARD, {E::MARKOV, E::BILLIARD, E::BILLIARD_REFERENCE}}}};
  return all;
}

TEST_F(PlanServiceTest, EveryExperimentHasItsLadderCheapestFirst) {
  for (int number = v1::EnsembleSpec_Experiment_Experiment_MIN + 1;
       number <= v1::EnsembleSpec_Experiment_Experiment_MAX; ++number) {
    const auto experiment = static_cast<EnsembleSpec::Experiment>(number);
    ASSERT_TRUE(ExpectedOfAll().contains(experiment)) << number;
    const Expected& expected = ExpectedOfAll().at(experiment);
    const v1::PlanEnsembleJobResponse plan = PlanOf(Question(experiment));
    SCOPED_TRACE(EnsembleSpec::Experiment_Name(experiment));
    ASSERT_EQ(plan.points_size(), 1);
    EXPECT_EQ(plan.point_count(), 1);
    const v1::PointPlan& point = plan.points(0);
    EXPECT_EQ(point.model(), expected.chosen);
    EXPECT_NE(point.reason(), "");
    EXPECT_EQ(point.parameters().delta(), 0.1);
    std::vector<EnsembleSpec::Model> order;
    for (const v1::ModelPlan& model : point.models()) {
      order.push_back(model.model());
      EXPECT_EQ(model.answers(), expected.answering.contains(model.model()));
      EXPECT_EQ(model.has_work(), model.answers());
      EXPECT_NE(model.reason(), "");
      EXPECT_EQ(model.work() > 0, model.answers());
    }
    EXPECT_THAT(order,
                ElementsAre(EnsembleSpec::CLOSED_FORM, EnsembleSpec::SPECTRUM, EnsembleSpec::MARKOV,
                            EnsembleSpec::BILLIARD, EnsembleSpec::BILLIARD_REFERENCE));
  }
}

TEST_F(PlanServiceTest, TheWorkIsThatOfTheChosenOneOverAllPoints) {
  EnsembleSpec spec = Question(EnsembleSpec::FIRST_HIT);
  for (const double delta : {0.2, 0.05}) spec.mutable_grid()->add_delta(delta);
  const v1::PlanEnsembleJobResponse plan = PlanOf(spec);
  ASSERT_EQ(plan.points_size(), 3);
  double work = 0;
  for (const v1::PointPlan& point : plan.points()) {
    for (const v1::ModelPlan& model : point.models()) {
      if (model.model() == point.model()) work += model.work();
    }
  }
  EXPECT_DOUBLE_EQ(plan.work(), plan.rates().first_point() + work);
  EXPECT_EQ(plan.workers(), 2);
  EXPECT_DOUBLE_EQ(plan.time(), plan.work() / 2);
}

TEST_F(PlanServiceTest, RatesAreMeasuredAndPositive) {
  const v1::ComputingRates rates = PlanOf(Question(EnsembleSpec::EQUILIBRIUM)).rates();
  EXPECT_GT(rates.closed_form(), 0);
  EXPECT_GT(rates.spectrum(), 0);
  EXPECT_GT(rates.jump(), 0);
  EXPECT_GT(rates.wall_hit(), 0);
  EXPECT_GT(rates.collision(), 0);
  EXPECT_GT(rates.sample(), 0);
  EXPECT_GT(rates.wall_hit_single(), 0);
  EXPECT_GT(rates.event_reference(), 0);
  EXPECT_LT(rates.wall_hit(), rates.event_reference());
}

TEST_F(PlanServiceTest, AnInvalidSpecIsRefusedAsACreationIs) {
  EnsembleSpec spec = Question(EnsembleSpec::ENERGY_RELAXATION);
  spec.mutable_grid()->set_rho(0, 0.4);
  spec.mutable_grid()->add_epsilon(0.7);
  spec.mutable_target()->set_tolerance(0);
  v1::PlanEnsembleJobResponse plan;
  const grpc::Status status = Plan(spec, &plan);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(DetailsOf(status).reason, "INVALID_SPEC");
  EXPECT_THAT(DetailsOf(status).fields,
              IsSupersetOf({"spec.grid.rho[0]", "spec.grid.epsilon[0]", "spec.target.tolerance"}));
  EXPECT_EQ(Plan({}, &plan).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(PlanServiceTest, ALargeGridIsPlannedByAThousandPointsEvenlySpread) {
  EnsembleSpec spec = Question(EnsembleSpec::ENERGY_RELAXATION);
  spec.set_model(EnsembleSpec::BILLIARD);  // no pilot, which is not as many as the points
  spec.mutable_target()->set_tolerance(0.01);
  spec.mutable_grid()->clear_delta();
  for (int i = 0; i < 100'000; ++i) spec.mutable_grid()->add_delta(0.001 + 1e-6 * i);
  const v1::PlanEnsembleJobResponse plan = PlanOf(spec);
  EXPECT_EQ(plan.point_count(), 100'000);
  ASSERT_EQ(plan.points_size(), 1000);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(plan.points(i).parameters().delta(), spec.grid().delta(100 * i));
  }
  double work = 0;
  for (const v1::PointPlan& point : plan.points()) {
    for (const v1::ModelPlan& model : point.models()) {
      if (model.model() == point.model()) work += model.work();
    }
  }
  EXPECT_NEAR((plan.work() - plan.rates().first_point()) / (100 * work), 1, 1e-9);
}

TEST_F(PlanServiceTest, APlanMakesNoJob) {
  PlanOf(Question(EnsembleSpec::FIRST_HIT));
  grpc::ClientContext context;
  v1::ListEnsembleJobsResponse list;
  ASSERT_TRUE(server_->ensemble().ListEnsembleJobs(&context, {}, &list).ok());
  EXPECT_EQ(list.jobs_size(), 0);
}

}  // namespace
}  // namespace ballpiston::server

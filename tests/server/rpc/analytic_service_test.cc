#include "core/closed_form/exchange_rate.h"
#include "core/closed_form/kernel.h"
#include "core/closed_form/mean_free_time.h"
#include "core/closed_form/pair_measures.h"
#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

v1::EvaluatePairsResponse Evaluated(const std::string& request) {
  return RunningServer().Answered<v1::EvaluatePairsResponse>(
      FromText<v1::EvaluatePairsRequest>(request));
}

// The numbers that are not in lists, in the order of the .proto file.
std::vector<double> NumbersOf(const google::protobuf::Message& message) {
  std::vector<double> numbers;
  for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
    const auto* field = message.GetDescriptor()->field(i);
    if (field->is_repeated()) continue;
    numbers.push_back(message.GetReflection()->GetDouble(message, field));
  }
  return numbers;
}

TEST(AnalyticService, EveryFieldHasItsClosedFormAndRhoVariesSlowest) {
  const auto answer = Evaluated(
      "rho: [0.53, 0.55] delta: [0.2, 0.1] epsilon: [0, 0.25, 0.5] outgoing_epsilon: [0.125, 0.25] "
      "beta: 4 temperature: 2");
  ASSERT_EQ(answer.points_size(), 4);
  for (int i = 0; i < 4; ++i) {
    const v1::PairAnalytics& point = answer.points(i);
    const double rho = i < 2 ? 0.53 : 0.55;
    const PairGeometry pair = *PairGeometry::Create(rho, i % 2 == 0 ? 0.2 : 0.1);
    const PairMeasures measures = Measures(pair);
    const MeanFreeTimes times = MeanFreeTimesOf(pair);
    EXPECT_THAT(NumbersOf(point),
                ElementsAre(rho, pair.delta(), pair.lambda(), measures.eta, measures.cell_area,
                            measures.volume, measures.area_ball_piston, measures.area_ball_wall,
                            measures.area_piston_wall, times.ball_piston, times.ball_wall,
                            times.piston_wall, PairDeltaBound(rho), GasDeltaBound(rho),
                            RareLimitRate(rho)));
    ASSERT_EQ(point.energies_size(), 3);
    for (int j = 0; j < 3; ++j) {
      const v1::EnergyAnalytics& energy = point.energies(j);
      const double epsilon = 0.25 * j;
      EXPECT_THAT(
          NumbersOf(energy),
          ElementsAre(epsilon, Phi(epsilon), PairCollisionRate(epsilon), PairEnergyCurrent(epsilon),
                      PairSquaredEnergyTransfer(epsilon), ConditionalMeanFreeTime(pair, epsilon)));
      EXPECT_THAT(energy.kernel(),
                  ElementsAre(PairKernel(epsilon, 0.125), PairKernel(epsilon, 0.25)));
    }
    ASSERT_EQ(point.canonical_size(), 2);
    for (const auto& [row, temperature] : {std::pair(0, 0.25), {1, 2.0}}) {
      const CanonicalAverages averages = AveragesAt(1 / temperature);
      const double rate = ExchangeRate(measures, temperature);
      EXPECT_THAT(NumbersOf(point.canonical(row)),
                  ElementsAre(1 / temperature, temperature, averages.mean_f,
                              averages.mean_energy_current, averages.mean_h, rate,
                              StaticConductivity(rate), RareLimitExchangeRate(rho, temperature)));
    }
  }
}

TEST(AnalyticService, TheWholeRangeOfTemperaturesIsAnswered) {
  const auto answer =
      Evaluated("rho: 0.53 delta: 1e-100 temperature: [1e-120, 1e120] beta: [1e-120, 1e120]");
  for (const v1::CanonicalAnalytics& row : answer.points(0).canonical()) {
    for (const double number : NumbersOf(row)) EXPECT_TRUE(std::isnormal(number)) << number;
  }
}

}  // namespace
}  // namespace ballpiston::server

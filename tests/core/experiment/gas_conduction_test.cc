// The experiment `gas-conduction`: estimates, profile, fluctuations, times.
#include "core/experiment/steady_gas.h"
#include "core/experiment/steady_group.h"
#include "core/gas/gas_exchange_rate.h"
#include "core/geometry/temperature.h"
#include "tests/core/preamble.h"
#include "tests/core/run_point.h"

namespace ballpiston {
namespace {

EnsembleSpec SpecBetween(double hot, double cold, const GasShape& shape = {.columns = 3},
                         Model model = Model::kBilliard) {
  PointParameters point = PaperGas(&kGasConduction, 0.2, shape);
  point.Set(kHot, hot);
  point.Set(kCold, cold);
  return SpecOf(&kGasConduction, point, {.samples = 1024}, model, 7);
}

// Balls in cells and pistons between them. The temperature falls from cell to cell; neighbours of
// one kind are some ten standard errors apart.
void ExpectProfileOfThreeColumns(const PointSummary& summary) {
  const Curve& profile = summary.curves.at(0);
  EXPECT_EQ(profile.name, "temperature_profile");
  EXPECT_EQ(profile.axis, CurveAxis::kPosition);
  ASSERT_EQ(profile.points.size(), 7u);
  double of_balls = 0;
  for (size_t i = 0; i < 7; ++i) {
    const CurvePoint& place = profile.points[i];
    EXPECT_EQ(place.at, 0.5 * static_cast<double>(i));
    EXPECT_GT(place.value, 1);
    if (i % 2 == 1) of_balls += place.value / 3;
    EXPECT_LT(place.value, i < 2 ? 3 : profile.points[i - 2].value);
  }
  EXPECT_NEAR(of_balls, Named("temperature_ball", summary.estimates).value, 1e-12);
}

TEST(GasConduction, EstimatesAndProfileFollowFromTheCurrent) {
  for (const GasShape& shape : {GasShape{3}, GasShape{3, 2, true}}) {
    const PointSummary summary = RunPoint(SpecBetween(3, 1, shape));
    EXPECT_THAT(NamesOf(summary),
                ElementsAre("heat_current", "conductivity", "conductivity_ratio", "exchange_rate",
                            "temperature_ball", "temperature_piston"));
    // J N sqrt(T)/[(2/3)(hot^(3/2) - cold^(3/2))] with N = 3, T = 2.
    const double per_current = 3 * std::sqrt(2.0) / (2.0 / 3 * (std::sqrt(27.0) - 1));
    const Estimate &current = summary.estimates[0], &conductivity = summary.estimates[1];
    EXPECT_DOUBLE_EQ(conductivity.value, per_current * current.value);
    EXPECT_DOUBLE_EQ(*conductivity.standard_error, per_current * *current.standard_error);
    const GasGeometry geometry =
        GasGeometry::Create(kPaperRho, 0.2, shape, GasEnds::kReservoirs).value();
    EXPECT_DOUBLE_EQ(summary.estimates[2].value,
                     conductivity.value / (InfiniteGasExchangeRate(geometry, 2) / 2));
    // The ratio is near 1, as where exchanges are rare. Its standard error is 0.07 and 0.05.
    EXPECT_NEAR(summary.estimates[2].value, 1, 0.25);
    EXPECT_FALSE(current.exact);
    EXPECT_GT(current.value, 10 * *current.standard_error);  // from hot to cold
    EXPECT_TRUE(summary.remarks.empty());
    ExpectProfileOfThreeColumns(summary);
  }
}

// The conductivity tends to N J/(hot - cold), and loses no digits there.
TEST(GasConduction, ConductivityKeepsItsDigitsBetweenNearlyEqualTemperatures) {
  constexpr double kHotter = 1 + 1e-9;
  const PointSummary summary = RunPoint(SpecBetween(kHotter, 1, {2}, Model::kMarkov));
  const double expected = 2 * summary.estimates[0].value / (kHotter - 1);
  EXPECT_NEAR(summary.estimates[1].value / expected, 1, 1e-11);
}

// The same replicas seen at other temperatures, to rounding: they are 4 times as high.
TEST(GasConduction, AllScalesWithTheTemperatures) {
  const BlockResult merged = FoldPoint(*PointExperiment::Create(SpecBetween(3, 1), 0));
  ExpectScaled(Summarized(SpecBetween(3, 1), merged), Summarized(SpecBetween(12, 4), merged),
               {8, 2, 1, 2, 4, 4}, {4}, 1);
}

// The same trajectories seen at other temperatures. The units of the cumulants are T^(n + 1/2).
TEST(GasConduction, AtEveryTemperatureTheCumulantsAreNumbersOrNotStated) {
  const auto at = [](double temperature) {
    EnsembleSpec spec = SpecBetween(temperature, temperature, {.columns = 1}, Model::kMarkov);
    spec.target.samples = 1'049'000;
    return spec;
  };
  const BlockResult merged = FoldPoint(*PointExperiment::Create(at(1), 0));
  const auto expect_stated = [&](double temperature, size_t orders) {
    SCOPED_TRACE(temperature);
    const PointSummary summary = Summarized(at(temperature), merged);
    ASSERT_EQ(summary.curves.size(), 1 + orders);  // the profile first
    for (const Curve& curve : summary.curves) {
      for (const CurvePoint& there : curve.points) {
        EXPECT_TRUE(std::isnormal(there.value)) << curve.name << " " << there.value;
        EXPECT_TRUE(std::isnormal(*there.standard_error)) << curve.name;
      }
    }
    EXPECT_EQ(summary.estimates.size(), 5 + orders);
    EXPECT_THAT(summary.remarks, testing::Conditional(orders < 3, Contains(HasSubstr("not stated")),
                                                      Not(Contains(HasSubstr("not stated")))));
  };
  expect_stated(1, 3);
  expect_stated(1e-60, 3);
  for (const double temperature : {1e70, 1e-70}) expect_stated(temperature, 2);
  for (const double temperature : {kMaxTemperature, kMinTemperature}) {
    expect_stated(temperature, 1);
  }
}

// The groups that are measured first are those whose energy has changed little.
TEST(GasConduction, AnErrorNeedsSevenEighthsOfTheGroups) {
  const auto experiment =
      PointExperiment::Create(SpecBetween(3, 1, {.columns = 1}, Model::kMarkov), 0);
  BlockResult merged = FoldPoint(*experiment);
  ASSERT_EQ(merged.groups.size(), 16u);
  merged.groups[3] = merged.groups[14] = {};
  EXPECT_TRUE(experiment->Summarize(merged).estimates.front().standard_error);
  merged.groups[0] = {};
  const PointSummary summary = experiment->Summarize(merged);
  for (const Estimate& estimate : summary.estimates) {
    EXPECT_FALSE(estimate.standard_error) << estimate.name;
  }
  EXPECT_THAT(
      summary.remarks,
      ElementsAre(HasSubstr("3 of 16 groups of trajectories are still warming up"),
                  HasSubstr("heat_current has no standard error: fewer than seven eighths")));
}

TEST(GasConduction, WhileAllTrajectoriesWarmUpOnlyARemarkIsStated) {
  for (const Model model : kModelsThatSampleGases) {
    for (const GasShape& shape : {GasShape{1}, GasShape{1, 2000, true}, GasShape{1'000'000}}) {
      EnsembleSpec spec = SpecBetween(1, 0.03, shape, model);
      const auto point = PointExperiment::Create(spec, 0);
      const PointSummary summary = point->Summarize(point->EmptyResult());
      EXPECT_TRUE(summary.estimates.empty());
      EXPECT_TRUE(summary.curves.empty());
      const uint64_t longest = static_cast<uint64_t>(kLongestWarmUp) * point->plan().warm_up();
      EXPECT_THAT(summary.remarks, ElementsAre(HasSubstr(absl::StrCat("with ", longest + 1))));
      // The remark is right: with this number of samples, the last chunk begins after every
      // warm-up.
      spec.target.samples = static_cast<int64_t>(longest + 1);
      const auto longer = PointExperiment::Create(spec, 0);
      EXPECT_GE(longer->plan().FirstSample(longer->plan().chunks() - 1), longest);
    }
  }
}

// Up to 128 columns the bodies of a row have separate places. In a longer gas neighbours share a
// place, at their mean position.
TEST(GasConduction, TheProfileOfALongGasHasSharedPlaces) {
  const auto places = [](const GasShape& shape) {
    const auto point = PointExperiment::Create(SpecBetween(3, 1, shape), 0);
    const SteadyShape& group = dynamic_cast<const SteadyGas&>(*point).shape();
    SteadyGroup measured = group.NewGroup();
    measured.measured = 1;
    BlockResult merged = point->EmptyResult();
    merged.groups[0] = group.Written(std::move(measured));
    const PointSummary summary = point->Summarize(merged);
    std::vector<double> positions;
    for (const CurvePoint& place : summary.curves[0].points) positions.push_back(place.at);
    EXPECT_TRUE(std::is_sorted(positions.begin(), positions.end()));
    return positions;
  };
  EXPECT_EQ(places({.columns = 128}).size(), 2u * 128 + 1);
  const std::vector<double> shared = places({.columns = 129});
  ASSERT_EQ(shared.size(), 257u);
  EXPECT_EQ(shared[0], 0);
  EXPECT_EQ(shared[127], 63.5);
  EXPECT_EQ(shared[128], 64.25);  // of a piston and a ball
  EXPECT_EQ(shared[129], 65);
  EXPECT_EQ(shared[256], 128.75);
  EXPECT_EQ(places({1000, 1000, true}).size(), 257u);
}

TEST(GasConduction, EqualTemperaturesCarryNoCurrent) {
  for (const Model model : kModelsThatSampleGases) {
    const PointSummary summary = RunPoint(SpecBetween(2, 2, {.columns = 3}, model));
    EXPECT_THAT(NamesOf(summary), ElementsAre("heat_current", "exchange_rate", "temperature_ball",
                                              "temperature_piston"));
    // 3 models, 3 estimates and 7 places within 4.5 standard errors: one false alarm in 5,000
    // seeds.
    EXPECT_EQ(summary.estimates[0].exact, 0);
    EXPECT_LT(std::fabs(*summary.estimates[0].ZScore()), 4.5) << Name(model);
    for (const size_t i : {2, 3}) {
      EXPECT_EQ(summary.estimates[i].exact, 2);
      EXPECT_LT(std::fabs(*summary.estimates[i].ZScore()), 4.5) << Name(model);
    }
    for (const CurvePoint& place : summary.curves[0].points) {
      EXPECT_NEAR(place.value, 2, 4.5 * *place.standard_error) << Name(model) << place.at;
    }
  }
}

// ---- times ----

// In halves of the relaxation time.
uint64_t WarmUpOf(const EnsembleSpec& spec) {
  return ForecastOf(spec, PointAt(spec, 0)).trajectories->warm_up;
}

// Exchanges of a contact in the warm-up. A longer gas has shorter stretches, but more of them.
double ExchangesOfAWarmUp(const EnsembleSpec& spec) {
  const PointParameters point = PointAt(spec, 0);
  const GasShape shape = ShapeOf(point[kCells]);
  return ForecastOf(spec, point).collisions / static_cast<double>(shape.contacts()) *
         static_cast<double>(WarmUpOf(spec));
}

// The warm-up grows with the square of the length, and with the time of a slow piston: the current
// passes through the last piston, which is as slow as the cold reservoir. At cold = 1e-8 replicas
// of a thousandth of the time gave 0.57 of the current, with an error of 6 %.
TEST(GasConduction, TheWarmUpIsThatOfTheSlowestPart) {
  const auto of_length = [](int64_t columns) {
    return ExchangesOfAWarmUp(SpecBetween(3, 1, {.columns = columns}));
  };
  EXPECT_EQ(WarmUpOf(SpecBetween(3, 1)), 2u);
  EXPECT_NEAR(of_length(19) / of_length(9), 4, 1e-12);
  EXPECT_NEAR(of_length(1'600) / of_length(299), std::pow(1'601. / 300, 2), 1e-8);
  const auto at_cold = [](Model model, double cold) {
    return ExchangesOfAWarmUp(SpecBetween(1, cold, {.columns = 1}, model));
  };
  EXPECT_NEAR(at_cold(Model::kBilliard, 1e-10) / at_cold(Model::kBilliard, 1e-8), 10, 1e-6);
  // At T = 2e-10 of the mean temperature, the mean of stroke/v is
  // stroke int_0^inf exp(-v^2/(2 T)) dv/T.
  const GasGeometry gas =
      GasGeometry::Create(kPaperRho, 0.2, {.columns = 1}, GasEnds::kReservoirs).value();
  const double crossing = gas.pair().stroke() * std::sqrt(std::numbers::pi / 4e-10);
  const double in_crossings =
      at_cold(Model::kBilliard, 1e-10) / (InfiniteGasExchangeRate(gas, 1) * crossing);
  EXPECT_NEAR(in_crossings, 8, 1e-8);  // of two halves, times 8
  EXPECT_NEAR(at_cold(Model::kBilliard, 0.012) / at_cold(Model::kBilliard, 0.01), 1, 1e-12);
  EXPECT_NEAR(at_cold(Model::kMarkov, 1e-10) / at_cold(Model::kMarkov, 0.01), 1, 1e-12);
}

// After one relaxation time the mean z-score of the pistons' temperature was 0.9 +- 0.1 in 80 first
// answers of 1x225 cells of the billiard between 1 and 0.15, and 0.9 +- 0.2 in 30 of 1x2000 cells
// of the jump process between 1 and 0.2.
TEST(GasConduction, ALargeGasAndABilliardBesideAColdReservoirWarmUpLonger) {
  for (const auto& [cold, of_billiard] :
       {std::pair(1.0, 2u), {0.34, 2u}, {0.15, 4u}, {0.14, 8u}, {0.01, 16u}, {1e-8, 16u}}) {
    for (const Model model : kModelsThatSampleGases) {
      EXPECT_EQ(WarmUpOf(SpecBetween(1, cold, {.columns = 3}, model)),
                model == Model::kMarkov ? 2u : of_billiard)
          << cold;
    }
  }
  for (const auto& [rows, halves] :
       {std::pair(225, 2u), {226, 4u}, {1'662, 4u}, {1'663, 8u}, {90'771, 8u}, {90'772, 16u}}) {
    EXPECT_EQ(WarmUpOf(SpecBetween(1, 0.2, {1, rows, true}, Model::kMarkov)), halves) << rows;
  }
}

// The store keeps the states of all groups in a value of at most 10^9 bytes. A wide lattice has two
// pistons for each ball, and a billiard four numbers for a ball and two for a piston: 16 groups of
// 10^6 cells would take 1.02e9 bytes.
TEST(GasConduction, TheStatesOfALargeGasFitIntoTheStore) {
  const auto groups = [](Model model, int64_t columns) {
    const EnsembleSpec spec = SpecBetween(2, 1, {columns, 2, true}, model);
    return ForecastOf(spec, PointAt(spec, 0)).trajectories->groups;
  };
  EXPECT_EQ(groups(Model::kBilliard, 300'000), 16u);
  EXPECT_EQ(groups(Model::kBilliard, 500'000), 8u);
  EXPECT_EQ(groups(Model::kMarkov, 500'000), 16u);
}

// The rate of exchanges in long runs is 0.06340(1). After a warm-up of one relaxation time it was
// 0.5 standard errors too high in runs of 128 samples, so the mean z-score of 80 runs was 4 of its
// errors above 0. With the tolerance of 3.1 a false alarm has the probability 0.002.
TEST(GasConduction, AShortRunBesideAColdReservoirIsStationary) {
  constexpr double kRate = 0.06340, kRuns = 80;
  double sum = 0;
  for (int seed = 0; seed < kRuns; ++seed) {
    EnsembleSpec spec = SpecBetween(1, 0.01, {.columns = 1});
    spec.seed = static_cast<uint64_t>(seed);
    spec.target.samples = 1;
    const Estimate rate = Named("exchange_rate", RunPoint(spec).estimates);
    sum += (rate.value - kRate) / *rate.standard_error;
  }
  EXPECT_LT(std::fabs(sum) / std::sqrt(kRuns), 3.1);
}

// ---- fluctuations ----

// Intervals of 95 % from 16,900 samples would cover 89 % at the first window of the fourth
// cumulant, and 91 % at that of the third.
TEST(GasConduction, AWindowOfTheChargeIsStatedFromEnoughLongWindowsOn) {
  const auto stated = [](int64_t samples) {
    EnsembleSpec spec = SpecBetween(1.5, 0.5, {.columns = 1}, Model::kMarkov);
    spec.target.samples = samples;
    std::vector<size_t> windows;  // of the second to the fourth cumulant
    for (const Curve& curve : RunPoint(spec).curves) windows.push_back(curve.points.size());
    return std::vector<size_t>(windows.begin() + 1, windows.end());
  };
  EXPECT_THAT(stated(3000), testing::IsEmpty());
  EXPECT_THAT(stated(16'900), ElementsAre(5));
  EXPECT_THAT(stated(66'000), ElementsAre(7, 3));
  EXPECT_THAT(stated(264'000), ElementsAre(9, 5, 3));
}

// ---- samples that continue each other: steady_gas.h, steady_group.h ----

TEST(SteadyGas, ADamagedStateCannotContinue) {
  const auto point = PointOf("gas-conduction delta=0.2 samples=1 model=billiard seed=5");
  const GroupState state = FoldPoint(*point).groups[3];
  EXPECT_TRUE(point->CanContinue(state));
  EXPECT_FALSE(point->CanContinue({}));
  const auto with = [&](size_t place, double number) {
    std::vector<double> numbers(state.numbers().begin(), state.numbers().end());
    numbers[place] = number;
    return GroupState(std::move(numbers));
  };
  const size_t last = state.numbers().size() - 1;  // a piston's velocity, after its offset
  EXPECT_FALSE(point->CanContinue(with(last, std::nan(""))));
  EXPECT_FALSE(point->CanContinue(with(last - 1, 0.9)));
  EXPECT_FALSE(point->CanContinue(with(0, -1)));
  EXPECT_FALSE(point->CanContinue(with(1, 1e9)));
  std::vector<double> more(state.numbers().begin(), state.numbers().end());
  more.push_back(0);
  EXPECT_FALSE(point->CanContinue(GroupState(std::move(more))));
}

// The variance of 4,000 energies has a standard error of 3 %. The tolerance is 5 standard errors,
// so a false alarm has the probability 6e-7 for each shape.
TEST(SteadyGas, VarianceOfEnergyIsThatOfItsStarts) {
  for (const GasShape& shape : {GasShape{3}, GasShape{3, 2, true}}) {
    const auto point = PointExperiment::Create(
        SpecOf(&kGasConduction, PaperGas(&kGasConduction, 0.2, shape), {}, Model::kBilliard), 0);
    const auto& gas = dynamic_cast<const SteadyGas&>(*point);
    Moments energies;
    for (uint64_t start = 0; start < 4000; ++start) {
      CounterRandom random(1, 2, start);
      energies.Add(EnergyOf(DrawGas(gas.geometry(), gas.TemperaturesAtStart(), random)));
    }
    EXPECT_NEAR(*energies.Variance() / gas.VarianceOfEnergy(), 1, 0.15);
  }
}

TEST(SteadyGroup, WindowsHoldTheWholeCharge) {
  const SteadyShape shape = {.trajectories = 2, .balls = 1, .pistons = 2};
  SteadyGroup group = shape.NewGroup();
  std::vector<double> charges;
  for (int i = 0; i < 13; ++i) {
    charges.push_back(i * i);
    group.AddStretch({charges.back(), 0});
    group = shape.Read(shape.Written(group));  // windows may begin in one chunk and end in another
  }
  for (size_t length = 0; length < 5; ++length) {
    const size_t stretches = size_t{1} << length, windows = charges.size() / stretches;
    Moments expected;
    for (size_t i = 0; i < windows; ++i) {
      const auto first = charges.begin() + static_cast<std::ptrdiff_t>(i * stretches);
      expected.Add(std::accumulate(first, first + static_cast<std::ptrdiff_t>(stretches), 0.0));
      expected.Add(0);
    }
    EXPECT_EQ(group.windows[length], expected) << length;
  }
}

}  // namespace
}  // namespace ballpiston

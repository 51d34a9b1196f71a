// Samples that continue each other, with the experiment `gas-conduction`.
#include "core/experiment/steady_gas.h"

#include "core/ensemble/point_fold.h"
#include "core/experiment/steady_group.h"
#include "tests/core/gas/gases.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

TEST(SteadyGas, ADamagedStateCannotContinue) {
  const auto point = PointExperiment::Create(
      SpecOf(&kGasConduction, PaperGas(&kGasConduction, 0.2), {.samples = 1}, Model::kBilliard, 5),
      0);
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

// ---- steady_group.h ----

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

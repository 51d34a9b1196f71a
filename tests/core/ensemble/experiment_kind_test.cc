// The predicted memory of a point. The measured numbers are the growth of the resident memory of a
// process.
#include "core/ensemble/experiment_kind.h"

#include "core/ensemble/chunk_fold.h"
#include "core/ensemble/point_experiment.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

constexpr GasShape kChain = {.columns = 1'000'000};

EnsembleSpec Gas(const GasShape& shape, Model model, int64_t replicas = 64) {
  return SpecOf(&kGasEquilibrium, PaperGas(&kGasEquilibrium, 0.1, shape), {.samples = replicas},
                model);
}

double Memory(const EnsembleSpec& spec, int threads = 1) {
  return MemoryOf(spec, PointAt(spec, 0), threads);
}

TEST(PointMemory, IsAboveTheMemoryOfOneReplicaAndOfItsOrder) {
  const GasShape lattice = {.columns = 1000, .rows = 1000, .is_lattice = true};
  for (const auto& [shape, model, measured] : {std::tuple(kChain, Model::kBilliard, 361e6),
                                               {lattice, Model::kBilliard, 425e6},
                                               {kChain, Model::kMarkov, 130.9e6},
                                               {lattice, Model::kMarkov, 185.1e6},
                                               {kChain, Model::kBilliardReference, 297.6e6}}) {
    EXPECT_GT(Memory(Gas(shape, model)), measured) << Name(model);
    EXPECT_LT(Memory(Gas(shape, model)), 2.5 * measured) << Name(model);
  }
}

TEST(PointMemory, EachThreadHasReplicasOfItsOwn) {
  const double one = Memory(Gas(kChain, Model::kBilliard));
  EXPECT_GT(Memory(Gas(kChain, Model::kBilliard), 4), 3.5 * one);
  EXPECT_EQ(Memory(Gas(kChain, Model::kBilliard, 1), 4), one);  // no more threads than replicas
}

TEST(PointMemory, IsSmallForPairsAndForAnswersWithoutSamples) {
  EXPECT_LT(Memory(SpecOf(&kEquilibrium, PaperPoint(0.1), {}, Model::kBilliard), 8), 150e6);
  EXPECT_LT(Memory(Gas(kChain, Model::kClosedForm), 8), 10e6);
  EXPECT_LT(Memory(Gas(kChain, Model::kAuto), 8), 10e6);
}

// Measured with blocks of 32,768 to 65,536 samples.
TEST(PointMemory, CountsTheSamplesOfABlock) {
  for (const auto& [experiment, point, model, measured] :
       {std::tuple(&kEnergyRelaxation, PaperPoint(0.3, 0.3), Model::kMarkov, 20.6e6),
        {&kEnergyRelaxation, PaperPoint(0.3, 0), Model::kBilliard, 16.0e6},
        {&kFirstHit, PaperPoint(0.3, 0.1, 1), Model::kBilliard, 8.4e6}}) {
    EXPECT_GT(experiment->forecast(model, point).memory, measured);
  }
  EXPECT_LT(kEnergyRelaxation.forecast(Model::kBilliard, PaperPoint(0.01, 0.3)).memory, 15e6);
}

// Results that wait for a slow block: the window's number of histograms.
TEST(PointMemory, CountsTheWaitingResults) {
  for (const auto& [experiment, point] : {std::pair(&kFirstHit, PaperPoint(0.2, 0.1, 1)),
                                          std::pair(&kMarkovProperty, PaperPoint(0.2))}) {
    const EnsembleSpec spec = SpecOf(experiment, point, {}, Model::kBilliard);
    double bytes = 0;
    const BlockResult result = PointExperiment::Create(spec, 0)->EmptyResult();
    for (const Histogram& histogram : result.histograms) {
      bytes += static_cast<double>(histogram.counts.size() * sizeof(uint64_t));
    }
    EXPECT_GT(experiment->memory_of_a_result, bytes) << experiment->name;
    EXPECT_GT(Memory(spec), static_cast<double>(ChunkFold::kWindow) * bytes) << experiment->name;
  }
}

}  // namespace
}  // namespace ballpiston

// The same question gives the same bits: under every instruction set with fused multiply-add, and
// in every later version with the same kEngineVersion.
//
// To change bits on purpose, raise kEngineVersion in core/engine_version.h, so that no point is
// resumed from a checkpoint of another version. Then put the lines that this command prints into
// kGoldenBits:
//   statistical_test --gtest_filter='*Golden*' | grep '^{'
// An unintended change of bits is a defect.
//
// The closed forms beside the estimates and the relative entropy are not compared: their sines and
// logarithms come from the C library. The summaries of experiments that are compared with the limit
// are not compared either, because the spectrum contributes to their estimates. Neither are the
// summaries of gases, because the exact exchange rate contributes to them.
#include "absl/strings/str_replace.h"
#include "core/ensemble/experiment_kind.h"
#include "core/ensemble/point_experiment.h"
#include "core/ensemble/point_fold.h"
#include "core/markov/jump_process.h"
#include "tests/core/billiard/each_target.h"
#include "tests/core/billiard/recorded_collisions.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"

namespace ballpiston {
namespace {

const std::map<std::string_view, uint64_t> kGoldenBits = {
    {"markov, energy-relaxation", 0x181b7b919340ebea},
    {"markov, gas-conduction", 0x63322949768fc7b8},
    {"markov, gas-equilibrium", 0x0baf195a0cce6a1b},
    {"markov, markov-property", 0xd1e1b9f31e1b197e},
    {"reference, conditional-mean-free-time", 0x016997aa5342f5ec},
    {"reference, energy-relaxation", 0x715f8d30f5d8e8d5},
    {"reference, equilibrium", 0xb8705a21d330bc21},
    {"reference, first-hit", 0x09c6d69b0234d43f},
    {"reference, gas-conduction", 0x448108566ef79f4c},
    {"reference, gas-equilibrium", 0xe88645b591880723},
    {"reference, gas-lyapunov", 0x85e1d4cb17620059},
    {"reference, lyapunov", 0xa9e332ccec9fbef4},
    {"reference, markov-property", 0x61a3f3407f44c8b7},
    {"lanes, conditional-mean-free-time", 0x125bca451c9b5919},
    {"lanes, energy-relaxation", 0x6b14200c84371d7b},
    {"lanes, equilibrium", 0x02fa3a8d876b7ef4},
    {"lanes, first-hit", 0x68e3b0222deb3e69},
    {"lanes, gas-conduction", 0x578b29e5b5d20a04},
    {"lanes, gas-equilibrium", 0x03a26b381467f9c0},
    {"lanes, gas-lyapunov", 0x85e1d4cb17620059},
    {"lanes, lyapunov", 0xf9800a4e4e12ecd3},
    {"lanes, markov-property", 0x1f9e3efb4888a488},
    {"lanes single, conditional-mean-free-time", 0xb3aa8432cdd69bf8},
    {"lanes single, energy-relaxation", 0xff1cc66d7748f57a},
    {"lanes single, equilibrium", 0xd28b245038f9f3b3},
    {"lanes single, first-hit", 0x5543c1ba4b0a0a8e},
    {"lanes single, lyapunov", 0x5f89c14acd3606c1},
    {"lanes single, markov-property", 0x347f9ef3dd66da1a},
    {"jump process, walkers after 1 jumps", 0x0049c16fa40bbb71},
    {"jump process, walkers after 10 jumps", 0x52df7e3171c109d0},
};

// FNV-1a, by words.
class Fingerprint {
 public:
  template <typename... Numbers>  // of 64 bits each
  void Add(Numbers... numbers) {
    ((hash_ = (hash_ ^ std::bit_cast<uint64_t>(numbers)) * 0x100000001b3), ...);
  }

  void Add(const BlockResult& result) {
    Add(result.samples, result.health.escapes, result.health.max_energy_error);
    for (const Moments& m : result.moments) Add(m.count, m.mean, m.m2, m.m3, m.m4);
    for (const BatchMeans& b : result.batch_means) {
      const Moments& m = b.numerator;
      Add(m.count, m.mean, m.m2, m.m3, m.m4, b.mean_denominator, b.c_nd, b.c_dd);
    }
    for (const Histogram& h : result.histograms) {
      Add(h.lower, h.upper);
      for (const uint64_t count : h.counts) Add(count);
    }
    for (const GroupState& group : result.groups) {
      for (const double x : group.numbers()) Add(x);
    }
  }

  void Add(const PointSummary& summary) {
    Add(summary.samples);
    for (const Estimate& estimate : summary.estimates) {
      Add(estimate.value, estimate.standard_error.value_or(-1));
    }
  }

  uint64_t hash() const { return hash_; }

 private:
  uint64_t hash_ = 0xcbf29ce484222325;
};

void ExpectGolden(const std::string& of, const Fingerprint& fingerprint) {
  const auto golden = kGoldenBits.find(of);
  if (golden != kGoldenBits.end() && golden->second == fingerprint.hash()) return;
  std::ostringstream line;
  line << "{\"" << of << "\", 0x" << std::hex << std::setfill('0') << std::setw(16)
       << fingerprint.hash() << "},";
  static std::set<std::string> told;
  if (told.insert(line.str()).second) std::cout << line.str() << "\n";
  ADD_FAILURE() << "other bits than in kGoldenBits: " << line.str();
}

void ForEachTargetOf(Engine engine, const std::function<void()>& test) {
  engine == Engine::kReference ? test() : ForEachFusedTarget(test);
}

const char* Name(Engine engine) {
  return engine == Engine::kReference ? "reference"
         : engine == Engine::kLanes   ? "lanes"
                                      : "lanes single";
}

class Golden : public testing::TestWithParam<Engine> {};

std::vector<EnsembleSpec> SpecsOf(Engine engine) {
  const Target collisions = {.collisions = 1000}, samples = {.samples = 1000};
  std::vector<EnsembleSpec> specs = {
      SpecOf(&kEquilibrium, PaperPoint(0.2), collisions),
      SpecOf(&kEquilibrium, {{kRho, 0.501}, {kDelta, 0.18}}, collisions),
      SpecOf(&kEquilibrium, {{kRho, 0.7}, {kDelta, 0.004}}, collisions),
      SpecOf(&kConditionalMeanFreeTime, PaperPoint(0.2, 0.125), samples),
      SpecOf(&kFirstHit, PaperPoint(0.2, 0.125, 5), samples),
      SpecOf(&kFirstHit, PaperPoint(0.2, 0.125, 2.5), samples),
      SpecOf(&kEnergyRelaxation, PaperPoint(0.2), {.samples = 100}),
      SpecOf(&kEnergyRelaxation, PaperPoint(0.2, 0.01), {.samples = 200}),
      SpecOf(&kMarkovProperty, PaperPoint(0.2), {.collisions = 5000}),
      SpecOf(&kLyapunov, PaperPoint(0.2), {.collisions = 5000}),
      SpecOf(&kLyapunov, {{kRho, 0.501}, {kDelta, 0.18}}, {.collisions = 5000})};
  if (engine != Engine::kLanesSingle) {
    for (const ExperimentKind* gas : {&kGasEquilibrium, &kGasConduction, &kGasLyapunov}) {
      for (const GasShape& shape : {GasShape{3}, GasShape{2, 2, true}}) {
        // 512 stretches of trajectories are two stages.
        const int64_t samples = gas == &kGasConduction ? 512 : 64;
        specs.push_back(SpecOf(gas, PaperGas(gas, 0.2, shape), {.samples = samples}));
      }
    }
  }
  for (EnsembleSpec& spec : specs) {
    spec.seed = 42;
    spec.model = engine == Engine::kReference ? Model::kBilliardReference : Model::kBilliard;
    if (engine == Engine::kLanesSingle) spec.precision = Precision::kSingle;
  }
  return specs;
}

// The blocks of a point. The run pauses at every opportunity.
struct PausingQueue : BlockQueue {
  explicit PausingQueue(const PointExperiment& experiment) : point(experiment) {}
  std::optional<Block> Next() override { return point.NextBlock(); }
  void Done(const Block& block, BlockResult result) override {
    point.Add(block, std::move(result));
  }
  bool Pause() override { return true; }

  LocalPoint point;
};

BlockResult RunWithPauses(const PointExperiment& experiment) {
  PausingQueue queue(experiment);
  const auto run = experiment.StartRun(queue);
  while (!run->Advance()) continue;
  EXPECT_TRUE(queue.point.finished());
  return queue.point.Merged();
}

bool HasSummaryWithLastBitsOfTheLibrary(const ExperimentKind* experiment) {
  return experiment == &kEnergyRelaxation || experiment == &kMarkovProperty || IsOfAGas(experiment);
}

// One fingerprint for each experiment.
void ExpectGoldenPoints(const std::vector<EnsembleSpec>& specs, absl::string_view made_by) {
  std::map<std::string, Fingerprint> fingerprints;
  for (const EnsembleSpec& spec : specs) {
    if (!spec.experiment->IsAnsweredBy(spec.model)) continue;
    const auto point = PointExperiment::Create(spec, 0);
    const BlockResult merged = RunWithPauses(*point);
    Fingerprint& fingerprint = fingerprints[std::string(spec.experiment->name)];
    fingerprint.Add(merged);
    if (HasSummaryWithLastBitsOfTheLibrary(spec.experiment)) continue;
    fingerprint.Add(point->Summarize(merged));
  }
  for (const auto& [experiment, fingerprint] : fingerprints) {
    ExpectGolden(absl::StrCat(made_by, ", ", experiment), fingerprint);
  }
}

TEST_P(Golden, BlocksAndSummaries) {
  const Engine engine = GetParam();
  ForEachTargetOf(engine, [engine] { ExpectGoldenPoints(SpecsOf(engine), Name(engine)); });
}

// Jumps contract differences, so the bits of one jump are the most sensitive; later jumps check the
// order of the words.
TEST(GoldenJumpProcess, Walkers) {
  ForEachFusedTarget([] {
    for (const auto& [jumps, count] : {std::pair(1, 10'000), {10, 1000}}) {
      std::vector<double> starts;
      for (int i = 0; i < count; ++i) starts.push_back((i % 65) / 64.0);
      JumpWalkers walkers(3, 4, 0, starts);
      for (int n = 0; n < jumps; ++n) walkers.Jump();
      Fingerprint fingerprint;
      for (const double u : walkers.u()) fingerprint.Add(u);
      for (const double time : walkers.waiting_times()) fingerprint.Add(time);
      ExpectGolden(absl::StrCat("jump process, walkers after ", jumps, " jumps"), fingerprint);
    }
  });
}

TEST(GoldenJumpProcess, Blocks) {
  ForEachFusedTarget([] {
    std::vector<EnsembleSpec> specs = SpecsOf(Engine::kLanes);
    for (EnsembleSpec& spec : specs) spec.model = Model::kMarkov;
    ExpectGoldenPoints(specs, "markov");
  });
}

INSTANTIATE_TEST_SUITE_P(Engines, Golden, testing::ValuesIn(kEngines), [](const auto& test) {
  return absl::StrReplaceAll(Name(test.param), {{" ", "_"}});
});

}  // namespace
}  // namespace ballpiston

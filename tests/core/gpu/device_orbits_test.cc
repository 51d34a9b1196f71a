// The flights of a device, computed by a processor here, give the bits of the lanes, also if the
// device fails. tests/benchmark/gpu_benchmark.cc compares a GPU.
#include "core/gpu/device_orbits.h"

#include "core/billiard/lane_constants.h"
#include "core/ensemble/point_fold.h"
#include "tests/core/billiard/each_target.h"
#include "tests/core/billiard/recorded_collisions.h"
#include "tests/core/gpu/host_flights.h"
#include "tests/core/one_point_spec.h"
#include "tests/core/preamble.h"
#include "tools/flows/lane_balls.h"

namespace ballpiston {
namespace {

// ---- a flight ----

std::vector<LaneFrame> SomeBalls(const PairGeometry& geometry, uint64_t count) {
  std::vector<LaneFrame> balls;
  for (uint64_t i = 0; i < count; ++i) {
    CounterRandom random(3, 4, i);
    const PairState state = DrawFromFlowMeasure(geometry, random);
    balls.push_back(FrameOfBall(state.position, state.direction));
  }
  return balls;
}

TEST(Flight, HasTheBitsOfALane) {
  constexpr uint64_t kBalls = 100, kHits = 200;
  for (const PairGeometry& geometry : GeometriesOfFlows()) {
    const double scale = FlightConstants<double>(geometry).scale;
    const std::vector<LaneFrame> starts = SomeBalls(geometry, kBalls);
    ForEachFusedTarget([&] {
      std::vector<LaneHit> hits(kBalls * kHits);
      FlyLaneBalls(geometry, starts, kHits, hits);
      for (uint64_t i = 0; i < kBalls; ++i) {
        FlightBall ball = BallOf(Scaled(starts[i], scale));
        for (uint64_t hit = 0; hit < kHits; ++hit) {
          ball.path = 0;
          Fly(ProgramOf(geometry), ball);
          const LaneHit& lane = hits[i * kHits + hit];
          ASSERT_EQ(ball.h * (1 / scale), lane.frame.h);
          ASSERT_EQ(ball.e * (1 / scale), lane.frame.e);
          ASSERT_EQ(ball.c * (1 / scale), lane.frame.c);
          ASSERT_EQ(ball.s * (1 / scale), lane.frame.s);
          ASSERT_EQ(ball.path / scale, lane.length);
          ASSERT_EQ(IsSet(ball.a), lane.frame.a < 0);
          ASSERT_EQ(IsSet(ball.a ^ ball.ab), lane.frame.b < 0);
          ASSERT_EQ(IsSet(ball.m), lane.frame.m < 0);
        }
      }
    });
  }
}

// ---- orbits ----

class OrbitsOf : public RecordedCollisions {
 public:
  OrbitsOf(const PairGeometry& geometry, uint64_t orbits, size_t collisions, OrbitDevice* device)
      : RecordedCollisions(geometry, orbits, collisions), device_(device) {}
  OrbitDevice* Device() const override { return device_; }

 private:
  OrbitDevice* device_;
};

// What the orbits of a device reported, and its failures.
struct Outcome {
  std::vector<std::vector<Collision>> collisions;
  std::vector<std::string> failures;
};

Outcome OnDevice(const PairGeometry& geometry, uint64_t orbits, size_t collisions, size_t lanes,
                 HostFaults faults = {}) {
  Outcome outcome;
  OrbitsOnDevice device(
      std::make_unique<HostDevice>(lanes, faults), 1,
      [&](const absl::Status& status) { outcome.failures.emplace_back(status.message()); });
  OrbitsOf source(geometry, orbits, collisions, &device);
  EXPECT_TRUE(RunOrbits(Engine::kLanes, geometry, orbits, source));
  outcome.collisions = source.by_orbit();
  return outcome;
}

void ExpectBitsOfTheLanes(const PairGeometry& geometry, uint64_t orbits, size_t collisions,
                          const Outcome& outcome) {
  ForEachFusedTarget([&] {
    const RecordedCollisions lanes = Recorded(Engine::kLanes, geometry, orbits, collisions);
    ASSERT_EQ(lanes.by_orbit().size(), outcome.collisions.size());
    for (uint64_t orbit = 0; orbit < orbits; ++orbit) {
      ASSERT_EQ(lanes.by_orbit()[orbit].size(), outcome.collisions[orbit].size());
      for (size_t i = 0; i < lanes.by_orbit()[orbit].size(); ++i) {
        ExpectSameBits(lanes.by_orbit()[orbit][i], outcome.collisions[orbit][i]);
      }
    }
  });
}

TEST(OrbitsOnDevice, HaveTheBitsOfTheLanes) {
  constexpr uint64_t kOrbits = 50, kCollisions = 3;
  for (const double rho : {0.501, kPaperRho, 0.7}) {
    for (const double share : {1.0, 0.5, 0.25}) {
      const PairGeometry geometry = GeometryAtShare(rho, share);
      const Outcome outcome = OnDevice(geometry, kOrbits, kCollisions, 64);
      EXPECT_TRUE(outcome.failures.empty());
      ExpectBitsOfTheLanes(geometry, kOrbits, kCollisions, outcome);
    }
  }
}

TEST(OrbitsOnDevice, DoNotDependOnTheNumberOfLanes) {
  for (const size_t lanes : {1u, 7u, 500u}) {
    ExpectBitsOfTheLanes(kPaperPair, 200, 4, OnDevice(kPaperPair, 200, 4, lanes));
  }
}

TEST(OrbitsOnDevice, GoOnAfterAFalseAlarm) {
  for (const double delta : {0.05, 0.2}) {
    const PairGeometry geometry = PaperGeometry(delta);
    const Outcome outcome = OnDevice(geometry, 300, 3, 64, {.false_alarm = 1});
    ExpectBitsOfTheLanes(geometry, 300, 3, outcome);
  }
}

TEST(OrbitsOnDevice, GoOnInTheLanesWhenTheDeviceFails) {
  const HostFaults faults[] = {{.make = 0}, {.launch = 0}, {.launch = 5}, {.land = 0}, {.land = 5}};
  const char* const messages[] = {"memory full", "no launch", "no launch", "device lost",
                                  "device lost"};
  for (size_t i = 0; i < std::size(faults); ++i) {
    const Outcome outcome = OnDevice(kPaperPair, 300, 4, 64, faults[i]);
    EXPECT_EQ(outcome.failures, std::vector<std::string>{messages[i]});
    ExpectBitsOfTheLanes(kPaperPair, 300, 4, outcome);
  }
}

TEST(OrbitsOnDevice, AFailureIsReportedOnceAndNoLaterRunUsesTheDevice) {
  int failures = 0;
  OrbitsOnDevice device(std::make_unique<HostDevice>(64, HostFaults{.land = 0}), 1,
                        [&](const absl::Status&) { ++failures; });
  for (int run = 0; run < 3; ++run) {
    OrbitsOf source(kPaperPair, 100, 2, &device);
    EXPECT_TRUE(RunOrbits(Engine::kLanes, kPaperPair, 100, source));
    EXPECT_TRUE(device.has_failed());
  }
  EXPECT_EQ(failures, 1);
}

TEST(OrbitsOnDevice, AllRunsHaveUpToTwiceTheLanesOfTheDevice) {
  for (const size_t runs : {1u, 2u, 8u}) {
    OrbitsOnDevice device(std::make_unique<HostDevice>(64), runs, [](const absl::Status&) {});
    EXPECT_EQ(device.orbits(), runs == 1 ? 64u : 128u);
  }
}

// ---- experiments ----

class OneBlock : public BlockQueue {
 public:
  OneBlock(const Block& block, OrbitDevice& device) : block_(block), device_(device) {}

  std::optional<Block> Next() override { return std::exchange(block_, std::nullopt); }
  void Done(const Block&, BlockResult result) override { result_ = std::move(result); }
  bool Pause() override { return (++looks_ & 1) != 0; }
  OrbitDevice* device() const override { return &device_; }
  std::stop_token stop() const override { return {}; }
  const BlockResult& result() const { return result_; }

 private:
  std::optional<Block> block_;
  OrbitDevice& device_;
  BlockResult result_;
  int looks_ = 0;
};

BlockResult BlockOnDevice(const PointExperiment& experiment, const Block& block) {
  OrbitsOnDevice device(std::make_unique<HostDevice>(64), 1, [](const absl::Status&) {});
  OneBlock queue(block, device);
  const std::unique_ptr<EngineRun> run = experiment.StartRun(queue);
  while (!run->Advance()) {
  }
  return queue.result();
}

EnsembleSpec QuestionAt(const ExperimentKind* experiment, double delta, double epsilon) {
  std::optional<double> at_epsilon, exponent;
  if (experiment == &kConditionalMeanFreeTime || experiment == &kFirstHit) at_epsilon = epsilon;
  if (experiment == &kFirstHit) exponent = 2;
  return SpecOf(experiment, PaperPoint(delta, at_epsilon, exponent), {.samples = 1000},
                Model::kBilliard, 5);
}

void ExpectSameBlock(const EnsembleSpec& spec, uint64_t samples) {
  const auto experiment = PointExperiment::Create(spec, 0);
  const Block block = {.first = 700, .samples = samples};
  const BlockResult on_device = BlockOnDevice(*experiment, block);
  EXPECT_GT(on_device.samples, 0u);
  ForEachFusedTarget(
      [&] { EXPECT_EQ(DigestOf(*RunBlock(*experiment, block)), DigestOf(on_device)); });
}

TEST(OrbitsOnDevice, GiveTheBlocksOfTheLanes) {
  for (const double delta : {0.1, 0.2}) {
    ExpectSameBlock(QuestionAt(&kEquilibrium, delta, 0), 300);
    for (const double epsilon : {0.0, 0.125, 0.4, 0.5}) {  // at rest: the piston, the ball
      ExpectSameBlock(QuestionAt(&kConditionalMeanFreeTime, delta, epsilon), 200);
      ExpectSameBlock(QuestionAt(&kFirstHit, delta, epsilon), 200);
    }
    ExpectSameBlock(QuestionAt(&kMarkovProperty, delta, 0), 300);
  }
}

// Orbits of these expire at a time limit.
TEST(OrbitsOnDevice, ExpireAsInTheLanes) {
  ExpectSameBlock(QuestionAt(&kEnergyRelaxation, 0.2, 0), 100);
}

}  // namespace
}  // namespace ballpiston

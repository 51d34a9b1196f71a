// Simulated worlds with fixed seeds. Two variables of the environment change this:
//   BALLPISTON_SIMULATION_SECONDS  simulates worlds with random seeds for this time
//   BALLPISTON_SIMULATION_SEED     the first seed; the next ones follow it
#include "tests/simulation/simulation.h"

#include "absl/strings/str_join.h"
#include "tests/support/nightly.h"
#include "tests/support/preamble.h"

namespace ballpiston::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr uint64_t kWorlds = 14;  // of make test: some 20 s of a core
constexpr int kRunsToShrink = 60;

SimulationReport Simulate(const SimulationOptions& options) { return Simulation(options).Run(); }

std::string TextOf(const SimulationOptions& options) {
  std::vector<std::string> happens = {absl::StrCat(options.clients, " clients")};
  for (size_t kind = 0; kind < kKinds; ++kind) {
    if (options.happens[kind]) happens.push_back(kNamesOfKinds[kind]);
  }
  return absl::StrCat("seed ", options.seed, ", ", options.steps,
                      " steps: ", absl::StrJoin(happens, ", "));
}

// Removes kinds of events, clients and steps as long as the same check fails. Simulates at most
// `runs` worlds.
SimulationOptions Shrunk(SimulationOptions options, const Finding& finding, int runs) {
  const auto try_with = [&](const auto& change) {
    SimulationOptions fewer = options;
    change(fewer);
    if (runs-- <= 0) return;
    const std::optional<Finding> found = Simulate(fewer).finding;
    if (found && found->check == finding.check) options = fewer;
  };
  for (size_t kind = 0; kind < kKinds; ++kind) {
    try_with([kind](SimulationOptions& fewer) { fewer.happens[kind] = false; });
  }
  for (int clients = 1; clients < options.clients; ++clients) {
    try_with([clients](SimulationOptions& fewer) { fewer.clients = clients; });
  }
  for (int i = 0; i < 12; ++i) {
    try_with([](SimulationOptions& fewer) { fewer.steps /= 2; });
  }
  return options;
}

// Prints a failing world, and the last events of a smaller one that fails the same check.
void Report(const SimulationOptions& options, const Finding& finding) {
  std::cout << TextOf(options) << "\n  " << finding.what << std::endl;
  const SimulationOptions fewer = Shrunk(options, finding, kRunsToShrink);
  const SimulationReport short_one = Simulate(fewer);
  const Finding& shown = short_one.finding ? *short_one.finding : finding;
  std::cout << "shrunk to " << TextOf(fewer) << "\n";
  for (const std::string& line : shown.story) std::cout << "  " << line << "\n";
  std::cout << "  " << shown.what << "\n";
  ADD_FAILURE() << finding.what;
}

TEST(Simulation, EveryPromiseHoldsInEveryWorld) {
  const auto seconds = NumberFromEnvironment("BALLPISTON_SIMULATION_SECONDS");
  const uint64_t seed = NumberFromEnvironment("BALLPISTON_SIMULATION_SEED")
                            .value_or(seconds ? std::random_device()() : 1);
  SimulationReport all;
  uint64_t worlds = 0;
  std::optional<Finding> finding;
  const auto begin = Clock::now();
  const auto spent = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  while (!finding && (seconds ? spent() < double(*seconds) : worlds < kWorlds)) {
    const SimulationReport report = Simulate({.seed = seed + worlds++});
    all.steps += report.steps;
    all.calls += report.calls;
    all.deaths += report.deaths;
    finding = report.finding;
  }
  std::cout << worlds << " worlds, " << all.steps << " steps, " << all.calls << " calls, "
            << all.deaths << " deaths, " << spent() << " s" << std::endl;
  EXPECT_GT(worlds, 0u);
  if (finding) Report({.seed = seed + worlds - 1}, *finding);
}

TEST(Expectations, ASecondJobOfAKeyIsAViolation) {
  Expectations expectations;
  v1::EnsembleJob first, second;
  first.set_name(JobName("1"));
  second.set_name(JobName("2"));
  for (v1::EnsembleJob* job : {&first, &second}) job->set_state(v1::EnsembleJob::QUEUED);
  const Question question = QuestionOf(kFirstKeyedSeed);
  expectations.Named({}, question, first);
  EXPECT_NO_THROW(expectations.Named({}, question, first));
  EXPECT_THROW(expectations.Named({}, question, second), Violation);
  expectations.AskedToDelete("1");
  EXPECT_NO_THROW(expectations.Named({}, question, second));
}

TEST(Simulation, OneSeedIsOneWorld) {
  const SimulationOptions options = {.seed = 5, .steps = 3000};
  const SimulationReport once = Simulate(options), again = Simulate(options);
  EXPECT_EQ(once.steps, again.steps);
  EXPECT_EQ(once.last_bits, again.last_bits);
}

// In nearly all worlds the server does not start on such a disk, or acknowledged jobs are lost.
TEST(Simulation, ADiskThatReportsFalseFlushesIsDetected) {
  int detected = 0;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    detected += Simulate({.seed = seed, .disk_flushes = false}).finding.has_value();
  }
  EXPECT_GE(detected, 1);
}

}  // namespace
}  // namespace ballpiston::server

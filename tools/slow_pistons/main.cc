// Prints CSV: how long pistons exchange no energy between reservoirs, or the correlation integral
// of the pair by window. README.md describes the arguments and the exit status.
#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/str_format.h"
#include "core/gas/gas_geometry.h"
#include "core/geometry/pair_geometry.h"
#include "core/statistics/stated_error.h"
#include "server/number_range.h"
#include "tools/slow_pistons/correlation_windows.h"
#include "tools/slow_pistons/idle_pistons.h"

namespace ballpiston::slow_pistons {
namespace {

using server::Between;

struct Arguments {
  double rho = 0.529561127988977;
  double delta = 0.2;
  int64_t cells = 1;
  uint64_t orbits = 16384;
  SteadyChain chain = {.hot = 1, .cold = 0.01, .block = 1e5, .blocks = 32};
};

template <typename Geometry>
bool IsValid(const absl::StatusOr<Geometry>& geometry) {
  if (!geometry.ok()) std::cerr << "slow_pistons: " << geometry.status().message() << "\n";
  return geometry.ok();
}

std::string Row(const Moments& moments) {
  return absl::StrFormat("%.10g,%.4g", moments.mean, moments.StandardError().value_or(0));
}

// The columns of a mean that rare events determine. Without any such event the mean was not
// measured.
std::string Row(const Moments& moments, double events) {
  if (HasStatedError(events)) return Row(moments);
  return events > 0 ? absl::StrFormat("%.10g,", moments.mean) : ",";
}

int PrintIdle(const Arguments& arguments) {
  const absl::StatusOr<GasGeometry> geometry = GasGeometry::Create(
      arguments.rho, arguments.delta, GasShape{.columns = arguments.cells}, GasEnds::kReservoirs);
  if (!IsValid(geometry)) return 2;
  const std::vector<IdleShares> pistons = IdlePistons(*geometry, arguments.chain);
  std::cout << "piston,time,share,share_error,limit,limit_error\n";
  for (size_t k = 0; k < pistons.size(); ++k) {
    for (size_t i = 0; i < kIdleTimes.size(); ++i) {
      const IdleShare& at = pistons[k][i];
      std::cout << absl::StrFormat("%d,%g,%s,%s\n", k, kIdleTimes[i], Row(at.share, at.long_idles),
                                   Row(at.limit, at.slow_arrivals));
    }
  }
  return 0;
}

int PrintWindows(const Arguments& arguments) {
  const absl::StatusOr<PairGeometry> geometry =
      PairGeometry::Create(arguments.rho, arguments.delta);
  if (!IsValid(geometry)) return 2;
  const auto windows = CorrelationWindows(*geometry, arguments.orbits, arguments.chain.seed);
  std::cout << "window,all,all_error,idle,idle_error,met,met_error,later_idle,later_idle_error,"
               "later_met,later_met_error,limit_all,limit_idle\n";
  for (size_t i = 0; i < kWindows.size(); ++i) {
    const WindowIntegrals& at = windows[i];
    const std::string later_idle =
        i == 0 ? Row(at.later_idle) : Row(at.later_idle, at.later_idles);  // 0 at the first window
    std::cout << absl::StrFormat("%g,%s,%s,%s,%s,%s,%.10g,%.10g\n", kWindows[i], Row(at.all),
                                 Row(at.idle), Row(at.met), later_idle, Row(at.later_met),
                                 at.limit_all, at.limit_idle);
  }
  return 0;
}

int Run(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Measures slow pistons, and prints CSV.", "slow_pistons");
  app.add_option("--rho", arguments.rho, "radius of the discs")->capture_default_str();
  app.add_option("--delta", arguments.delta, "how far the pistons reach")->capture_default_str();
  app.add_option("--seed", arguments.chain.seed, "of the random numbers")
      ->transform(Between<uint64_t>(0, 1e15))
      ->capture_default_str();
  CLI::App* idle = app.add_subcommand("idle", "s P(no exchange during s) of a chain's pistons");
  idle->add_option("--cells", arguments.cells, "of the chain")
      ->transform(Between<int64_t>(1, 1000));
  const CLI::Validator temperature = Between<double>(1e-9, 1e9);
  idle->add_option("--hot", arguments.chain.hot, "temperature")->transform(temperature);
  idle->add_option("--cold", arguments.chain.cold, "temperature")->transform(temperature);
  idle->add_option("--block", arguments.chain.block, "length of a block of time")
      ->transform(Between<double>(1e-3, 1e9));
  idle->add_option("--blocks", arguments.chain.blocks, "number of blocks")
      ->transform(Between<uint64_t>(2, 1e6));
  CLI::App* windows = app.add_subcommand("windows", "the pair's correlation integral by window");
  windows->add_option("--orbits", arguments.orbits, "number of orbits")
      ->transform(Between<uint64_t>(2, 1e9));
  for (CLI::App* verb : {idle, windows}) verb->fallthrough();
  app.require_subcommand(1);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& parse_error) {
    return app.exit(parse_error) == 0 ? 0 : 2;
  }
  const int status = windows->parsed() ? PrintWindows(arguments) : PrintIdle(arguments);
  return std::cout.good() ? status : 1;
}

}  // namespace
}  // namespace ballpiston::slow_pistons

int main(int argc, char** argv) { return ballpiston::slow_pistons::Run(argc, argv); }

#include "client/command/spec_flags.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/string_view.h"
#include "client/command/number_list.h"
#include "client/command/request_size.h"
#include "client/command/spec_file.h"
#include "client/command/violations.h"
#include "client/library/quoted.h"
#include "client/output/spelling.h"

namespace ballpiston::client {
namespace {

using Flag = std::optional<std::string>;
using Spec = v1::EnsembleSpec;

constexpr double kMaxBudget = 315576000000;  // seconds in a google.protobuf.Duration: 10,000 years

// Experiments that the command line's contract names; this version's proto may lack some.
constexpr absl::string_view kLaterExperiments[] = {"gas-equilibrium", "gas-conduction"};

absl::Status UnknownExperiment(const std::string& text) {
  const std::string name = absl::StrReplaceAll(text, {{"_", "-"}});
  const bool later = std::find(std::begin(kLaterExperiments), std::end(kLaterExperiments), name) !=
                     std::end(kLaterExperiments);
  return absl::InvalidArgumentError(absl::StrCat(
      "experiment ", Quoted(text), later ? " is not offered by this version" : " is unknown",
      "; it offers ", absl::StrJoin(Spellings<Spec::Experiment>(), ", ")));
}

absl::Status SetExperiment(const Flag& flag, Spec& spec) {
  if (!flag) {
    return absl::InvalidArgumentError(
        absl::StrCat("name an EXPERIMENT (", absl::StrJoin(Spellings<Spec::Experiment>(), ", "),
                     ") or give --spec FILE"));
  }
  const auto experiment = FromSpelling<Spec::Experiment>(*flag);
  if (!experiment) return UnknownExperiment(*flag);
  spec.set_experiment(*experiment);
  return absl::OkStatus();
}

template <typename Enum>
absl::StatusOr<Enum> Choice(absl::string_view name, const std::string& text) {
  if (const auto value = FromSpelling<Enum>(text)) return *value;
  return absl::InvalidArgumentError(absl::StrCat(name, ": ", Quoted(text), " is not one of ",
                                                 absl::StrJoin(Spellings<Enum>(), ", ")));
}

// Runs `set` with what `parse` makes of the flag's text, if the flag was given.
template <typename Parse, typename Set>
absl::Status Take(absl::string_view name, const Flag& flag, Parse parse, Set set) {
  if (!flag) return absl::OkStatus();
  auto value = parse(name, *flag);
  if (value.ok()) set(*value);
  return value.status();
}

absl::Status SetGrid(const SpecFlags& flags, v1::Grid& grid) {
  const auto into = [](auto* field) {
    return [field](const auto& list) { field->Add(list.begin(), list.end()); };
  };
  return Violations(
             {Take("--rho", flags.rho, ParseNumberList, into(grid.mutable_rho())),
              Take("--delta", flags.delta, ParseNumberList, into(grid.mutable_delta())),
              Take("--epsilon", flags.epsilon, ParseNumberList, into(grid.mutable_epsilon())),
              Take("--exponent", flags.exponent, ParseNumberList, into(grid.mutable_exponent())),
              Take("--cells", flags.cells, ParseCountList, into(grid.mutable_cells()))})
      .Lines();
}

absl::StatusOr<google::protobuf::Duration> ParseBudget(absl::string_view name,
                                                       absl::string_view text) {
  absl::StatusOr<double> seconds = ParseNumber(name, text);
  if (!seconds.ok()) return seconds.status();
  if (std::abs(*seconds) > kMaxBudget) {
    return absl::InvalidArgumentError(
        absl::StrCat(name, ": ", Quoted(text), " is beyond 10,000 years"));
  }
  google::protobuf::Duration budget;
  budget.set_seconds(static_cast<int64_t>(*seconds));  // both parts have the number's sign
  budget.set_nanos(static_cast<int32_t>((*seconds - std::trunc(*seconds)) * 1e9));
  return budget;
}

absl::Status CheckOneTarget(const SpecFlags& flags) {
  std::vector<std::string> given;
  if (flags.samples) given.push_back("--samples");
  if (flags.collisions) given.push_back("--collisions");
  if (flags.tolerance) given.push_back("--tolerance");
  const size_t kinds = given.size();
  if (flags.budget) given.push_back("--budget");
  if (given.size() <= 1 || (kinds == 1 && flags.tolerance)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(absl::StrJoin(given, " and "),
                   " exclude each other: give at most one of --samples, --collisions, --tolerance, "
                   "--budget; only --tolerance and --budget may stand together"));
}

absl::Status SetTarget(const SpecFlags& flags, Spec& spec) {
  const auto target = [&spec] { return spec.mutable_target(); };
  return Violations({CheckOneTarget(flags),
                     Take("--samples", flags.samples, ParseCount,
                          [&](int64_t n) { target()->set_samples(n); }),
                     Take("--collisions", flags.collisions, ParseCount,
                          [&](int64_t n) { target()->set_collisions(n); }),
                     Take("--tolerance", flags.tolerance, ParseNumber,
                          [&](double x) { target()->set_tolerance(x); }),
                     Take("--budget", flags.budget, ParseBudget,
                          [&](const auto& time) { *target()->mutable_budget() = time; })})
      .Lines();
}

absl::Status SetRest(const SpecFlags& flags, Spec& spec) {
  spec.set_verify(flags.verify);
  return Violations(
             {Take("--seed", flags.seed, ParseSeed, [&](uint64_t seed) { spec.set_seed(seed); }),
              Take("--model", flags.model, Choice<Spec::Model>, [&](auto m) { spec.set_model(m); }),
              Take("--precision", flags.precision, Choice<Spec::Precision>,
                   [&](auto p) { spec.set_precision(p); })})
      .Lines();
}

absl::StatusOr<Spec> FromFlags(const SpecFlags& flags) {
  Spec spec;
  const absl::Status status =
      Violations({SetExperiment(flags.experiment, spec), SetGrid(flags, *spec.mutable_grid()),
                  SetTarget(flags, spec), SetRest(flags, spec)})
          .Lines();
  if (!status.ok()) return status;
  return spec;
}

bool AnyButFile(const SpecFlags& flags) {
  for (const Flag* flag :
       {&flags.experiment, &flags.rho, &flags.delta, &flags.epsilon, &flags.exponent, &flags.cells,
        &flags.samples, &flags.collisions, &flags.tolerance, &flags.budget, &flags.seed,
        &flags.model, &flags.precision}) {
    if (flag->has_value()) return true;
  }
  return flags.verify;
}

}  // namespace

void SpecFlags::AddTo(CLI::App& verb) {
  verb.add_option("EXPERIMENT", experiment, absl::StrJoin(Spellings<Spec::Experiment>(), " | "));
  const std::string grid_group = "Grid (LIST: a,b,c or from:to:count or from:to:count:log)";
  verb.add_option("--rho", rho, "disc radii, 1/2 < rho < 1/sqrt(2)")->group(grid_group);
  verb.add_option("--delta", delta, "piston's penetrations")->group(grid_group);
  verb.add_option("--epsilon", epsilon, "piston's energies, 0 to 1/2; energy-relaxation needs none")
      ->group(grid_group);
  verb.add_option("--exponent", exponent, "n of the outgoing law h^(n)")->group(grid_group);
  verb.add_option("--cells", cells, "sides of the gas, in cells")->group(grid_group);
  const std::string target_group = "Target (at most one, but for --tolerance with --budget)";
  verb.add_option("--samples", samples, "first hits, or orbits, a point")->group(target_group);
  verb.add_option("--collisions", collisions, "ball-piston collisions a point")
      ->group(target_group);
  verb.add_option("--tolerance", tolerance,
                  "relative standard error of the first estimate: a point ends once it is reached")
      ->group(target_group);
  verb.add_option("--budget", budget,
                  "seconds with all workers, shared evenly by the points: the best answer in that "
                  "time; with --tolerance, the job fails if they do not suffice")
      ->group(target_group);
  verb.add_option("--seed", seed, "of the random numbers; 0 if not given");
  verb.add_option("--model", model, absl::StrJoin(Spellings<Spec::Model>(), " | "));
  verb.add_flag(
      "--verify", verify,
      "with --model auto: simulate also what a closed form answers, with the exact values "
      "beside it");
  verb.add_option("--precision", precision, absl::StrJoin(Spellings<Spec::Precision>(), " | "));
  verb.add_option("--spec", file, "file with all of the above as JSON, - for standard input");
}

absl::StatusOr<v1::EnsembleSpec> SpecOf(const SpecFlags& flags) {
  if (flags.file && AnyButFile(flags)) {
    return absl::InvalidArgumentError(
        "--spec holds the whole specification: give no EXPERIMENT, grid, target, --seed, "
        "--model, --verify or --precision with it");
  }
  absl::StatusOr<Spec> spec = flags.file ? ReadSpecFile(*flags.file) : FromFlags(flags);
  if (!spec.ok()) return spec;
  if (absl::Status size = CheckSize(*spec, "spec"); !size.ok()) return size;
  return spec;
}

}  // namespace ballpiston::client

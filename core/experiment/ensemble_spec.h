// What is asked: an experiment over a grid of parameter points, and how much of it.
//
// The plain struct is what came in from outside; `Violations` tells everything that is wrong with
// it, field by field. All other functions of this folder require a spec without violations.
#ifndef BALLPISTON_CORE_EXPERIMENT_ENSEMBLE_SPEC_H_
#define BALLPISTON_CORE_EXPERIMENT_ENSEMBLE_SPEC_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"

namespace ballpiston {

// The numbers decide the random stream of a point: fixed for ever.
enum class Experiment {
  kUnspecified = 0,
  kEquilibrium = 1,
  kConditionalMeanFreeTime = 2,
  kFirstHit = 3,
  kEnergyRelaxation = 4,
  kMarkovProperty = 5,
};
// kMarkov: the jump process of the limit delta -> 0, sampled. kSpectrum: by its generator.
enum class Model { kAuto, kClosedForm, kSpectrum, kMarkov, kBilliard, kBilliardReference };
enum class Precision { kDouble, kSingle };

// Names as users write them, e.g. "first-hit", "billiard_reference".
absl::string_view Name(Experiment experiment);
absl::string_view Name(Model model);
absl::string_view Name(Precision precision);

// The point set is the product of the lists, rho outermost, exponent innermost. A list that the
// experiment uses may not be empty, one that it does not use has to be.
struct Grid {
  std::vector<double> rho = {};
  std::vector<double> delta = {};
  std::vector<double> epsilon = {};
  std::vector<double> exponent = {};
  std::vector<int32_t> cells = {};
};

inline constexpr int64_t kDefaultSamples = 10'000;
inline constexpr int64_t kMaxSamples = 1'000'000'000'000;
inline constexpr int64_t kMaxPoints = 100'000;
inline constexpr double kMaxExponent = 1000;

inline constexpr double kMaxBudgetSeconds = 1e6;

// At most one member is set, but for a budget, which may stand beside a tolerance; none asks for
// kDefaultSamples samples or collisions.
struct Target {
  std::optional<int64_t> samples = {};     // first hits, or orbits, a point
  std::optional<int64_t> collisions = {};  // ball-piston collisions a point
  std::optional<double> tolerance = {};    // relative standard error of the first estimate
  std::optional<double> budget_seconds = {};
};

struct EnsembleSpec {
  Experiment experiment = Experiment::kUnspecified;
  Grid grid = {};
  Target target = {};
  uint64_t seed = 0;
  Model model = Model::kAuto;
  Precision precision = Precision::kDouble;
  bool verify = false;  // AUTO takes no closed form
};

struct FieldViolation {
  std::string field;  // path within the spec, e.g. grid.delta[2]
  std::string description;
};

// Everything wrong with the spec; empty if it can be run.
std::vector<FieldViolation> Violations(const EnsembleSpec& spec);

// One point of the grid; what the experiment does not use is empty.
struct PointParameters {
  double rho = 0;
  double delta = 0;
  std::optional<double> epsilon = {};
  std::optional<double> exponent = {};

  friend bool operator==(const PointParameters&, const PointParameters&) = default;
};

size_t PointCount(const EnsembleSpec& spec);
PointParameters PointAt(const EnsembleSpec& spec, size_t index);  // index < PointCount

// The same question about one of its points, by `model`, with that point's share of a budget.
EnsembleSpec OnePointSpec(const EnsembleSpec& spec, const PointParameters& point, Model model);

}  // namespace ballpiston

#endif  // BALLPISTON_CORE_EXPERIMENT_ENSEMBLE_SPEC_H_

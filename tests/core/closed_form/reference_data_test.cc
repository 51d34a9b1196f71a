// The library, and the printed formulas in plain double, against 25-digit reference values.
#include "absl/strings/match.h"
#include "core/closed_form/conditional_rate.h"
#include "core/closed_form/kernel.h"
#include "core/closed_form/kernel_moments.h"
#include "core/closed_form/mean_free_time.h"
#include "core/closed_form/pair_measures.h"
#include "tests/core/preamble.h"
#include "tests/oracle/reference_table.h"
#include "tools/flows/printed_formulas.h"

namespace ballpiston {
namespace {

using std::numbers::pi;

// The errors that the service guarantees for every row, and for half of the rows.
constexpr double kPromisedError = 1e-12;
constexpr double kPromisedMedian = 1e-14;

struct Errors {
  ErrorTable library;
  ErrorTable printed;
};

Errors GeometryErrors() {
  const ReferenceTable table("closed_forms.csv");
  Errors errors;
  for (size_t row = 0; row < table.rows(); ++row) {
    const double rho = table.Input(row, "rho");
    const double delta = table.Input(row, "delta");
    const auto geometry = PairGeometry::Create(rho, delta);
    if (!geometry.ok()) {
      ADD_FAILURE() << geometry.status();
      continue;
    }
    const PairMeasures m = Measures(*geometry);
    const MeanFreeTimes tau = MeanFreeTimesOf(*geometry);
    const auto p = MeasuresAsPrinted(rho, delta, pi);
    const auto add = [&](const std::string& column, double library, double printed) {
      errors.library.Add(row, column, library, table.Reference(row, column));
      errors.printed.Add(row, column, printed, table.Reference(row, column));
    };
    add("lambda", geometry->lambda(), p.lambda);
    add("eta", m.eta, p.eta);
    add("cell_area", m.cell_area, p.cell_area);
    add("volume", m.volume, p.volume);
    add("area_ball_piston", m.area_ball_piston, p.area_ball_piston);
    add("area_ball_wall", m.area_ball_wall, p.area_ball_wall);
    add("area_piston_wall", m.area_piston_wall, p.area_piston_wall);
    add("tau_ball_piston", tau.ball_piston, 4 * p.volume / p.area_ball_piston);
    add("tau_ball_wall", tau.ball_wall, 4 * p.volume / p.area_ball_wall);
    add("tau_piston_wall", tau.piston_wall, 4 * p.volume / p.area_piston_wall);
  }
  return errors;
}

Errors KernelErrors() {
  const ReferenceTable table("kernel.csv");
  Errors errors;
  for (size_t row = 0; row < table.rows(); ++row) {
    const double ep = table.Input(row, "ep");
    const double eb = 0.5 - ep;
    const auto add = [&](const std::string& column, double library, double printed) {
      errors.library.Add(row, column, library, table.Reference(row, column));
      errors.printed.Add(row, column, printed, table.Reference(row, column));
    };
    const double rate = CollisionRateAsPrinted(eb, ep, pi);
    add("phi", Phi(ep), 4 * rate);
    add("f", PairCollisionRate(ep), rate);
    add("j", PairEnergyCurrent(ep), EnergyCurrentAsPrinted(eb, ep, pi));
    add("h", PairSquaredEnergyTransfer(ep), SquaredTransferAsPrinted(eb, ep, pi));
    for (const std::string& column : table.columns()) {
      if (!absl::StartsWith(column, "w_at_")) continue;
      const double out = std::strtod(column.c_str() + 5, nullptr);
      add(column, PairKernel(ep, out), KernelAsPrinted(eb, ep, out, pi));
    }
  }
  return errors;
}

TEST(ReferenceData, GeometryIsWithinThePromise) {
  const Errors errors = GeometryErrors();
  errors.library.Print("library", errors.printed, "as printed");
  EXPECT_LE(errors.library.WorstOfAll(), kPromisedError);
  EXPECT_LE(errors.library.MedianOfRows(), kPromisedMedian);
  EXPECT_LE(errors.library.WorstOfAll(), kMeanFreeTimeRelativeError);
}

TEST(ReferenceData, KernelIsWithinThePromise) {
  const Errors errors = KernelErrors();
  errors.library.Print("library", errors.printed, "as printed");
  EXPECT_LE(errors.library.WorstOfAll(), kPromisedError);
  EXPECT_LE(errors.library.MedianOfRows(), kPromisedMedian);
  EXPECT_LE(errors.library.WorstOfAll(), kKernelMomentsRelativeError);
}

// Shows that the rows above are difficult. If this test fails, the tests above prove nothing.
TEST(ReferenceData, PrintedFormulasInDoubleBreakThePromise) {
  const Errors errors = GeometryErrors();
  for (const char* column :
       {"lambda", "eta", "cell_area", "volume", "area_ball_piston", "area_ball_wall",
        "area_piston_wall", "tau_ball_piston", "tau_ball_wall", "tau_piston_wall"}) {
    EXPECT_GT(errors.printed.Worst(column), kPromisedError) << column;
  }
  // No digit left of the rate itself.
  EXPECT_GT(errors.printed.Worst("area_ball_piston"), 1);
}

}  // namespace
}  // namespace ballpiston

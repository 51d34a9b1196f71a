#include "tools/stability/cancellation.h"

#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/closed_form/pair_measures.h"
#include "core/geometry/pair_geometry.h"
#include "core/geometry/paper.h"
#include "tools/flows/printed_formulas.h"
#include "tools/flows/quad_precision.h"

namespace ballpiston::stability {
namespace {

// One geometry computed in three ways: naively, by the library, and with 113 bits, which leave
// enough bits after the cancellation.
struct ThreeWays {
  explicit ThreeWays(const PairGeometry& geometry)
      : printed(MeasuresAsPrinted(geometry.rho(), geometry.delta(), std::numbers::pi)),
        library(Measures(geometry)),
        exact(MeasuresAsPrinted<Quad>(geometry.rho(), geometry.delta(), QuadPi())) {}

  PrintedMeasures<double> printed;
  PairMeasures library;
  PrintedMeasures<Quad> exact;
};

Cancellation Compared(std::string quantity, std::string where, double printed, double library,
                      Quad exact) {
  return {std::move(quantity), std::move(where), RelativeError(printed, exact),
          RelativeError(library, exact)};
}

void AddSmallDelta(std::vector<Cancellation>& rows) {
  for (const double delta : {1e-2, 1e-4, 1e-6, 1e-8}) {
    const ThreeWays m(*PairGeometry::Create(kPaperRho, delta));
    const std::string where = absl::StrCat("rho = 0.5296, delta = ", delta);
    rows.push_back(Compared("dG_bp", where, m.printed.area_ball_piston, m.library.area_ball_piston,
                            m.exact.area_ball_piston));
    rows.push_back(Compared("eta", where, m.printed.eta, m.library.eta, m.exact.eta));
  }
}

void AddVanishingCell(std::vector<Cancellation>& rows) {
  for (const double distance : {1e-2, 1e-4, 1e-6, 1e-8}) {
    const double rho = kMaxRho - distance;
    const ThreeWays m(*PairGeometry::Create(rho, 0.5 * PairDeltaBound(rho)));
    const std::string where =
        absl::StrCat("1/sqrt 2 - rho = ", distance, ", delta = half its bound");
    rows.push_back(
        Compared("cell", where, m.printed.cell_area, m.library.cell_area, m.exact.cell_area));
    rows.push_back(Compared("dG_bw", where, m.printed.area_ball_wall, m.library.area_ball_wall,
                            m.exact.area_ball_wall));
    rows.push_back(Compared("eta", where, m.printed.eta, m.library.eta, m.exact.eta));
  }
}

}  // namespace

std::vector<Cancellation> Cancellations() {
  std::vector<Cancellation> rows;
  AddSmallDelta(rows);
  AddVanishingCell(rows);
  return rows;
}

}  // namespace ballpiston::stability

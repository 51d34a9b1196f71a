#include "tools/stability/cancellation.h"

#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/closed_form/pair_measures.h"
#include "core/geometry/pair_geometry.h"
#include "tools/flows/paper.h"
#include "tools/flows/printed_formulas.h"
#include "tools/flows/quad_precision.h"
#include "tools/stability/markdown_table.h"

namespace ballpiston::stability {
namespace {

// One geometry computed in three ways: naively, by the library, and with 113 bits, which leave
// enough bits after the cancellation.
struct ThreeWays {
  explicit ThreeWays(const PairGeometry& geometry)
      : printed(MeasuresAsPrinted(geometry.rho(), geometry.delta(), std::numbers::pi)),
        library(Measures(geometry)),
        exact(MeasuresAsPrinted<Quad>(geometry.rho(), geometry.delta(), QuadPi())) {}

  // `measure` takes one of the measures.
  template <typename Measure>
  void AddTo(MarkdownTable& table, const char* name, const std::string& where,
             const Measure& measure) const {
    table.Add({name, where, ErrorText(RelativeError(measure(printed), measure(exact))),
               ErrorText(RelativeError(measure(library), measure(exact)))});
  }

  PrintedMeasures<double> printed;
  PairMeasures library;
  PrintedMeasures<Quad> exact;
};

}  // namespace

std::string CancellationTable() {
  MarkdownTable table({"quantity", "where", "as printed", "core/closed_form"});
  const auto eta = [](const auto& measures) { return measures.eta; };
  for (const double delta : {1e-2, 1e-4, 1e-6, 1e-8}) {
    const ThreeWays m(*PairGeometry::Create(kPaperRho, delta));
    const std::string where = absl::StrCat("rho = 0.5296, delta = ", delta);
    m.AddTo(table, "dG_bp", where, [](const auto& measures) { return measures.area_ball_piston; });
    m.AddTo(table, "eta", where, eta);
  }
  for (const double distance : {1e-2, 1e-4, 1e-6, 1e-8}) {
    const double rho = kMaxRho - distance;
    const ThreeWays m(*PairGeometry::Create(rho, 0.5 * PairDeltaBound(rho)));
    const std::string where =
        absl::StrCat("1/sqrt 2 - rho = ", distance, ", delta = half its bound");
    m.AddTo(table, "cell", where, [](const auto& measures) { return measures.cell_area; });
    m.AddTo(table, "dG_bw", where, [](const auto& measures) { return measures.area_ball_wall; });
    m.AddTo(table, "eta", where, eta);
  }
  return table.Text(2);
}

}  // namespace ballpiston::stability

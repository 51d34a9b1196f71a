#include "client/figure/relaxation_panel.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/string_view.h"
#include "client/figure/limit_floor.h"
#include "client/figure/plot_marks.h"
#include "client/output/number_text.h"

namespace ballpiston::client {
namespace {

using Measurements = std::vector<MethodMeasurement>;

// Right of what takes the most work, as factors: the deltas stand there.
constexpr double kFloorEnd = 2.2;
constexpr double kDeltaLabelAt = 3;
constexpr double kRoomForDeltas = 150;

// From dark to light as delta falls; viridis, whose luminance tells them apart too. Its other half
// is too light for text on white.
constexpr const char* kColours[] = {"#440154", "#482475", "#414487", "#355f8d",
                                    "#2a788e", "#21918c", "#22a884", "#3bbb75"};

std::string ColourOf(size_t index, size_t count) {
  if (count < 2) return kColours[0];
  return kColours[index * (std::size(kColours) - 1) / (count - 1)];
}

Measurements RunsOf(const Measurements& measurements, absl::string_view method, double delta) {
  Measurements runs;
  std::copy_if(measurements.begin(), measurements.end(), std::back_inserter(runs),
               [&](const MethodMeasurement& m) {
                 return m.quantity == kRelaxationTime && m.method == method && m.delta == delta &&
                        m.samples >= kFewestOrbits;
               });
  return runs;
}

struct Extent {
  Range work;
  Range error;
};

Extent ExtentOf(const Measurements& measurements, const std::vector<LimitFloor>& floors) {
  Extent extent;
  for (const LimitFloor& floor : floors) {
    extent.work.Take(floor.work);
    extent.work.Take(floor.crossing_work.value_or(0));
    extent.error.Take(floor.Height());
    for (const auto method : {kBilliard, kMarkov}) {
      for (const MethodMeasurement& m : RunsOf(measurements, method, floor.delta)) {
        extent.work.Take(m.work);
        extent.error.Take(OwnError(m, floor));
        extent.error.high = std::max(extent.error.high, m.value);
      }
    }
  }
  return extent;
}

// ---- data that the script brings along ----

std::string ChanceLine(const Measurements& runs, const LimitFloor& floor) {
  std::string line;
  for (const MethodMeasurement& m : runs) {
    absl::StrAppend(&line, ExactText(floor.delta), ",", ExactText(m.work), ",",
                    ExactText(OwnError(m, floor)), "\n");
  }
  return line.empty() ? line : line + "\n";
}

std::string ChanceLines(const Measurements& measurements, const std::vector<LimitFloor>& floors) {
  std::string lines = "delta,x,y\n";
  for (const LimitFloor& floor : floors) {
    lines += ChanceLine(RunsOf(measurements, kBilliard, floor.delta), floor);
  }
  return lines;
}

// In units of the limit's own time a walk is the same at every delta: one line stands for all.
std::string ChanceOfWalkers(const Measurements& measurements, const LimitFloor& floor) {
  return "delta,x,y\n" + ChanceLine(RunsOf(measurements, kMarkov, floor.delta), floor);
}

std::string FloorLines(const std::vector<LimitFloor>& floors, double end) {
  std::string lines = "delta,resolved,x,y\n";
  for (const LimitFloor& floor : floors) {
    const std::string height = ExactText(floor.Height());
    for (const double x : {floor.work, end}) {
      absl::StrAppend(&lines, ExactText(floor.delta), ",", floor.IsResolved() ? 1 : 0, ",",
                      ExactText(x), ",", height, "\n");
    }
    lines += "\n";
  }
  return lines;
}

std::string Crossings(const std::vector<LimitFloor>& floors) {
  std::string rows = "delta,x,y\n";
  for (const LimitFloor& floor : floors) {
    if (!floor.crossing_work) continue;
    absl::StrAppend(&rows, ExactText(floor.delta), ",", ExactText(*floor.crossing_work), ",",
                    ExactText(floor.Height()), "\n");
  }
  return rows;
}

std::string DeltaLabels(const std::vector<LimitFloor>& floors, double x, const Range& shown) {
  std::vector<Label> labels;
  for (const LimitFloor& floor : floors) {
    labels.push_back({x, floor.Height(), ExactText(floor.delta)});
  }
  Spread(labels, shown);
  return Text(labels);
}

// ---- the script ----

constexpr char kPanel[] = R"gnuplot(
# ---- d ----
$$chance << EOD
$CHANCE_LINESEOD
$$walkers << EOD
$WALKERSEOD
$$floors << EOD
$FLOOR_LINESEOD
$$crossings << EOD
$CROSSINGSEOD
$$deltas << EOD
$DELTA_LABELSEOD
deltas = "$DELTAS"
shades = "$SHADES"
d = words(deltas)
shade(i) = word(shades, i)
pale_shade(i) = "#70".word(shades, i)[2:]
at(i, y) = column("delta") == word(deltas, i) + 0.0 ? y : NaN
by(i, name, y) = strcol("quantity") eq "relaxation-time" && strcol("method") eq name ? at(i, y) : NaN
enough(x) = column("samples") >= $FEWEST ? x : NaN
edge = $EDGE
set logscale xy
set xrange [$FROM:$TO]
set yrange [edge:$TOP]
set format "10^{%T}"
set xtics 10
set ytics 10
set mxtics 10
set mytics 10
set lmargin screen 0.585
set rmargin screen 0.985
set tmargin screen 0.569
set bmargin screen 0.296
set title "{/:Bold d}  relaxation time: where the limit δ → 0 will do" offset 0,-0.4
set xlabel "work / s" offset 0,0.4
set ylabel "relative error" offset 0.5,0
plot $$walkers using "x":"y" with lines lw 1.5 lc rgb "#999999", \
     for [i=1:d] $$chance using (at(i, column("x"))):"y" with lines lw 1.5 lc rgb shade(i), \
     for [i=1:d] $$floors using (column("resolved") == 1 ? at(i, column("x")) : NaN):"y" \
       with lines lw 1.5 dt (8,5) lc rgb shade(i), \
     for [i=1:d] $$floors using (column("resolved") == 0 ? at(i, column("x")) : NaN):"y" \
       with lines lw 1.7 dt (2,4) lc rgb shade(i), \
     for [i=1:d] for [m in "billiard markov"] \
       data using (by(i, m, enough(column("work_seconds")))): \
       (not_below(edge, unresolved(column("value")))) \
       with points pt (m eq "markov" ? 4 : 7) ps 0.5 lw 1 lc rgb pale_shade(i), \
     for [i=1:d] for [m in "billiard markov"] \
       data using (by(i, m, enough(column("work_seconds")))): \
       (not_below(edge, resolved(column("value")))) \
       with points pt (m eq "markov" ? 4 : 7) ps 0.7 lw 1.5 lc rgb shade(i), \
     for [i=1:d] data using (by(i, "spectrum", column("work_seconds"))): \
       (not_below(edge, unresolved(column("value")))) \
       with points pt 13 ps 0.9 lc rgb pale_shade(i), \
     for [i=1:d] data using (by(i, "spectrum", column("work_seconds"))): \
       (not_below(edge, resolved(column("value")))) with points pt 13 ps 0.9 lc rgb shade(i), \
     for [i=1:d] $$crossings using (at(i, column("x"))):"y" \
       with points pt 6 ps 1.6 lw 2 lc rgb shade(i), \
     for [i=1:d] $$deltas using (strcol("text") eq word(deltas, i) ? column("x") : NaN):"y": \
       ("δ = ".strcol("text")) with labels left font ",12" tc rgb shade(i)
)gnuplot";

constexpr char kRelaxationLegend[] = R"gnuplot(
# ---- the legend of d ----
unset label
set lmargin screen 0.51
set rmargin screen 0.99
set tmargin screen 0.236
set bmargin screen 0.004
set key at graph 0.02,0.99 left top Left reverse samplen 2.5 spacing 1.1 maxrows 3 font ",13"
set label "d: δ by colour. Left of ○ the limit (jump process, spectrum)" at screen 0.029,0.0458 font ",13"
set label "costs less; below its line, the bias, it may not be used." at screen 0.029,0.0281 font ",13"
$TABLEplot NaN with linespoints pt 7 ps 0.8 lw 1.5 lc rgb "#444444" title "billiard, in lanes", \
     NaN with linespoints pt 4 ps 0.8 lw 1.5 lc rgb "#999999" title "jump process", \
     NaN with points pt 13 ps 1 lc rgb "#444444" title "spectrum", \
     NaN with lines lw 1.5 dt (8,5) lc rgb "#444444" title "bias of the limit", \
     NaN with lines lw 1.7 dt (2,4) lc rgb "#444444" title "bias ≤ error + 2σ", \
     NaN with points pt 6 ps 1.6 lw 2 lc rgb "#444444" title "billiard as exact"
)gnuplot";

std::string DeltasOf(const std::vector<LimitFloor>& floors) {
  return absl::StrJoin(floors, " ", [](std::string* out, const LimitFloor& floor) {
    absl::StrAppend(out, ExactText(floor.delta));
  });
}

std::string ShadesOf(const std::vector<LimitFloor>& floors) {
  std::vector<std::string> shades;
  for (size_t i = 0; i < floors.size(); ++i) shades.push_back(ColourOf(i, floors.size()));
  return absl::StrJoin(shades, " ");
}

// 4.2 ± 0.2 %, or ≤ 1.2 %
std::string BiasText(const LimitFloor& floor) {
  if (!floor.IsResolved()) return absl::StrFormat("≤ %.2g %%", 100 * floor.Height());
  const MeasuredText text = Measured(100 * floor.bias, 100 * floor.error);
  return absl::StrCat(text.value, " ± ", text.error, " %");
}

std::string CrossingText(const LimitFloor& floor) {
  if (!floor.crossing_work) return "–";
  return absl::StrCat(floor.IsResolved() ? "" : "≥ ", DurationText(*floor.crossing_work));
}

// A row of gnuplot labels, at columns that leave room for what is longest.
std::string TableRow(double y, const char* colour, const std::vector<std::string>& cells) {
  constexpr double kColumns[] = {0.04, 0.2, 0.46};
  std::string row;
  for (size_t i = 0; i < cells.size(); ++i) {
    absl::StrAppendFormat(&row, "set label \"%s\" at graph %.2f,%.3f font \",13\" tc rgb \"%s\"\n",
                          cells[i], kColumns[i], y, colour);
  }
  return row;
}

std::string Table(const std::vector<LimitFloor>& floors) {
  constexpr double kTop = 0.64, kLine = 0.076;
  std::string table =
      TableRow(kTop, "#000000", {"δ", "bias of the limit", "billiard as exact after"});
  for (size_t i = 0; i < floors.size(); ++i) {
    const double y = kTop - kLine * static_cast<double>(i + 1);
    table += TableRow(y, ColourOf(i, floors.size()).c_str(),
                      {ExactText(floors[i].delta), BiasText(floors[i]), CrossingText(floors[i])});
  }
  return table;
}

using Substitutions = std::vector<std::pair<absl::string_view, std::string>>;

}  // namespace

std::string RelaxationPanelScript(const Measurements& measurements) {
  const std::vector<LimitFloor> floors = FloorsOf(measurements);
  if (floors.empty()) return "";
  const auto [work, error] = ExtentOf(measurements, floors);
  const Range shown = {error.low * kBelow, error.high * kAbove};
  return absl::StrReplaceAll(
      kPanel,
      Substitutions{{"$$", "$"},
                    {"$CHANCE_LINES", ChanceLines(measurements, floors)},
                    {"$WALKERS", ChanceOfWalkers(measurements, floors.front())},
                    {"$FLOOR_LINES", FloorLines(floors, work.high * kFloorEnd)},
                    {"$CROSSINGS", Crossings(floors)},
                    {"$DELTA_LABELS", DeltaLabels(floors, work.high * kDeltaLabelAt, shown)},
                    {"$FEWEST", absl::StrCat(kFewestOrbits)},
                    {"$DELTAS", DeltasOf(floors)},
                    {"$SHADES", ShadesOf(floors)},
                    {"$EDGE", ExactText(shown.low)},
                    {"$TOP", ExactText(shown.high)},
                    {"$FROM", ExactText(work.low * kBelow)},
                    {"$TO", ExactText(work.high * kRoomForDeltas)}});
}

std::string RelaxationLegendScript(const Measurements& measurements) {
  const std::vector<LimitFloor> floors = FloorsOf(measurements);
  if (floors.empty()) return "";
  return absl::StrReplaceAll(kRelaxationLegend, Substitutions{{"$TABLE", Table(floors)}});
}

}  // namespace ballpiston::client

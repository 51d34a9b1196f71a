#include "client/figure/speed_accuracy_script.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/string_view.h"
#include "client/figure/plot_marks.h"
#include "client/figure/relaxation_panel.h"
#include "client/output/number_text.h"

namespace ballpiston::client {
namespace {

using Measurements = std::vector<MethodMeasurement>;

constexpr double kHeadroom = 1.15;    // on a linear axis
constexpr double kRoomForSteps = 60;  // right of the longest run: the time steps stand there
constexpr double kBiasLineEnd = 1.6;  // right of the longest run
constexpr double kLabelAt = 1.9;      // likewise

// How a method is drawn. Colours by Okabe and Ito, told apart by all kinds of colour vision; shapes
// differ too: filled for double, open for single precision.
struct Style {
  const char* title;
  const char* colour;
  int marker;  // gnuplot's point type
};

Style StyleOf(absl::string_view method) {
  static const std::pair<absl::string_view, Style> kStyles[] = {
      {"fixed-step", {"fixed time step Δt", "#d55e00", 2}},
      {"billiard-reference-single", {"reference, single", "#e69f00", 8}},
      {"billiard-reference", {"reference, double", "#009e73", 9}},
      {"billiard-reference-long-double", {"reference, 64 bits", "#cc79a7", 11}},
      {"billiard-reference-quadruple", {"reference, 113 bits", "#777777", 13}},
      {kBilliard, {"vector lanes, double", "#0072b2", 7}},
      {"billiard-single", {"vector lanes, single", "#56b4e9", 6}},
      {kClosedForm, {"closed form", "#000000", 5}}};
  for (const auto& [name, style] : kStyles) {
    if (name == method) return style;
  }
  return {"another method", "#b0b0b0", 1};  // of a newer program
}

// One method at one time step.
struct Curve {
  std::string method;
  double time_step = 0;

  bool Holds(const MethodMeasurement& m) const {
    return m.method == method && m.time_step == time_step;
  }
};

// Those of panels a to c, in the order of their first measurements.
std::vector<Curve> CurvesOf(const Measurements& measurements) {
  std::vector<Curve> curves;
  for (const MethodMeasurement& m : measurements) {
    if (m.quantity == kRelaxationTime) continue;
    const bool known = std::any_of(curves.begin(), curves.end(),
                                   [&m](const Curve& curve) { return curve.Holds(m); });
    if (!known) curves.push_back({m.method, m.time_step});
  }
  return curves;
}

Measurements Of(const Measurements& measurements, absl::string_view quantity) {
  Measurements some;
  std::copy_if(measurements.begin(), measurements.end(), std::back_inserter(some),
               [quantity](const auto& m) { return m.quantity == quantity; });
  return some;
}

Measurements Of(const Measurements& measurements, const Curve& curve) {
  Measurements some;
  std::copy_if(measurements.begin(), measurements.end(), std::back_inserter(some),
               [&curve](const auto& m) { return curve.Holds(m); });
  return some;
}

// Those that are drawn.
Measurements Runs(const Measurements& measurements) {
  Measurements some;
  std::copy_if(measurements.begin(), measurements.end(), std::back_inserter(some),
               [](const auto& m) { return m.samples >= kFewestDrawn; });
  return some;
}

// What chance makes smaller than the smallest statistical error is drawn at the lower edge: a
// chance zero, or the closed form, is no reason for an axis of ten decades.
Range ErrorRange(const Measurements& runs) {
  Range range;
  for (const MethodMeasurement& m : runs) range.Take(m.statistical_error);
  for (const MethodMeasurement& m : runs) range.high = std::max(range.high, std::abs(m.value));
  return range;
}

Range WorkRange(const Measurements& measurements) {
  Range range;
  for (const MethodMeasurement& m : measurements) range.Take(m.work);
  return range;
}

// ---- data that the script brings along ----

// 10^{-2}, 6×10^{-15}: what gnuplot's enhanced text makes of it is one number.
std::string PowerText(double x) {
  const std::string text = absl::StrFormat("%.0e", x);
  const size_t e = text.find('e');
  const std::string digit = text.substr(0, e);
  return absl::StrFormat("%s10^{%d}", digit == "1" ? "" : absl::StrCat(digit, "×"),
                         std::stoi(text.substr(e + 1)));
}

// Where chance is smaller than the longest run's bias, from the first such run on: two points.
std::string BiasLine(const Measurements& runs, size_t index) {
  if (runs.empty() || !IsBiasResolved(runs.back())) return "";
  const double bias = runs.back().value;
  const auto first = std::find_if(runs.begin(), runs.end(),
                                  [bias](const auto& m) { return m.statistical_error < bias; });
  const std::string y = ExactText(bias);
  return absl::StrFormat("%d,%s,%s\n%d,%s,%s\n\n", index, ExactText(first->work), y, index,
                         ExactText(runs.back().work * kBiasLineEnd), y);
}

std::string BiasLines(const Measurements& runs, const std::vector<Curve>& curves) {
  std::string lines = "curve,x,y\n";
  for (size_t i = 0; i < curves.size(); ++i) {
    absl::StrAppend(&lines, BiasLine(Of(runs, curves[i]), i + 1));
  }
  return lines;
}

// The time steps, written at the ends of their curves.
std::string StepLabels(const Measurements& runs, const std::vector<Curve>& curves, Range error) {
  std::vector<Label> labels;
  for (const Curve& curve : curves) {
    const Measurements of_curve = Of(runs, curve);
    if (curve.time_step == 0 || of_curve.empty()) continue;
    const MethodMeasurement& last = of_curve.back();
    const double y = IsBiasResolved(last) ? last.value : last.statistical_error;
    labels.push_back({last.work * kLabelAt, y, "Δt = " + PowerText(curve.time_step)});
  }
  Spread(labels, error);
  return Text(labels);
}

// What is computed without samples, and how exactly.
std::string ExactLabels(const Measurements& panel, double edge) {
  std::vector<Label> labels;
  for (const MethodMeasurement& m : panel) {
    if (m.samples == 0) labels.push_back({m.work, edge, "≤ " + PowerText(m.value)});
  }
  return Text(labels);
}

// ---- the script ----

constexpr char kHead[] = R"gnuplot(# Run again with: gnuplot speed-accuracy.gnuplot
# rho = $RHO, delta = $DELTA, epsilon = $EPSILON, seed = $SEED, $SECONDS s a curve
data = "speed-accuracy.csv"
set encoding utf8
set terminal svg size 960,1040 enhanced font "Helvetica,Arial,sans-serif,15" background rgb "white"
set output "speed-accuracy.svg"
set datafile separator comma
set datafile columnheaders

# The curves: a method each, the naive one at several time steps.
methods = "$METHODS"
array step = [$STEPS]
colours = "$COLOURS"
array marker = [$MARKERS]
n = words(methods)
colour(i) = word(colours, i)
is_curve(i) = strcol("method") eq word(methods, i) && column("time_step") == step[i]
of(i, y) = is_curve(i) && strcol("quantity") eq quantity ? y : NaN
pale(i) = "#70".word(colours, i)[2:]
shown(y) = column("samples") >= $FEWEST ? y : NaN
exact(y) = column("samples") == 0 ? y : NaN
resolved(y) = column("bias_resolved") == 1 ? y : NaN
unresolved(y) = column("bias_resolved") == 0 ? y : NaN
not_below(edge, y) = y < edge ? edge : y

set multiplot
set border lw 1.2
set grid xtics ytics lc rgb "#e6e6e6" lw 1 lt 1
set tics nomirror
unset key
)gnuplot";

// Errors against work, both logarithmic.
constexpr char kErrorPanel[] = R"gnuplot(
# ---- $NAME ----
$$bias << EOD
$BIAS_LINESEOD
$$steps << EOD
$STEP_LABELSEOD
$$exact << EOD
$EXACT_LABELSEOD
quantity = "$QUANTITY"
edge = $EDGE
set logscale xy
set xrange [$FROM:$TO]
set yrange [edge:$TOP]
set format "10^{%T}"
set xtics 10
set ytics 10
set mxtics 10
set mytics 10
set lmargin screen $LEFT
set rmargin screen $RIGHT
set tmargin screen 0.954
set bmargin screen 0.681
set title "{/:Bold $NAME}  $TITLE" offset 0,-0.4
set xlabel "work / s" offset 0,0.4
set ylabel "$Y" offset 0.5,0
plot for [i=1:n] data using (of(i, shown(column("work_seconds")))):"statistical_error" \
       with lines lw 1.5 lc rgb colour(i), \
     for [i=1:n] $$bias using (column("curve") == i ? column("x") : NaN):"y" \
       with lines lw 1.5 dt (8,5) lc rgb colour(i), \
     for [i=1:n] data using (of(i, shown(column("work_seconds")))): \
       (not_below(edge, unresolved(abs(column("value"))))) \
       with points pt marker[i] ps 0.6 lw 1 lc rgb pale(i), \
     for [i=1:n] data using (of(i, shown(column("work_seconds")))): \
       (not_below(edge, resolved(column("value")))) \
       with points pt marker[i] ps 0.8 lw 1.7 lc rgb colour(i), \
     for [i=1:n] data using (of(i, exact(column("work_seconds")))): \
       (not_below(edge, column("value"))) with points pt marker[i] ps 0.9 lc rgb colour(i), \
     $$steps using "x":"y":"text" with labels left font ",12" tc rgb "#d55e00", \
     $$exact using "x":"y":"text" with labels left offset 0.4,0.8 font ",12"
)gnuplot";

constexpr char kTrajectoryPanel[] = R"gnuplot(
# ---- c ----
# The longest runs alone: the cost of a hit and the horizon do not depend on the number of orbits.
$$orbits << EOD
$ORBITSEOD
$$steps << EOD
$STEP_LABELSEOD
unset logscale
set logscale x
set xrange [$FROM:$TO]
set yrange [0:$TOP]
set format y "%g"
set ytics autofreq
set mytics 2
set lmargin screen 0.085
set rmargin screen 0.485
set tmargin screen 0.569
set bmargin screen 0.296
set title "{/:Bold c}  single orbits" offset 0,-0.4
set xlabel "time of a hit / ns" offset 0,0.4
set ylabel "hits until parted from a precise twin" offset 0.5,0
of_curve(i, y) = column("curve") == i ? y : NaN
# Error bars are drawn as vectors: gnuplot leaves white rings between its own and their points.
plot for [i=1:n] $$orbits using (of_curve(i, column("x"))):(column("y") - column("error")): \
       (0):(2*column("error")) with vectors nohead lw 1 lc rgb colour(i), \
     for [i=1:n] $$orbits using (of_curve(i, column("x"))):"y" \
       with points pt marker[i] ps 1 lw 1.5 lc rgb colour(i), \
     $$steps using "x":"y":"text" with labels right offset 0.6,0.9 font ",12" tc rgb "#d55e00"
)gnuplot";

constexpr char kLegend[] = R"gnuplot(
# ---- the legend ----
unset logscale
unset border
unset tics
unset grid
unset xlabel
unset ylabel
unset title
set xrange [0:1]
set yrange [0:1]
set lmargin screen 0.01
set rmargin screen 0.49
set tmargin screen 0.236
set bmargin screen 0.004
set key at graph 0.02,0.99 left top Left reverse samplen 2.5 spacing 1.1 maxrows 4 font ",13"
set label "a, b: ρ = $RHO, δ = $DELTA, ε = $EPSILON; c, d: the same ρ." at graph 0.04,0.560 font ",13"
set label "Line: statistical error σ." at graph 0.04,0.484 font ",13"
set label "Point: measured error, pale if below 3σ." at graph 0.04,0.408 font ",13"
set label "Dashed: bias, if the longest run's error is above 3σ." at graph 0.04,0.332 font ",13"
set label "At the lower edge: smaller than shown." at graph 0.04,0.256 font ",13"
plot $LEGEND
)gnuplot";

using Substitutions = std::vector<std::pair<absl::string_view, std::string>>;

template <typename Text>
std::string List(const std::vector<Curve>& curves, const char* separator, Text text) {
  return absl::StrJoin(curves, separator, [&](std::string* out, const Curve& curve) {
    absl::StrAppend(out, text(curve));
  });
}

std::string Head(const SpeedAccuracyQuestion& question, const std::vector<Curve>& curves) {
  const auto method = [](const Curve& curve) { return curve.method; };
  const auto step = [](const Curve& curve) { return ExactText(curve.time_step); };
  const auto colour = [](const Curve& curve) { return StyleOf(curve.method).colour; };
  const auto marker = [](const Curve& curve) { return StyleOf(curve.method).marker; };
  return absl::StrReplaceAll(kHead,
                             Substitutions{{"$RHO", ExactText(question.rho)},
                                           {"$DELTA", ExactText(question.delta)},
                                           {"$EPSILON", ExactText(question.epsilon)},
                                           {"$SEED", absl::StrCat(question.seed)},
                                           {"$SECONDS", ExactText(question.seconds_per_curve)},
                                           {"$FEWEST", absl::StrCat(kFewestDrawn)},
                                           {"$METHODS", List(curves, " ", method)},
                                           {"$STEPS", List(curves, ", ", step)},
                                           {"$COLOURS", List(curves, " ", colour)},
                                           {"$MARKERS", List(curves, ", ", marker)}});
}

struct ErrorPanel {
  const char* name;
  const char* quantity;
  const char* title;
  const char* y;
  const char* left;  // of the picture's width
  const char* right;
};

constexpr ErrorPanel kErrorPanels[] = {
    {"a", kMeanFreeTime, "mean free time", "relative error", "0.085", "0.485"},
    {"b", kIngoingLaw, "law of the ingoing angle", "Kullback-Leibler divergence", "0.585",
     "0.985"}};

std::string ErrorPanelScript(const ErrorPanel& panel, const Measurements& measurements,
                             const std::vector<Curve>& curves) {
  const Measurements all = Of(measurements, panel.quantity);
  const Measurements runs = Runs(all);
  const Range work = WorkRange(all);
  const Range error = ErrorRange(runs);
  const double edge = error.low * kBelow;
  return absl::StrReplaceAll(kErrorPanel,
                             Substitutions{{"$$", "$"},
                                           {"$NAME", panel.name},
                                           {"$BIAS_LINES", BiasLines(runs, curves)},
                                           {"$STEP_LABELS", StepLabels(runs, curves, error)},
                                           {"$EXACT_LABELS", ExactLabels(all, edge)},
                                           {"$QUANTITY", panel.quantity},
                                           {"$EDGE", ExactText(edge)},
                                           {"$TOP", ExactText(error.high * kAbove)},
                                           {"$FROM", ExactText(work.low * kBelow)},
                                           {"$TO", ExactText(work.high * kRoomForSteps)},
                                           {"$LEFT", panel.left},
                                           {"$RIGHT", panel.right},
                                           {"$TITLE", panel.title},
                                           {"$Y", panel.y}});
}

double NanosecondsPerHit(const MethodMeasurement& m) {
  return 1e9 * m.work / static_cast<double>(m.wall_hits);
}

// Of each curve the longest run.
std::string TrajectoryPanelScript(const Measurements& measurements,
                                  const std::vector<Curve>& curves) {
  const Measurements panel = Of(measurements, kTrajectory);
  Range cost, hits;
  std::vector<Label> labels;
  std::string orbits = "curve,x,y,error\n";
  for (size_t i = 0; i < curves.size(); ++i) {
    const Measurements runs = Of(panel, curves[i]);
    if (runs.empty()) continue;
    const double x = NanosecondsPerHit(runs.back()), y = runs.back().value;
    cost.Take(x);
    hits.Take(y);
    absl::StrAppend(&orbits, i + 1, ",", ExactText(x), ",", ExactText(y), ",",
                    ExactText(runs.back().statistical_error), "\n");
    if (curves[i].time_step == 0) continue;
    labels.push_back({x, y, (labels.empty() ? "Δt = " : "") + PowerText(curves[i].time_step)});
  }
  return absl::StrReplaceAll(kTrajectoryPanel,
                             Substitutions{{"$$", "$"},
                                           {"$ORBITS", orbits},
                                           {"$STEP_LABELS", Text(labels)},
                                           {"$FROM", ExactText(cost.low * kBelow)},
                                           {"$TO", ExactText(cost.high / kBelow)},
                                           {"$TOP", ExactText(hits.high * kHeadroom)}});
}

std::string Legend(const SpeedAccuracyQuestion& question, const std::vector<Curve>& curves) {
  std::vector<std::string> entries;
  std::vector<std::string> seen;
  for (const Curve& curve : curves) {
    if (std::find(seen.begin(), seen.end(), curve.method) != seen.end()) continue;
    seen.push_back(curve.method);
    const Style style = StyleOf(curve.method);
    const char* with = curve.method == kClosedForm ? "points" : "linespoints";
    entries.push_back(absl::StrFormat("NaN with %s pt %d ps 1 lw 1.5 lc rgb \"%s\" title \"%s\"",
                                      with, style.marker, style.colour, style.title));
  }
  return absl::StrReplaceAll(kLegend,
                             Substitutions{{"$RHO", absl::StrFormat("%.6g", question.rho)},
                                           {"$DELTA", ExactText(question.delta)},
                                           {"$EPSILON", ExactText(question.epsilon)},
                                           {"$LEGEND", absl::StrJoin(entries, ", \\\n     ")}});
}

}  // namespace

std::string SpeedAccuracyScript(const SpeedAccuracyQuestion& question,
                                const Measurements& measurements) {
  const std::vector<Curve> curves = CurvesOf(measurements);
  std::string script = Head(question, curves);
  for (const ErrorPanel& panel : kErrorPanels) {
    script += ErrorPanelScript(panel, measurements, curves);
  }
  return absl::StrCat(script, TrajectoryPanelScript(measurements, curves),
                      RelaxationPanelScript(measurements), Legend(question, curves),
                      RelaxationLegendScript(measurements), "unset multiplot\n");
}

}  // namespace ballpiston::client

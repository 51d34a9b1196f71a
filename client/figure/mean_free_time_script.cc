#include "client/figure/mean_free_time_script.h"

#include <algorithm>

#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/output/number_text.h"

namespace ballpiston::client {
namespace {

constexpr double kMargin = 0.7;  // of the inset's axis, beside the smallest and the largest delta

constexpr char kScript[] = R"gnuplot(# Run again with: gnuplot mean-free-time.gnuplot
deltas = "%s"
colours = "#3b4cc0 #1b9e77 #d95f02 #b40426 #7570b3 #66a61e #e6ab02 #a6761d"

set encoding utf8
set terminal svg size 960,640 enhanced font "Helvetica,Arial,sans-serif,18" background rgb "white"
set output "mean-free-time.svg"
set datafile separator ","
set datafile columnheaders

n = words(deltas)
delta(i) = word(deltas, i) + 0.0
colour(i) = word(colours, (i - 1) %% words(colours) + 1)
of_curve(name) = strcol("curve") eq name ? column("x") : NaN
of_delta(i, x) = column("delta") == delta(i) ? column(x) : NaN
# Error bars are drawn as vectors: gnuplot leaves white rings between its own and their points.
low(x) = column(x) - column(x."_error")

set multiplot
set border lw 1.2

# Measured conditional rates, scaled; the exact curve on top of them.
set xrange [0:0.5]
set yrange [*<0.86:1.46<*]
set xtics 0.1
set mxtics 2
set ytics 0.1
set mytics 2
set grid xtics ytics lc rgb "#e6e6e6" lw 1 lt 1
set xlabel "piston energy ε"
set ylabel "τ_{bp}/τ(ε)"
set key bottom right Left reverse samplen 1.2 spacing 1.2 width 1
set lmargin screen 0.105
set rmargin screen 0.975
set tmargin screen 0.965
set bmargin screen 0.135
plot for [i=1:n] "mean-free-time.csv" \
       using (of_delta(i, "epsilon")):(low("scaled_rate")):(0):(2*column("scaled_rate_error")) \
       with vectors nohead lw 1 lc rgb colour(i) notitle, \
     for [i=1:n] "mean-free-time.csv" using (of_delta(i, "epsilon")):"scaled_rate" \
       with points pt 7 ps 0.5 lc rgb colour(i) notitle, \
     "mean-free-time-exact.csv" using (of_curve("phi")):"y" \
       with lines lw 2 lc rgb "black" title "exact φ_{bp}(ε)", \
     for [i=1:n] NaN with points pt 7 ps 0.8 lc rgb colour(i) \
       title "δ = ".word(deltas, i)

# The inset: the mean collision rate itself, against delta.
set object 1 rectangle from graph -0.31,-0.31 to graph 1.03,1.05 behind \
  fillcolor rgb "white" fillstyle solid noborder
unset grid
unset key
set lmargin screen 0.25
set rmargin screen 0.575
set tmargin screen 0.93
set bmargin screen 0.555
set logscale xy
set format y "10^{%%T}"
set xrange [%s:%s]
set yrange [*:*] noextend
set mxtics 10
set mytics 10
set ytics 10 font ",15"
set xtics (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3) font ",15"
set xlabel "δ" font ",17" offset 0,0.5
set ylabel "1/τ_{bp}" font ",17" offset 0.5,0
plot "mean-free-time-exact.csv" using (of_curve("rate")):"y" with lines lw 2 lc rgb "black", \
     for [i=1:n] "mean-free-time-inset.csv" \
       using (of_delta(i, "delta")):(low("rate")):(0):(2*column("rate_error")) \
       with vectors nohead lw 1 lc rgb colour(i), \
     for [i=1:n] "mean-free-time-inset.csv" using (of_delta(i, "delta")):"rate" \
       with points pt 7 ps 1 lc rgb colour(i)
unset multiplot
)gnuplot";

}  // namespace

std::string MeanFreeTimeScript(const std::vector<double>& delta) {
  const auto number = [](std::string* out, double x) { out->append(ExactText(x)); };
  const auto [smallest, largest] = std::minmax_element(delta.begin(), delta.end());
  return absl::StrFormat(kScript, absl::StrJoin(delta, " ", number), ExactText(kMargin * *smallest),
                         ExactText(*largest / kMargin));
}

}  // namespace ballpiston::client

# Draws relaxation.svg. Change it as you like; run it with: gnuplot relaxation.gnuplot
#
# Time is in units of the mean free time between ball-piston collisions. Points are means over
# orbits of the billiard, with one standard error. Lines are the limit delta -> 0, from the spectrum
# of the jump process.
#   a  mean energy of the piston from several start energies; it tends to 1/6
#   b  autocorrelation of the piston's energy in equilibrium
#   c  the difference of a from the limit, for the lowest and the highest start energy
#   d  the difference of b from the limit
# Error bars are drawn as vectors: the error bars of gnuplot leave white rings around the points.
# relaxation.sh lists the commands that write the data.

# ---- Settings ----
load "style.gnuplot"
energies = "relaxation-energy.csv"
correlations = "relaxation-autocorrelation.csv"
times = "relaxation-times.csv"
set terminal svg size 1080,840 enhanced font font background rgb "white"
set output "relaxation.svg"
least = 1e-5        # b: the axis begins here
from_highest = 0.1  # c: shift of the points of the highest start energy to the right

# ---- The data ----
deltas = ""
taus = ""
note(_) = (deltas = deltas." ".strcol("delta"), \
           taus = taus.sprintf(" %.17e", column("tau_ball_piston")), 1)
stats times using (note(0)) nooutput
n = words(deltas)

starts = ""
note_start(e) = (starts = strstrt(starts." ", " ".e." ") ? starts : starts." ".e, real(e))
stats energies using (note_start(strcol("epsilon"))) nooutput
lowest = STATS_min
highest = STATS_max
stats energies using (column("time")*(1.0/word(taus, 1))*(strcol("delta") eq word(deltas, 1))) \
  nooutput
longest = STATS_max

of_delta(i) = strcol("delta") eq word(deltas, i)
t(i) = of_delta(i) ? column("time")/word(taus, i) : NaN
t_from(i, start) = column("epsilon") == start ? t(i) : NaN
t_from_highest(i) = highest > lowest ? t_from(i, highest) + from_highest : NaN
error(_) = strcol("standard_error") eq "" ? 0 : column("standard_error")
low(_) = column("value") - error(0)
high(_) = column("value") + error(0)
positive(x) = x > least ? x : least
excess(_) = column("value") - column("limit")

set multiplot
set xrange [0:1.01*longest]
set mxtics 2
set mytics 2

# ---- The energies from each start ----
set lmargin screen 0.09
set rmargin screen 0.485
set tmargin screen 0.945
set bmargin screen 0.44
set title "{/:Bold a}  mean energy of the piston" offset 0,-0.4
set ylabel "mean energy" offset 1,0
set format x ""
set yrange [0:0.5]
set ytics 0.1
set key top right Left reverse samplen 1.2 spacing 1.15 width 1
set arrow 1 from graph 0, first 1/6.0 to graph 1, first 1/6.0 nohead back dt 2 lw 1.2 lc rgb grey
plot for [k=1:words(starts)] energies using (t_from(1, real(word(starts, k)))):"limit" \
       smooth mcsplines with lines lw 1.8 lc rgb black title k == 1 ? "limit δ → 0" : "", \
     for [i=1:n] energies using (t(i)):(low(0)):(0):(2*error(0)) \
       with vectors nohead lw 1 lc rgb colour(i) notitle, \
     for [i=1:n] energies using (t(i)):"value" with points pt 7 ps 0.5 lc rgb colour(i) notitle, \
     for [i=1:n] NaN with points pt 7 ps 0.8 lc rgb colour(i) title "δ = ".word(deltas, i)
unset arrow 1

# ---- Their difference from the limit ----
set tmargin screen 0.38
set bmargin screen 0.11
set title "{/:Bold c}  minus the limit: from ".sprintf("%g", lowest). \
  (highest > lowest ? sprintf(" (●), %g (△)", highest) : "") offset 0,-0.4
set xlabel "t/τ_{bp}"
set ylabel "difference" offset 1,0
set format x "%g"
set yrange [*:*]
set ytics auto
unset key
plot 0 with lines lw 1.8 lc rgb black, \
     for [i=1:n] energies using (t_from(i, lowest)):(excess(0) - error(0)):(0):(2*error(0)) \
       with vectors nohead lw 1 lc rgb colour(i), \
     for [i=1:n] energies using (t_from(i, lowest)):(excess(0)) \
       with points pt 7 ps 0.5 lc rgb colour(i), \
     for [i=1:n] energies \
       using (t_from_highest(i)):(excess(0) - error(0)):(0):(2*error(0)) \
       with vectors nohead lw 1 lc rgb colour(i), \
     for [i=1:n] energies using (t_from_highest(i)):(excess(0)) \
       with points pt 8 ps 0.7 lw 1.2 lc rgb colour(i)

# ---- The autocorrelation ----
set lmargin screen 0.595
set rmargin screen 0.985
set tmargin screen 0.945
set bmargin screen 0.44
set title "{/:Bold b}  autocorrelation of the energy" offset 0,-0.4
unset xlabel
set ylabel "autocorrelation" offset 1,0
set format x ""
set format y "10^{%T}"
set logscale y
set yrange [least:1.5]
plot correlations using (t(1)):"limit" with lines lw 1.8 lc rgb black, \
     for [i=1:n] correlations \
       using (t(i)):(positive(low(0))):(0):(high(0) > least ? high(0) - positive(low(0)) : NaN) \
       with vectors nohead lw 1 lc rgb colour(i), \
     for [i=1:n] correlations using (t(i)):(column("value") > 0 ? column("value") : NaN) \
       with points pt 7 ps 0.6 lc rgb colour(i)

# ---- Its difference from the limit ----
set tmargin screen 0.38
set bmargin screen 0.11
set title "{/:Bold d}  minus the limit" offset 0,-0.4
set xlabel "t/τ_{bp}"
set ylabel "difference" offset 1,0
set format x "%g"
set format y "%g"
unset logscale y
set yrange [*:*]
plot 0 with lines lw 1.8 lc rgb black, \
     for [i=1:n] correlations using (t(i)):(excess(0) - error(0)):(0):(2*error(0)) \
       with vectors nohead lw 1 lc rgb colour(i), \
     for [i=1:n] correlations using (t(i)):(excess(0)) with points pt 7 ps 0.6 lc rgb colour(i)
unset multiplot

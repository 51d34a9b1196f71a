# Draws rates.svg. Change it as you like; run it with: gnuplot rates.gnuplot
#
# The probability P(t) of at least one event in a window of length t, divided by t and by the exact
# rate, with one standard error, against t in units of the mean free time. As t tends to 0 the ratio
# tends to 1. The dashed line is a Poisson process with the same rate.
#   a  all events: ball-piston, ball-wall and piston-wall
#   b  ball-piston events
#   c  ball-piston events given the piston's energy
# All values of a line come from the same orbits. Therefore neighbouring points have nearly the same
# statistical error.
# Error bars are drawn as vectors: the error bars of gnuplot leave white rings around the points.
# rates.sh lists the commands that write the data.

# ---- Settings ----
load "style.gnuplot"
measured = "rates.csv"
set terminal svg size 1200,500 enhanced font font background rgb "white"
set output "rates.svg"
aside = 1.12  # c: the points of successive energies are shifted in time by this factor

# ---- The data ----
energies = ""
note(e) = (energies = e eq "" || strstrt(energies." ", " ".e." ") ? energies : energies." ".e, 1)
stats measured using (note(strcol("epsilon"))) nooutput
n = words(energies)

ratio(_) = column("rate")/column("exact")
error(_) = column("standard_error")/column("exact")
low(_) = ratio(0) - error(0)
x(_) = column("t")*column("exact")
of(kind) = strcol("kind") eq kind ? x(0) : NaN
of_energy(i) = strcol("epsilon") eq word(energies, i) ? x(0)*aside**(i - (n + 1)/2.0) : NaN
stats measured using (x(0)):(low(0)) nooutput
first = STATS_min_x
last = STATS_max_x
lowest = STATS_min_y
stats measured using (ratio(0) + error(0)) nooutput
highest = STATS_max
poisson(x) = (1 - exp(-x))/x

set multiplot
set logscale x
set xrange [0.6*first:1.7*last]
set yrange [lowest - 0.03:highest + 0.03]
set format x "10^{%T}"
set mxtics 10
set mytics 2
set tmargin screen 0.90
set bmargin screen 0.19
set xlabel "t/τ"
unset key
set arrow 1 from graph 0, first 1 to graph 1, first 1 nohead back lw 2 lc rgb black

set lmargin screen 0.085
set rmargin screen 0.37
set title "{/:Bold a}  all events" offset 0,-0.4
set ylabel "P(t)/t over the exact rate" offset 0.5,0
plot poisson(x) with lines lw 1.5 dt (6,4) lc rgb grey, \
     measured using (of("all")):(low(0)):(0):(2*error(0)) \
       with vectors nohead lw 1.2 lc rgb blue, \
     measured using (of("all")):(ratio(0)) with points pt 7 ps 0.7 lc rgb blue

set lmargin screen 0.392
set rmargin screen 0.677
set title "{/:Bold b}  ball-piston events"
set xlabel "t/τ_{bp}"
unset ylabel
set format y ""
plot poisson(x) with lines lw 1.5 dt (6,4) lc rgb grey, \
     measured using (of("ball_piston")):(low(0)):(0):(2*error(0)) \
       with vectors nohead lw 1.2 lc rgb blue, \
     measured using (of("ball_piston")):(ratio(0)) with points pt 7 ps 0.7 lc rgb blue

set lmargin screen 0.699
set rmargin screen 0.985
set title "{/:Bold c}  ball-piston events, given ε"
set xlabel "t/τ(ε)"
set key bottom left Left reverse samplen 1.2 spacing 1.1 width 1
plot poisson(x) with lines lw 1.5 dt (6,4) lc rgb grey title "Poisson process", \
     for [i=1:n] measured using (of_energy(i)):(low(0)):(0):(2*error(0)) \
       with vectors nohead lw 1.2 lc rgb colour(i) notitle, \
     for [i=1:n] measured using (of_energy(i)):(ratio(0)) \
       with points pt 7 ps 0.6 lc rgb colour(i) title "ε = ".word(energies, i)
unset multiplot

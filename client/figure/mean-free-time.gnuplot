# Draws mean-free-time.svg. Change it as you like; run it with: gnuplot mean-free-time.gnuplot
#
# Conditional collision rates, measured at several delta and scaled by the mean free time, collapse
# onto one curve, tau_bp/tau(epsilon) = phi(epsilon). Inset: the collision rate 1/tau_bp against
# delta.
# mean-free-time.sh lists the commands that write the data.

# ---- Settings ----
load "style.gnuplot"
set terminal svg size 960,640 enhanced font font background rgb "white"
set output "mean-free-time.svg"
measured = "mean-free-time.csv"     # conditional mean free times
inset = "mean-free-time-inset.csv"  # mean free times in equilibrium
phi = "mean-free-time-phi.csv"      # exact phi(epsilon)
rate = "mean-free-time-rate.csv"    # exact tau_bp(delta)
colours = "#3b4cc0 #1b9e77 #d95f02 #b40426 #7570b3 #66a61e #e6ab02 #a6761d"  # one for each delta
exact_colour = "black"
margin = 0.7  # of the inset's axis: the factor below the smallest and above the largest delta

# ---- The data ----

# The names of the rows of the data.
conditional = "mean_free_time_conditional"
unconditional = "mean_free_time_ball_piston"

# Every delta as it is written in the data, and its exact mean free time.
deltas = ""
taus = ""
note(_) = (deltas = deltas." ".strcol("delta"), \
           taus = taus.sprintf(" %.17e", column("exact")), column("delta"))
stats inset using (strcol("name") eq unconditional ? note(0) : NaN) nooutput
smallest = STATS_min
largest = STATS_max
n = words(deltas)

tau(i) = word(taus, i) + 0.0
colour(i) = word(colours, (i - 1) % words(colours) + 1)
of_delta(i, x) = strcol("delta") eq word(deltas, i) ? column(x) : NaN
of(name, i, x) = strcol("name") eq name ? of_delta(i, x) : NaN

# A measured time as a rate, in units of 1/scale, with one standard error.
rate_of(scale) = scale/column("value")
error_of(scale) = rate_of(scale)*column("standard_error")/column("value")
low(scale) = rate_of(scale) - error_of(scale)

set multiplot

# ---- The main panel: measured rates, and the exact curve on top of them ----
# Error bars are drawn as vectors: the error bars of gnuplot leave white rings around the points.
set xrange [0:0.5]
set yrange [*<0.86:1.46<*]
set xtics 0.1
set mxtics 2
set ytics 0.1
set mytics 2
set xlabel "piston energy ε"
set ylabel "τ_{bp}/τ(ε)"
set key bottom right Left reverse samplen 1.2 spacing 1.2 width 1
set lmargin screen 0.105
set rmargin screen 0.975
set tmargin screen 0.965
set bmargin screen 0.135
plot for [i=1:n] measured \
       using (of(conditional, i, "epsilon")):(low(tau(i))):(0):(2*error_of(tau(i))) \
       with vectors nohead lw 1 lc rgb colour(i) notitle, \
     for [i=1:n] measured using (of(conditional, i, "epsilon")):(rate_of(tau(i))) \
       with points pt 7 ps 0.5 lc rgb colour(i) notitle, \
     phi using (of_delta(1, "epsilon")):"phi" \
       with lines lw 2 lc rgb exact_colour title "exact φ_{bp}(ε)", \
     for [i=1:n] NaN with points pt 7 ps 0.8 lc rgb colour(i) title "δ = ".word(deltas, i)

# ---- The inset: the mean collision rate itself, against delta ----
set object 1 rectangle from graph -0.31,-0.31 to graph 1.03,1.05 behind \
  fillcolor rgb "white" fillstyle solid noborder
unset grid
unset key
set lmargin screen 0.25
set rmargin screen 0.575
set tmargin screen 0.93
set bmargin screen 0.555
set logscale xy
set format y "10^{%T}"
set xrange [margin*smallest:largest/margin]
set yrange [*:*] noextend
set mxtics 10
set mytics 10
set ytics 10 font ",15"
set xtics (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3) font ",15"
set xlabel "δ" font ",17" offset 0,0.5
set ylabel "1/τ_{bp}" font ",17" offset 0.5,0
plot rate using "delta":(1/column("tau_ball_piston")) with lines lw 2 lc rgb exact_colour, \
     for [i=1:n] inset using (of(unconditional, i, "delta")):(low(1)):(0):(2*error_of(1)) \
       with vectors nohead lw 1 lc rgb colour(i), \
     for [i=1:n] inset using (of(unconditional, i, "delta")):(rate_of(1)) \
       with points pt 7 ps 1 lc rgb colour(i)
unset multiplot

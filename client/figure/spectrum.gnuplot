# Draws spectrum.svg. Change it as you like; run it with: gnuplot spectrum.gnuplot
#
# Above: the relaxation rates of the jump process. Isolated rates (lines) accumulate at the bottom
# of a continuum, which consists of the values of the total rate f(epsilon) of jumps. Rates above
# the continuum are not drawn. Below: the autocorrelation of the piston's energy, measured in the
# billiard, and its limit for rare collisions, which finally decays at the smallest rate. The
# billiard's tail comes from slow pistons.
# spectrum.sh lists the commands that write the data.

# ---- Settings ----
load "style.gnuplot"
set terminal svg size 960,900 enhanced font font background rgb "white"
set output "spectrum.svg"
rates = "spectrum.csv"
total = "spectrum-rate.csv"
measured = "spectrum-billiard.csv"
continuum_colour = "#e3ecfb"
lowest = 5e-4      # the smallest correlation on the axis
labelled = 3       # number of isolated rates with a label; the next rates are too close

# ---- The data ----
# Every delta, and its mean free time.
deltas = ""
taus = ""
note_tau(d) = strstrt(deltas." ", " ".d." ") ? 1 : \
              (deltas = deltas." ".d, taus = taus." ".strcol("tau_ball_piston"), 1)
stats total using (note_tau(strcol("delta"))) nooutput
stats total using (column("f")) name "f" nooutput
bottom = f_min
top = f_max
n = words(deltas)
tau(i) = real(word(taus, i))
first_delta(x) = strcol("delta") eq word(deltas, 1) ? x : NaN
isolated = ""
is_rate(_) = strcol("name") eq "spectral_gap" || strcol("name")[1:13] eq "isolated_rate"
note_rate(_) = is_rate(0) ? (isolated = isolated." ".strcol("value"), 1) : 0
stats rates using (note_rate(0)) nooutput
rate(i) = real(word(isolated, i))
stats total using (column("tau_ball_piston")*column("area_ball_piston")/column("volume")) \
  name "unit" nooutput
per_tau = unit_mean     # a rate in units of |dG|/|G|, times this, is in units of 1/tau

set multiplot
unset key

# ---- The rates ----
set lmargin screen 0.095
set rmargin screen 0.975
set tmargin screen 0.905
set bmargin screen 0.6
set xrange [0:1.04*top]
set x2range [0:1.04*top*per_tau]
set yrange [0:0.5]
set xtics 0.05 nomirror
set x2tics 0.2
set ytics 0.1
set xlabel "rate / (|∂Γ_{bp}|/|Γ|)" offset 0,0.3
set x2label "rate × τ_{bp}" offset 0,-0.2
set ylabel "piston energy ε" offset 0.7,0
set object 1 rectangle from first bottom,graph 0 to first top,graph 1 behind \
  fillcolor rgb continuum_colour fillstyle solid noborder
set label 1 "continuum" at first (bottom + top)/2,graph 0.9 center
set label 2 "f(ε)" at first 0.97*top,0.4 right offset -1,0
set label 3 "isolated rates" at first rate(1),graph 0.9 right offset -2.5,0
set label 4 "equilibrium" at first 0,graph 0.5 center rotate by 90 offset 1.2,0
set label 5 "…" at first (rate(words(isolated)) + bottom)/2,graph 0.5 center tc rgb red
do for [i=1:words(isolated)] {
  set arrow from first rate(i),graph 0 to first rate(i),graph 1 nohead lw 2 lc rgb red front
  if (i <= labelled) {
    set label sprintf("%.4f", rate(i)) at first rate(i),graph 0.05 left rotate by 90 \
      offset -0.7,0 tc rgb red font ",14"
  }
}
set arrow from first 0,graph 0 to first 0,graph 1 nohead lw 4 lc rgb red front
plot total using (first_delta(column("f"))):"epsilon" with lines lw 2 lc rgb blue
unset object 1
unset arrow
unset label
unset x2tics
unset x2label

# ---- Autocorrelations ----
set tmargin screen 0.475
set bmargin screen 0.085
of(i, x) = strcol("delta") eq word(deltas, i) ? x : NaN
low(_) = column("value") - column("standard_error")
above(x) = x < lowest ? lowest : x
seen(x) = column("value") > lowest ? x : NaN
set logscale y
set format y "10^{%T}"
set xrange [0:*] noextend
set yrange [lowest:1.3]
set xtics autofreq mirror
set mxtics 2
set ytics 10
set mytics 10
set xlabel "t/τ_{bp}" offset 0,0.3
set ylabel "energy autocorrelation" offset 0.7,0
set key top right Left reverse samplen 1.5 spacing 1.2
plot measured using (of(1, column("time")/tau(1))):"limit" \
       with lines lw 2 lc rgb black title "limit δ → 0", \
     for [i=1:n] measured using (of(i, seen(column("time")/tau(i)))):(above(low(0))):(0): \
       (column("value") + column("standard_error") - above(low(0))) \
       with vectors nohead lw 1.2 lc rgb colour(i) notitle, \
     for [i=1:n] measured using (of(i, column("time")/tau(i))):(seen(column("value"))) \
       with points pt 7 ps 0.55 lc rgb colour(i) notitle, \
     for [i=1:n] NaN with points pt 7 ps 0.8 lc rgb colour(i) title "δ = ".word(deltas, i)
unset multiplot

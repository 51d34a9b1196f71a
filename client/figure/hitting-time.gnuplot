# Draws hitting-time.svg. Change it as you like; run it with: gnuplot hitting-time.gnuplot
#
# One column for each energy of the piston. Above: the probability that ball and piston have not
# collided up to the time t after a collision, for several delta, and the exponential law (black).
# Below: the difference from the exponential law, with one standard error, on an axis that is linear
# near 0 and logarithmic elsewhere. Time is in units of the conditional mean free time, so that the
# exponential law is exp(-t). All points of a line come from the same hits. Therefore neighbouring
# points have nearly the same statistical error.
# The lines have steps, because the piston reaches the cell once in its period (2 lambda + 4
# delta)/u. Error bars are drawn as vectors: the error bars of gnuplot leave white rings around the
# points.
# hitting-time.sh lists the commands that write the data.

# ---- Settings ----
load "style.gnuplot"
data = "hitting-time.csv"
small = "Helvetica,Arial,sans-serif,16"
least = 2e-4  # the upper axis ends here

# ---- The data ----
with(list, x) = strstrt(list." ", " ".x." ") ? list : list." ".x
deltas = ""
energies = ""
exponents = ""
note(_) = (deltas = with(deltas, strcol("delta")), energies = with(energies, strcol("epsilon")), \
           exponents = with(exponents, strcol("exponent")), hits = column("samples"), \
           -log(column("limit")))
hits = 0
stats data using (note(0)) nooutput
longest = STATS_max
n = words(deltas)
columns = words(energies)
exponent = word(exponents, 1)  # the picture shows only the first exponent

of(i, j) = strcol("name") eq "survival" && strcol("exponent") eq exponent && \
           strcol("delta") eq word(deltas, i) && strcol("epsilon") eq word(energies, j)
t(i, j) = of(i, j) ? -log(column("limit")) : NaN
excess(_) = column("value") - column("limit")
# If too few orbits have survived to measure the error, the error of the exponential law is drawn.
error(_) = strcol("standard_error") eq "" ? \
           sqrt(column("limit")*(1 - column("limit"))/column("samples")) : column("standard_error")
stats data using (excess(0) - error(0)) nooutput
lowest = STATS_min
stats data using (excess(0) + error(0)) nooutput
highest = STATS_max

# The lower axis is linear below the largest standard error that a probability can have.
noise = 0.5/sqrt(hits)
scaled(y) = asinh(y/noise/2)/log(10)
low(_) = scaled(excess(0) - error(0))
length(_) = scaled(excess(0) + error(0)) - low(0)
first_decade = floor(log10(8*noise) + 0.5)
last_decade = floor(log10(highest))

width = columns == 1 ? 640 : 106 + 330*columns
set terminal svg size width,760 enhanced font small background rgb "white"
set output "hitting-time.svg"
left(j) = (100.0 + (j - 1)*(width - 100.0 - 6.0)/columns)/width
right(j) = (100.0 + j*(width - 100.0 - 6.0)/columns - 12.0)/width

set multiplot
unset key
set xrange [0:1.01*longest]
set xtics 2
set mxtics 2
do for [j=1:columns] {
  set lmargin screen left(j)
  set rmargin screen right(j)

  # ---- The law ----
  set tmargin screen 0.88
  set bmargin screen 0.455
  set title "ε = ".word(energies, j) offset 0,-0.4
  unset xlabel
  set format x ""
  if (j == 1) {
    set ylabel "probability of no collision yet" offset 0.5,0
    set format y "10^{%T}"
  } else {
    unset ylabel
    set format y ""
  }
  set logscale y
  set yrange [least:1.3]
  set ytics auto
  set mytics 10
  plot for [i=1:n] data using (t(i, j)):(column("value") > 0 ? column("value") : NaN) \
         with lines lw 2 lc rgb colour(i), \
       exp(-x) with lines lw 1.2 dt (6,4) lc rgb black

  # ---- Its difference from the exponential law ----
  set tmargin screen 0.42
  set bmargin screen 0.1
  unset title
  set xlabel "t/τ_{bp}(ε)"
  if (j == 1) { set ylabel "minus the exponential" offset 0.5,0 }
  set format x "%g"
  unset logscale y
  set yrange [1.15*scaled(lowest):1.1*scaled(highest)]
  set mytics 1
  set ytics (j == 1 ? "0" : "" 0)
  do for [k=first_decade:last_decade] {
    set ytics add (j == 1 ? sprintf("10^{%d}", k) : "" scaled(10.0**k))
    if (-lowest > 10.0**k) {
      set ytics add (j == 1 ? sprintf("−10^{%d}", k) : "" scaled(-10.0**k))
    }
  }
  plot 0 with lines lw 1.2 dt (6,4) lc rgb black, \
       for [i=1:n] data using (t(i, j)):(low(0)):(0):(length(0)) \
         with vectors nohead lw 1 lc rgb colour(i), \
       for [i=1:n] data using (t(i, j)):(scaled(excess(0))) \
         with points pt 7 ps 0.35 lc rgb colour(i)
}

# ---- The legend ----
unset border
unset tics
unset grid
unset xlabel
unset ylabel
set lmargin screen 0
set rmargin screen 1
set tmargin screen 1
set bmargin screen 0.93
set xrange [0:1]
set yrange [0:1]
set key at graph 0.5,1 center top horizontal Left reverse maxrows (columns == 1 ? 2 : 1) \
  samplen 1.5 width 1
plot NaN with lines lw 1.2 dt (6,4) lc rgb black title "exponential", \
     for [i=1:n] NaN with lines lw 3 lc rgb colour(i) title "δ = ".word(deltas, i)
unset multiplot

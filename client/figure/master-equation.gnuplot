# Draws master-equation.svg. Change it as you like; run it with: gnuplot master-equation.gnuplot
#
# Densities of the piston's energy at several times after a start at one energy: from the billiard
# and the sampled jump process (points), and from the master equation (black steps). Below each
# panel: the ratio to the master equation, with one standard error. Two rows of panels for each
# start energy.
# The peak is the bin of the start energy: it contains the orbits without an exchange. Its share of
# all orbits, from the master equation, is above the panel.
# Error bars are drawn as vectors: the error bars of gnuplot leave white rings around the points.
# master-equation.sh lists the commands that write the data.

# ---- Settings ----
load "style.gnuplot"
data = "master-equation.csv"
small = "Helvetica,Arial,sans-serif,15"
across = 3
panel_width = 360
panel_height = 350
least_ratio = 0.5
largest_ratio = 1.5

# ---- The data ----
with(list, x) = strstrt(list." ", " ".x." ") ? list : list." ".x
series = ""  # MODEL,DELTA
starts = ""
times = ""
name(_) = strcol("model").",".strcol("delta")
note(_) = (series = with(series, name(0)), starts = with(starts, strcol("epsilon")), \
           times = with(times, strcol("time")), column("exact"))
stats data using (note(0)) nooutput
lowest = STATS_min
highest = STATS_max
n = words(series)
first_series = word(series, 1)
title_of(i) = word(series, i)[1:6] eq "markov" ? "jump process" : "δ = ".word(series, i)[10:*]
# The points of the series are side by side in their bin.
place(i) = column("lower") + (i - 0.5)/n*(column("upper") - column("lower"))
here(e, t) = strcol("epsilon") eq e && strcol("time") eq t
of(i, e, t) = name(0) eq word(series, i) && here(e, t) ? place(i) : NaN
exact(e, t) = name(0) eq first_series && here(e, t) ? column("exact") : NaN
share(e, t) = exact(e, t)*(column("upper") - column("lower"))* \
              (column("lower") <= real(e) && real(e) < column("upper"))
positive(x) = x > 0 ? x : NaN
inside(y) = y < least_ratio ? least_ratio : y > largest_ratio ? largest_ratio : y
low(_) = inside(column("ratio") - column("ratio_error"))
high(_) = inside(column("ratio") + column("ratio_error"))

rows_of_start = (words(times) + across - 1)/across
rows = words(starts)*rows_of_start
height = rows*panel_height + 80
width = across*panel_width + 90
set terminal svg size width,height enhanced font small background rgb "white"
set output "master-equation.svg"
left(k) = (84.0 + k*panel_width)/width
right(k) = (84.0 + (k + 1)*panel_width - 14)/width
from_top(y) = 1 - y/height

set multiplot
unset key
set xrange [0:0.5]
set mxtics 2
do for [s=1:words(starts)] {
  start = word(starts, s)
  do for [k=1:words(times)] {
    time = word(times, k)
    column_of = (k - 1) % across
    row = (s - 1)*rows_of_start + (k - 1)/across
    set lmargin screen left(column_of)
    set rmargin screen right(column_of)

    # ---- The law ----
    set yrange [*:*]
    unset logscale y
    stats data using (share(start, time)) nooutput
    set tmargin screen from_top(66.0 + row*panel_height)
    set bmargin screen from_top(66.0 + row*panel_height + 190.0)
    set title sprintf("t = %s τ_{bp}    (bin of ε = %s: %.3g %%)", time, start, 100*STATS_max) \
      offset 0,-0.6
    unset xlabel
    set xtics ("" 0, "" 0.1, "" 0.2, "" 0.3, "" 0.4, "" 0.5)
    set logscale y
    set yrange [0.6*lowest:1.6*highest]
    set ytics auto
    set mytics 10
    set format y column_of == 0 ? "10^{%T}" : ""
    if (column_of == 0) { set ylabel "density" offset 0.5,0 } else { unset ylabel }
    plot for [i=1:n] data using (of(i, start, time)):(positive(column("density"))) \
           with points pt 7 ps 0.3 lc rgb colour(i), \
         data using "lower":(exact(start, time)) with steps lw 1 lc rgb black

    # ---- The ratio to the master equation ----
    set tmargin screen from_top(66.0 + row*panel_height + 198.0)
    set bmargin screen from_top(66.0 + row*panel_height + 290.0)
    unset title
    if (row == rows - 1) { set xlabel "energy of the piston ε" }
    set xtics ("0" 0, "0.1" 0.1, "0.2" 0.2, "0.3" 0.3, "0.4" 0.4, "" 0.5)
    unset logscale y
    set yrange [least_ratio:largest_ratio]
    set ytics 0.75,0.25,1.25
    set mytics 1
    set format y column_of == 0 ? "%g" : ""
    if (column_of == 0) { set ylabel "ratio" offset 0.5,0 }
    plot for [i=1:n] data using (of(i, start, time)):(low(0)):(0):(high(0) - low(0)) \
           with vectors nohead lw 0.8 lc rgb colour(i), \
         for [i=1:n] data using (of(i, start, time)):"ratio" with points pt 7 ps 0.3 \
           lc rgb colour(i), \
         1 with lines lw 1 lc rgb black
  }
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
set bmargin screen from_top(40.0)
set xrange [0:1]
set yrange [0:1]
set key at graph 0.5,0.9 center top horizontal Left reverse maxrows 1 samplen 1 width 1
plot NaN with lines lw 1.4 lc rgb black title "master equation", \
     for [i=1:n] NaN with points pt 7 ps 0.9 lc rgb colour(i) title title_of(i)
unset multiplot

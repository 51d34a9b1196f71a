# Draws ingoing-law.svg. Change it as you like; run it with: gnuplot ingoing-law.gnuplot
#
# Densities of the ingoing angle alpha of first hits that start from the outgoing law h^(n), for
# both directions sigma of the piston, and the equilibrium law h^(1) (filled). One row for each
# energy of the piston, one column for each delta. The band of a line is one standard error. The
# density of sigma = +1 is zero if the piston is faster than the ball, epsilon >= 1/4.
# ingoing-law.sh lists the commands that write the data.

# ---- Settings ----
load "style.gnuplot"
data = "ingoing-law.csv"
row_height = 210   # of a row of panels, in pixels
small = "Helvetica,Arial,sans-serif,15"
fill_of = "#f3c3c3 #b9c3f2"  # colours of the exact laws of sigma = -1 and +1
line_of = red." ".blue

# ---- The data ----
deltas = ""
energies = ""
exponents = ""
with(list, x) = strstrt(list." ", " ".x." ") ? list : list." ".x
note(_) = (deltas = with(deltas, strcol("delta")), energies = with(energies, strcol("epsilon")), \
           exponents = with(exponents, strcol("exponent")), 1)
stats data using (note(0)) nooutput
columns = words(deltas)
rows = words(energies)
exponent = word(exponents, 1)  # the picture shows only the first exponent

width = columns < 3 ? 760 : 300*columns + 60
height = row_height*rows + 120
set terminal svg size width,height enhanced font small background rgb "white"
set output "ingoing-law.svg"

sigma(s) = s == 1 ? -1 : 1
of_energy(i) = strcol("epsilon") eq word(energies, i) && strcol("exponent") eq exponent
of(i, j, s) = of_energy(i) && strcol("delta") eq word(deltas, j) && column("sigma") == sigma(s)
at(i, j, s) = of(i, j, s) ? column("alpha") : NaN
above(x, y) = x > y ? x : y
highest(i) = of_energy(i) ? above(column("density"), column("exact_density")) : NaN

set xrange [-pi:pi]
set ytics 0.1
set mytics 2
unset key

set multiplot layout rows,columns margins 80.0/width,1 - 20.0/width,76.0/height,1 - 74.0/height \
  spacing 14.0/width,14.0/height
do for [i=1:rows] {
  stats data using (highest(i)) nooutput
  set yrange [0:1.12*STATS_max]
  if (STATS_max > 0.6) { set ytics 0.2 } else { set ytics 0.1 }
  do for [j=1:columns] {
    unset label
    unset title
    if (i == 1) { set label 1 "δ = ".word(deltas, j) at graph 0.5,1.08 center }
    set label 2 "ε = ".word(energies, i) at graph 0.03,0.91
    if (i == rows) {
      set xlabel "angle α"
      set xtics ("" -pi, "−π/2" -pi/2, "0" 0, "π/2" pi/2, "" pi)
    } else {
      unset xlabel
      set xtics ("" -pi, "" -pi/2, "" 0, "" pi/2, "" pi)
    }
    set format y j == 1 ? "%g" : ""
    if (j == 1) { set ylabel "density" } else { unset ylabel }
    plot for [s=1:2] data using (at(i, j, s)):"exact_density" with filledcurves y=0 \
           fillcolor rgb word(fill_of, s) fillstyle solid noborder, \
         for [s=1:2] data using (at(i, j, s)):(column("density") - column("error")): \
           (column("density") + column("error")) with filledcurves \
           fillcolor rgb word(line_of, s) fillstyle transparent solid 0.25 noborder, \
         for [s=1:2] data using (at(i, j, s)):"density" with lines lw 1.4 lc rgb word(line_of, s)
  }
}

# ---- The legend ----
unset label
unset border
unset tics
unset grid
unset xlabel
unset ylabel
set lmargin screen 0
set rmargin screen 1
set tmargin screen 1
set bmargin screen 1 - 50.0/height
set xrange [0:1]
set yrange [0:1]
set key at graph 0.5,0.8 center top horizontal Left reverse maxrows 1 samplen 1.8 width 1
plot for [s=1:2] NaN with lines lw 2 lc rgb word(line_of, s) title s == 1 ? "σ = −1" : "σ = +1", \
     for [s=1:2] NaN with boxes fillcolor rgb word(fill_of, s) fillstyle solid noborder \
       title s == 1 ? "h^{(1)}, σ = −1" : "h^{(1)}, σ = +1"
unset multiplot

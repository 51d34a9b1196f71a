# Draws conductivity.svg. Change it as you like; run it with:
# gnuplot conductivity.gnuplot
#
# The Green-Kubo conductivity, divided by the static conductivity (half of the exchange rate), with
# one standard error. Left: the billiard against delta. Right: rings of N cells in the limit of rare
# exchanges, against 1/N. The line is the value of the infinite gas, from Varadhan's formula.
# conductivity.sh lists the commands that write the data.

# ---- Settings ----
load "style.gnuplot"
set terminal svg size 960,520 enhanced font font background rgb "white"
set output "conductivity.svg"
billiard = "conductivity-billiard.csv"
rings = "conductivity-rings.csv"
measured_colour = "#3b4cc0"
exact_colour = "#b40426"

# ---- The data ----
is_ratio(_) = strcol("name") eq "conductivity_ratio"
ratio(_) = is_ratio(0) ? column("value") : NaN
correction(_) = is_ratio(0) ? 1000*(column("value") - 1) : NaN
# The column of the error is empty if a value has no error.
error(_) = strcol("standard_error") eq "" ? 0 : column("standard_error")
stats rings using (is_ratio(0) ? limit = column("limit") : NaN) nooutput

set multiplot layout 1,2
set mxtics 2
set mytics 2
set tmargin screen 0.95
set bmargin screen 0.16
unset key

# ---- Against delta ----
set lmargin screen 0.125
set rmargin screen 0.48
set xlabel "δ"
set ylabel "conductivity / static value"
set xrange [0:*]
set offsets 0, 0.01, 0.005, 0.005
set label 1 "billiard" at graph 0.06, graph 0.92 tc rgb measured_colour
set label 2 "rare exchanges" at graph 0.06, graph 0.84 tc rgb exact_colour
set arrow 1 from graph 0, first limit to graph 1, first limit nohead back lw 2 lc rgb exact_colour
plot billiard using (column("delta")):(ratio(0)):(error(0)) \
       with yerrorbars pt 7 ps 0.7 lw 1.5 lc rgb measured_colour

# ---- Against 1/N ----
set lmargin screen 0.615
set rmargin screen 0.985
set xlabel "1/N"
set ylabel "1000 (conductivity / static value − 1)" offset 1,0
set offsets 0, 0.02, 0.05, 0.05
set label 1 "jump process, rings of N cells" at graph 0.06, graph 0.92 tc rgb measured_colour
set label 2 sprintf("infinite: %.4f", 1000*(limit - 1)) at graph 0.40, graph 0.05 \
  tc rgb exact_colour
set arrow 1 from graph 0, first 1000*(limit - 1) to graph 1, first 1000*(limit - 1) nohead back \
  lw 2 lc rgb exact_colour
plot rings using (1.0/column("cells")):(correction(0)):(1000*error(0)) \
       with yerrorbars pt 7 ps 0.7 lw 1.5 lc rgb measured_colour
unset multiplot

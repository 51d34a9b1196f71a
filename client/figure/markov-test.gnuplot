# Draws markov-test.svg. Change it as you like; run it with: gnuplot markov-test.gnuplot
#
# The relative entropy of the ingoing law of first hits with respect to the equilibrium law h^(1),
# minus its noise floor, with one standard error, against delta. One panel for each outgoing law
# h^(n), one colour for each energy of the piston. The vertical axis is linear near 0, because noise
# makes values near the floor negative, and logarithmic elsewhere. Lines join the points of one
# energy.
# markov-test.sh lists the commands that write the data, and explains markov-test-decay.csv,
# markov-test-fit.csv and markov-test-maxima.csv.

# ---- Settings ----
load "style.gnuplot"
data = "markov-test-excess.csv"
small = "Helvetica,Arial,sans-serif,15"
panel_width = 540
panel_height = 420

# ---- The data ----
set datafile missing NaN  # joins lines across rows of other energies
with(list, x) = strstrt(list." ", " ".x." ") ? list : list." ".x
energies = ""
exponents = ""
note(_) = (energies = with(energies, strcol("epsilon")), \
           exponents = with(exponents, strcol("exponent")), column("standard_error"))
stats data using (note(0)) nooutput
noise = STATS_min
count = words(energies)
panels = words(exponents)
stats data using "delta":(column("excess") - column("standard_error")) nooutput
smallest = STATS_min_x
largest = STATS_max_x
lowest = STATS_min_y
stats data using (column("excess") + column("standard_error")) nooutput
highest = STATS_max

# The axis is linear below about two standard errors of the smallest noise, logarithmic above.
scaled(y) = asinh(y/(2*noise))/log(10)
of(i, n) = strcol("epsilon") eq word(energies, i) && strcol("exponent") eq n ? \
           scaled(column("excess")) : NaN
low(_) = scaled(column("excess") - column("standard_error"))
length(_) = scaled(column("excess") + column("standard_error")) - low(0)

across = panels == 1 ? 1 : 2
down = (panels + 1)/2
width = across == 1 ? 640 : 2*panel_width
height = down*panel_height + 60
set terminal svg size width,height enhanced font small background rgb "white"
set output "markov-test.svg"
set multiplot layout down,across margins 84.0/width,1 - 20.0/width,66.0/height,1 - 16.0/height \
  spacing 20.0/width,16.0/height
set logscale x
set xrange [0.93*smallest:1.07*largest]
set yrange [scaled(1.3*lowest):scaled(2*highest)]
# Tics at 0 and at powers of ten, which have labels in the left panels only.
first_decade = floor(log10(4*noise) + 0.5)
last_decade = ceil(log10(highest))
tics_at = "0.001 0.002 0.003 0.005 0.01 0.02 0.03 0.05 0.07 0.1 0.15 0.2 0.3"

set key top left Left reverse samplen 1 spacing 1.1 width -1
do for [panel=1:panels] {
  n = word(exponents, panel)
  set xtics ()
  bottom = panel > panels - across
  do for [k=1:words(tics_at)] {
    set xtics add (bottom ? word(tics_at, k) : "" real(word(tics_at, k)))
  }
  if (bottom) { set xlabel "δ" } else { unset xlabel }
  left = panel % 2 == 1 || across == 1
  if (left) { set ylabel "relative entropy − noise floor" offset 0.5,0 } else { unset ylabel }
  set ytics (left ? "0" : "" 0)
  do for [k=first_decade:last_decade] {
    set ytics add (left ? sprintf("10^{%d}", k) : "" scaled(10.0**k))
    if (-1.3*lowest > 10.0**k) {
      set ytics add (left ? sprintf("−10^{%d}", k) : "" scaled(-10.0**k))
    }
  }
  set label 1 "n = ".n.(n eq "1" ? ", the equilibrium law" : "") at graph 0.5,0.93 center
  if (panel == 1) { set key } else { unset key }
  plot 0 with lines lw 1 lc rgb black notitle, \
       for [i=1:count] data using "delta":(of(i, n)) with lines lw 1 lc rgb colour(i) notitle, \
       for [i=1:count] data using (of(i, n) == of(i, n) ? column("delta") : NaN):(low(0)): \
         (0):(length(0)) with vectors nohead lw 1 lc rgb colour(i) notitle, \
       for [i=1:count] data using "delta":(of(i, n)) with points pt 7 ps 0.45 lc rgb colour(i) \
         notitle, \
       for [i=1:count] NaN with linespoints pt 7 ps 0.7 lw 1 lc rgb colour(i) \
         title "ε = ".word(energies, i)
}
unset multiplot

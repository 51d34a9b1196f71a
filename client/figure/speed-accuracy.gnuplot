# Draws speed-accuracy.svg. Change it as you like; run it with: gnuplot speed-accuracy.gnuplot
#
# Errors of every method against their work, from speed-accuracy.csv, which the program
# method_comparison writes (speed-accuracy.sh has the command).
#   a  relative error of the conditional mean free time
#   b  bias of the ingoing law of first hits, as a Kullback-Leibler divergence
#   c  wall hits until an orbit leaves the high-precision orbit, against the time of a hit
#   d  relative error of the energy's relaxation time at several delta, by the billiard and by the
#      limit delta -> 0; left out if there are no relaxation times
#   e  relative error of the heat current of a gas of one cell between two reservoirs; left out if
#      there are no heat currents
# In a, b and e a line is one statistical error, the error that chance alone explains. A point is a
# measured error: pale if chance explains it, at the lower edge if it is smaller than shown. A
# dashed line is the bias of a method whose longest run resolves a bias. In b the noise floor is
# subtracted, so chance may make a value negative; then its absolute value is drawn. In d and e a
# line is the method's own statistical error, without the error of the truth; both errors decide
# whether a point is pale.

# ---- Settings ----
load "style.gnuplot"
data = "speed-accuracy.csv"

# The methods of panels a to c and e. Colours by Okabe and Ito, told apart by all kinds of colour
# vision; shapes differ too: filled for double, open for single precision. The last one is in e
# alone, and the closed form before it in a and b.
methods = "fixed-step billiard-reference-single billiard-reference billiard-reference-long-double \
billiard-reference-quadruple billiard billiard-single closed-form markov"
titles = "'fixed time step Δt' 'reference, single' 'reference, double' 'reference, 64 bits' \
'reference, 113 bits' 'vector lanes, double' 'vector lanes, single' 'closed form' 'jump process'"
colours = "#d55e00 #e69f00 #009e73 #cc79a7 #777777 #0072b2 #56b4e9 #000000 #882255"
markers = "2 8 9 11 13 7 6 5 4"  # gnuplot's point types

# Colours of d, from dark to light as delta falls: the dark half of viridis, whose luminance also
# distinguishes them. The other half is too light for text on white.
viridis = "#440154 #482475 #414487 #355f8d #2a788e #21918c #22a884 #3bbb75"
walk_colour = "#999999"
legend_colour = "#444444"
small = ",12"  # fonts
text = ",13"

fewest_samples = 64  # errors estimated from fewer are mostly chance themselves: not drawn
fewest_orbits = 256  # likewise, in d
below = 0.4          # room around the data of a logarithmic axis, as factors
above = 3
headroom = 1.15      # on a linear axis
room_for_steps = 60  # right of the longest run: the time steps stand there, from step_at on
bias_end = 1.6
step_at = 1.9
room_for_deltas = 150  # likewise in d
floor_end = 2.2
delta_at = 3
line_of_text = 0.06  # as a part of an axis

# ---- Functions ----
min(x, y) = x < y ? x : y
max(x, y) = x > y ? x : y
positive(x) = x > 0 ? x : NaN
not_below(edge, y) = y < edge ? edge : y
pale(colour) = "#70".colour[2:]

# Writes a number that is not negative: 10^{-2}, 6×10^{-15}
power(x) = power_of(sprintf("%.0e", x))
power_of(t) = (t[1:1] eq "1" ? "" : t[1:1]."×")."10^{".int(t[3:*] + 0)."}"

# 4.49 ± 0.37 %: the error to two digits, the value to the same place
percent(x, error) = percent_to(x, error, error > 0 ? max(0, -1 - floor(log10(error))) : 2)
percent_to(x, error, digits) = \
  sprintf("%.".digits."f ± ", 100*x).sprintf("%.".digits."f %%", 100*error)

# 17 ms
duration(s) = s < 0.9995e-6 ? in(s/1e-9, "ns") : s < 0.9995e-3 ? in(s/1e-6, "µs") : \
              s < 0.9995 ? in(s/1e-3, "ms") : s < 59.97 ? in(s, "s") : \
              s < 3598.2 ? in(s/60, "min") : in(s/3600, "h")
in(count, unit) = sprintf(count < 9.95 ? "%.1f " : "%.0f ", count).unit

# Labels that do not overlap. The labels should be at the heights y[1] ... y[m]; label(r) is the
# r-th from above, and spread(r) is its height, at least one line of text below the label before.
rank(j) = 1 + sum [k=1:m] (y[k] > y[j] || (y[k] == y[j] && k < j))
label(r) = sum [j=1:m] (rank(j) == r ? j : 0)
spread(r) = r == 1 ? y[label(1)] : min(y[label(r)], spread(r - 1)/gap)
gap_of(low, high) = (high/low)**line_of_text

# ---- The data ----

# Curves of a to c and e, each a method at a time step (as method@step); and the deltas of d,
# descending.
curves = ""
deltas = ""
name(_) = sprintf("%s@%.17e", strcol("method"), column("time_step"))
has(list, item) = strstrt(list." ", " ".item." ") > 0
note_curve(_) = has(curves, name(0)) ? 0 : (curves = curves." ".name(0), 1)
note_delta(_) = (deltas = deltas." ".strcol("delta"), 1)
note_pair(_) = (rho = column("rho"), delta = strcol("delta"), epsilon = strcol("epsilon"), 1)
gas_delta = ""
note_gas(_) = (gas_delta = strcol("delta"), 1)
quantity(q) = strcol("quantity") eq q
stats data using (quantity("limit-floor") ? note_delta(0) : quantity("relaxation-time") ? 0 : \
                  note_curve(0) + (quantity("heat-current") ? note_gas(0) : note_pair(0))) nooutput
has_gas = gas_delta ne ""

# The rows of panels and the legend have fixed heights, so the picture is higher with e.
without_e = 1040.0
row_of_panels = has_gas ? 400.0 : 0
height = without_e + row_of_panels
set terminal svg size 960,height enhanced font "Helvetica,Arial,sans-serif,15" \
  background rgb "white"
set output "speed-accuracy.svg"
panel_at(y) = (y*without_e + row_of_panels)/height   # a to e, from parts of the height without e
legend_at(y) = y*without_e/height

n = words(curves)
at_sign(i) = strstrt(word(curves, i), "@")
method(i) = word(curves, i)[:at_sign(i) - 1]
step(i) = word(curves, i)[at_sign(i) + 1:] + 0.0
style(i) = sum [k=1:words(methods)] (word(methods, k) eq method(i) ? k : 0)
method_colour(k) = word(colours, k + 0)
method_marker(k) = word(markers, k + 0) + 0
colour(i) = method_colour(style(i))
marker(i) = method_marker(style(i))
in_curve(i, x) = word(curves, i) eq name(0) ? x : NaN

shown(x) = column("samples") >= fewest_samples ? x : NaN
exact(x) = column("samples") == 0 ? x : NaN
resolved(x) = column("bias_resolved") == 1 ? x : NaN
unresolved(x) = column("bias_resolved") == 0 ? x : NaN

# The longest run of each curve.
array work[n]
array hits[n]
array value[n]
array error[n]
array bias[n]
array bias_from[n]
curve(_) = sum [k=1:n] (word(curves, k) eq name(0) ? k : 0)
note_run(i) = (work[i] = column("work_seconds"), hits[i] = column("wall_hits"), \
               value[i] = column("value"), error[i] = column("statistical_error"), \
               bias[i] = strcol("bias_resolved") eq "1" ? value[i] : 0, 1)
note_bias(i) = bias_from[i] == 0 && column("statistical_error") < bias[i] ? \
               (bias_from[i] = column("work_seconds"), 1) : 0

set multiplot
set tics nomirror
set mxtics 10
set mytics 10
unset key

# ---- Panels a, b and e: errors against work ----
panel_title(panel) = panel eq "a" ? "mean free time" : panel eq "b" ? "law of the ingoing angle" : \
                     "heat current of a gas of one cell"
do for [panel in has_gas ? "a b e" : "a b"] {
  q = panel eq "a" ? "mean-free-time" : panel eq "b" ? "ingoing-law" : "heat-current"
  of_panel(x) = quantity(q) ? x : NaN
  of(i, x) = of_panel(in_curve(i, x))

  # The ranges. (stats counts only values inside the axes, and fails with logarithmic axes.)
  unset logscale
  set xrange [*:*]
  set yrange [*:*]
  stats data using (of_panel(positive(column("work_seconds")))) name "work" nooutput
  stats data using (of_panel(shown(positive(column("own_error"))))) name "chance" nooutput
  stats data using (of_panel(shown(abs(column("value"))))) name "value" nooutput
  highest = max(chance_max, value_max)
  edge = below*chance_min

  do for [i=1:n] {
    work[i] = 0
    bias[i] = 0
    bias_from[i] = 0
  }
  stats data using (quantity(q) && column("samples") >= fewest_samples ? note_run(curve(0)) : 0) \
        nooutput
  stats data using (quantity(q) && column("samples") >= fewest_samples ? note_bias(curve(0)) : 0) \
        nooutput

  # Dashed lines: from the first run whose statistical error is smaller than the bias.
  set print $biases
  print "curve,x,y"
  do for [i=1:n] {
    if (bias_from[i] > 0) {
      print sprintf("%d,%.17g,%.17g", i, bias_from[i], bias[i])
      print sprintf("%d,%.17g,%.17g\n", i, work[i]*bias_end, bias[i])
    }
  }
  # The time steps, written at the ends of their curves.
  array y[n]
  array ends[n]
  m = 0
  do for [i=1:n] {
    if (step(i) > 0 && work[i] > 0) {
      m = m + 1
      ends[m] = i
      y[m] = bias[i] > 0 ? bias[i] : error[i]
    }
  }
  gap = gap_of(chance_min, highest)
  set print $steps
  print "x,y,text"
  do for [r=1:m] {
    i = ends[label(r)]
    print sprintf("%.17g,%.17g,Δt = ", work[i]*step_at, spread(r)).power(step(i))
  }
  set print

  set logscale xy
  set xrange [below*work_min:room_for_steps*work_max]
  set yrange [edge:above*highest]
  set format "10^{%T}"
  set xtics 10
  set ytics 10
  set lmargin screen panel eq "b" ? 0.585 : 0.085
  set rmargin screen panel eq "b" ? 0.985 : 0.485
  set tmargin screen panel_at(panel eq "e" ? 0.184 : 0.954)
  set bmargin screen panel_at(panel eq "e" ? -0.089 : 0.681)
  set title "{/:Bold ".panel."}  ".panel_title(panel) offset 0,-0.4
  set xlabel "work / s" offset 0,0.4
  set ylabel panel eq "b" ? "Kullback-Leibler divergence" : "relative error" offset 0.5,0
  plot for [i=1:n] data using (of(i, shown(column("work_seconds")))):"own_error" \
         with lines lw 1.5 lc rgb colour(i), \
       for [i=1:n] $biases using (column("curve") == i ? column("x") : NaN):"y" \
         with lines lw 1.5 dt (8,5) lc rgb colour(i), \
       for [i=1:n] data using (of(i, shown(column("work_seconds")))): \
         (not_below(edge, unresolved(abs(column("value"))))) \
         with points pt marker(i) ps 0.6 lw 1 lc rgb pale(colour(i)), \
       for [i=1:n] data using (of(i, shown(column("work_seconds")))): \
         (not_below(edge, resolved(column("value")))) \
         with points pt marker(i) ps 0.8 lw 1.7 lc rgb colour(i), \
       for [i=1:n] data using (of(i, exact(column("work_seconds")))): \
         (not_below(edge, column("value"))) with points pt marker(i) ps 0.9 lc rgb colour(i), \
       $steps using "x":"y":"text" with labels left font small tc rgb word(colours, 1), \
       data using (of_panel(exact(column("work_seconds")))):(edge): \
         ("≤ ".power(abs(column("value")))) with labels left offset 0.4,0.8 font small
}

# ---- Panel c: single orbits ----
# The longest runs alone: the cost of a hit and the horizon do not depend on the number of orbits.
unset logscale
set xrange [*:*]
set yrange [*:*]
do for [i=1:n] { work[i] = 0 }
stats data using (quantity("trajectory") ? note_run(curve(0)) : 0) nooutput
cost(i) = 1e9*work[i]/hits[i]
set print $orbits
print "curve,x,y,error"
do for [i=1:n] {
  if (work[i] > 0) { print sprintf("%d,%.17g,%.17g,%.17g", i, cost(i), value[i], error[i]) }
}
set print $steps
print "x,y,text"
equals = "Δt = "
do for [i=1:n] {
  if (work[i] > 0 && step(i) > 0) {
    print sprintf("%.17g,%.17g,", cost(i), value[i]).equals.power(step(i))
    equals = ""
  }
}
set print
stats $orbits using "x" name "cost" nooutput
stats $orbits using "y" name "hits" nooutput

set logscale x
set xrange [below*cost_min:cost_max/below]
set yrange [0:headroom*hits_max]
set format y "%g"
set ytics autofreq
set mytics 2
set lmargin screen 0.085
set rmargin screen 0.485
set tmargin screen panel_at(0.569)
set bmargin screen panel_at(0.296)
set title "{/:Bold c}  single orbits" offset 0,-0.4
set xlabel "time of a hit / ns" offset 0,0.4
set ylabel "hits until parted from a precise twin" offset 0.5,0
of_curve(i, x) = column("curve") == i ? x : NaN
# Error bars are drawn as vectors: gnuplot leaves white rings between its own and their points.
plot for [i=1:n] $orbits using (of_curve(i, column("x"))):(column("y") - column("error")): \
       (0):(2*column("error")) with vectors nohead lw 1 lc rgb colour(i), \
     for [i=1:n] $orbits using (of_curve(i, column("x"))):"y" \
       with points pt marker(i) ps 1 lw 1.5 lc rgb colour(i), \
     $steps using "x":"y":"text" \
       with labels right offset 0.6,0.9 font small tc rgb word(colours, 1)

# ---- Panel d: relaxation times ----
# The rows limit-floor give for each delta the bias of the limit, or an upper bound of it, and the
# work at which the billiard is as exact.
d = words(deltas)
shade(i) = word(viridis, d == 1 ? 1 : 1 + (i - 1)*(words(viridis) - 1)/(d - 1))
at(i, x) = strcol("delta") eq word(deltas, i) ? x : NaN
by(i, kind, x) = quantity("relaxation-time") && strcol("method") eq kind ? at(i, x) : NaN
floor_of(i, x) = quantity("limit-floor") ? at(i, x) : NaN
enough(x) = column("samples") >= fewest_orbits ? x : NaN
if (d > 0) {
  unset logscale
  set xrange [*:*]
  set yrange [*:*]
  of_d(x) = quantity("limit-floor") || (quantity("relaxation-time") && \
            (strcol("method") eq "spectrum" || column("samples") >= fewest_orbits)) ? x : NaN
  drawn_error(_) = strcol("method") ne "spectrum" ? positive(column("own_error")) : \
                   quantity("limit-floor") ? column("value") : NaN
  stats data using (of_d(positive(column("work_seconds")))) name "work" nooutput
  stats data using (of_d(drawn_error(0))) name "chance" nooutput
  stats data using (of_d(strcol("method") eq "spectrum" && !quantity("limit-floor") ? NaN : \
                    column("value"))) name "value" nooutput
  edge = below*chance_min
  top = above*max(chance_max, value_max)

  # The limit's bias or its bound, its error, and the two works of each delta; 0 if not known.
  m = d
  array y[d]
  array floor_error[d]
  array is_bias[d]
  array crossing[d]
  array spectrum_work[d]
  delta_of_row(_) = sum [k=1:d] (word(deltas, k) eq strcol("delta") ? k : 0)
  note_spectrum(i) = (spectrum_work[i] = column("work_seconds"), 1)
  note_floor(i) = (y[i] = column("value"), floor_error[i] = column("statistical_error"), \
                   is_bias[i] = column("bias_resolved") == 1, \
                   crossing[i] = strcol("work_seconds") eq "" ? 0 : column("work_seconds"), 1)
  stats data using (quantity("limit-floor") ? note_floor(delta_of_row(0)) : \
                    quantity("relaxation-time") && strcol("method") eq "spectrum" ? \
                    note_spectrum(delta_of_row(0)) : 0) nooutput
  gap = gap_of(edge, top)
  set print $names
  print "x,y,text"
  do for [r=1:m] {
    print sprintf("%.17g,%.17g,", delta_at*work_max, spread(r)).word(deltas, label(r))
  }
  set print

  set logscale xy
  set xrange [below*work_min:room_for_deltas*work_max]
  set yrange [edge:top]
  set format "10^{%T}"
  set xtics 10
  set ytics 10
  set mytics 10
  set lmargin screen 0.585
  set rmargin screen 0.985
  set title "{/:Bold d}  relaxation time: where the limit δ → 0 will do" offset 0,-0.4
  set xlabel "work / s" offset 0,0.4
  set ylabel "relative error" offset 0.5,0
  # In units of the limit's own time a walk is the same at every delta: one line stands for all.
  plot data using (by(1, "markov", enough(column("work_seconds")))):"own_error" \
         with lines lw 1.5 lc rgb walk_colour, \
       for [i=1:d] data using (by(i, "billiard", enough(column("work_seconds")))):"own_error" \
         with lines lw 1.5 lc rgb shade(i), \
       for [i=1:d] data using (floor_of(i, resolved(spectrum_work[i]))):"value": \
         (floor_end*work_max - spectrum_work[i]):(0) \
         with vectors nohead lw 1.5 dt (8,5) lc rgb shade(i), \
       for [i=1:d] data using (floor_of(i, unresolved(spectrum_work[i]))):"value": \
         (floor_end*work_max - spectrum_work[i]):(0) \
         with vectors nohead lw 1.7 dt (2,4) lc rgb shade(i), \
       for [i=1:d] for [kind in "billiard markov"] \
         data using (by(i, kind, enough(column("work_seconds")))): \
         (not_below(edge, unresolved(column("value")))) \
         with points pt (kind eq "markov" ? 4 : 7) ps 0.5 lw 1 lc rgb pale(shade(i)), \
       for [i=1:d] for [kind in "billiard markov"] \
         data using (by(i, kind, enough(column("work_seconds")))): \
         (not_below(edge, resolved(column("value")))) \
         with points pt (kind eq "markov" ? 4 : 7) ps 0.7 lw 1.5 lc rgb shade(i), \
       for [i=1:d] data using (by(i, "spectrum", column("work_seconds"))): \
         (not_below(edge, unresolved(column("value")))) \
         with points pt 13 ps 0.9 lc rgb pale(shade(i)), \
       for [i=1:d] data using (by(i, "spectrum", column("work_seconds"))): \
         (not_below(edge, resolved(column("value")))) with points pt 13 ps 0.9 lc rgb shade(i), \
       for [i=1:d] data using (floor_of(i, column("work_seconds"))):"value" \
         with points pt 6 ps 1.6 lw 2 lc rgb shade(i), \
       for [i=1:d] $names using (strcol("text") eq word(deltas, i) ? column("x") : NaN):"y": \
         ("δ = ".strcol("text")) with labels left font small tc rgb shade(i)
}

# ---- The legend ----
unset logscale
unset border
unset tics
unset grid
unset xlabel
unset ylabel
unset title
set xrange [0:1]
set yrange [0:1]
set lmargin screen 0.01
set rmargin screen 0.49
set tmargin screen legend_at(0.236)
set bmargin screen legend_at(0.004)
set key at graph 0.02,0.99 left top Left reverse samplen 2.5 spacing 1.1 maxrows 4 font text
set label sprintf("a, b: ρ = %.6g, δ = %s, ε = %s; c%s: the same ρ.", rho, delta, epsilon, \
                  d > 0 ? ", d" : "") at graph 0.04,0.560 font text
set label "Line: statistical error σ." at graph 0.04,0.484 font text
set label "Point: measured error, pale if below 3σ." at graph 0.04,0.408 font text
set label "Dashed: bias, if the longest run's error is above 3σ." at graph 0.04,0.332 font text
set label "At the lower edge: smaller than shown." at graph 0.04,0.256 font text
last = words(methods) - 1  # the closed form
entries = ""
do for [k=1:last-1] {
  if (strstrt(curves, " ".word(methods, k)."@") > 0) { entries = entries." ".k }
}
plot for [k in entries] NaN with linespoints pt method_marker(k) ps 1 lw 1.5 \
       lc rgb method_colour(k) title word(titles, k + 0), \
     NaN with points pt method_marker(last) ps 1 lw 1.5 \
       lc rgb method_colour(last) title word(titles, last)

# ---- The legend of d, and a table of the limit's biases ----
if (d > 0) {
  unset label
  set lmargin screen 0.51
  set rmargin screen 0.99
  set key at graph 0.02,0.99 left top Left reverse samplen 2.5 spacing 1.1 maxrows 3 font text
  set label "d: δ by colour. Left of ○ the limit (jump process, spectrum)" \
    at screen 0.029,legend_at(0.0458) font text
  set label "costs less; below its line, the bias, it may not be used." \
    at screen 0.029,legend_at(0.0281) font text
  set label "δ" at graph 0.04,0.64 font text
  set label "bias of the limit" at graph 0.2,0.64 font text
  set label "billiard as exact after" at graph 0.46,0.64 font text
  do for [i=1:d] {
    row = 0.64 - 0.076*i
    set label word(deltas, i) at graph 0.04,row font text tc rgb shade(i)
    set label is_bias[i] ? percent(y[i], floor_error[i]) : sprintf("≤ %.2g %%", 100*y[i]) \
      at graph 0.2,row font text tc rgb shade(i)
    set label crossing[i] == 0 ? "–" : (is_bias[i] ? "" : "≥ ").duration(crossing[i]) \
      at graph 0.46,row font text tc rgb shade(i)
  }
  plot NaN with linespoints pt 7 ps 0.8 lw 1.5 lc rgb legend_colour title "billiard, in lanes", \
       NaN with linespoints pt 4 ps 0.8 lw 1.5 lc rgb walk_colour title "jump process", \
       NaN with points pt 13 ps 1 lc rgb legend_colour title "spectrum", \
       NaN with lines lw 1.5 dt (8,5) lc rgb legend_colour title "bias of the limit", \
       NaN with lines lw 1.7 dt (2,4) lc rgb legend_colour title "bias ≤ error + 2σ", \
       NaN with points pt 6 ps 1.6 lw 2 lc rgb legend_colour title "billiard as exact"
}

# ---- The legend of e, beside it ----
if (has_gas) {
  unset label
  set lmargin screen 0.56
  set rmargin screen 0.99
  set tmargin screen panel_at(0.184)
  set bmargin screen panel_at(-0.089)
  set key at graph 0.0,0.99 left top Left reverse samplen 2.5 spacing 1.1 maxrows 4 font text
  set label sprintf("e: ρ = %.6g, δ = %s; one ball between two", rho, gas_delta) \
    at graph 0.02,0.56 font text
  set label "pistons, which hit thermal walls at T = 1.5 and 0.5." at graph 0.02,0.48 font text
  set label "Line: the method's own statistical error. Points and" at graph 0.02,0.40 font text
  set label "dashed lines: as in a, with the error of the truth, a" at graph 0.02,0.32 font text
  set label "longer run of the vector lanes." at graph 0.02,0.24 font text
  of_e = ""
  do for [k in "1 3 6 9"] {
    if (strstrt(curves, " ".word(methods, k + 0)."@") > 0) { of_e = of_e." ".k }
  }
  plot for [k in of_e] NaN with linespoints pt method_marker(k) ps 1 lw 1.5 \
         lc rgb method_colour(k) title word(titles, k + 0)
}
unset multiplot

# Draws speed-accuracy.svg. Change it as you like; run it with: gnuplot speed-accuracy.gnuplot
#
# Work-precision diagrams of every method, from speed-accuracy.csv. The program method_comparison
# writes this file (speed-accuracy.sh contains the command).
#   a, b  relative error of the conditional mean free time, against time and against wall hits
#   c     error of the ingoing law of first hits, as a Kullback-Leibler divergence
#   d     wall hits until an orbit leaves the high-precision orbit, against the time of a hit
#   e     relative error of the energy's relaxation time, by the billiard and by the limit
#         delta -> 0, for the largest deltas (at most two) that resolve the bias of the limit
#   f     relative error of the heat current of a gas of one cell between two reservoirs
# A line is the expected error, the root of sigma^2 + bias^2. sigma is the statistical error
# of a run. bias is the deviation of the method's longest run if it exceeds three statistical
# errors, else 0. An error bar is one standard error of the error. Single precision and the
# reference with 64 bits are drawn only in d: in the other panels their lines would almost coincide
# with the lines of double precision.
# Panels without data are left out.

# ---- Settings ----
load "style.gnuplot"
data = "speed-accuracy.csv"
small = ",13"
text = ",14"

# The methods of panels a, b, c and f. Colours by Okabe and Ito.
methods = "fixed-step billiard-reference billiard-reference-quadruple billiard markov"
titles = "'Δt' 'reference' '113 bits' 'vector lanes' 'jump process'"
method_colours = "#d55e00 #009e73 #777777 #0072b2 #882255"

# All methods of panel d.
orbit_methods = methods." billiard-single billiard-reference-single billiard-reference-long-double"
orbit_titles = titles." 'lanes, single' 'reference, single' '64 bits'"
orbit_colours = method_colours." #56b4e9 #e69f00 #cc79a7"

delta_colours = "#440154 #2a788e"
fewest_samples = 64   # errors from fewer samples are too uncertain and are not drawn
fewest_orbits = 256   # the same for e
label_at = 1.5        # a label is right of the end of its line, by this factor
room = 150            # space for the labels, right of the longest run, as a factor
line_of_text = 0.062  # height of a line of text, as a share of an axis

# ---- Functions ----
min(x, y) = x < y ? x : y
max(x, y) = x > y ? x : y
hypot(x, y) = sqrt(x**2 + y**2)
positive(x) = x > 0 ? x : NaN

# Writes a number that is not negative: 10^{-2}, 6×10^{-15}
power(x) = power_of(sprintf("%.0e", x))
power_of(t) = (t[1:1] eq "1" ? "" : t[1:1]."×")."10^{".int(t[3:*] + 0)."}"

# 17 ms
duration(s) = s < 0.9995e-6 ? in(s/1e-9, "ns") : s < 0.9995e-3 ? in(s/1e-6, "µs") : \
              s < 0.9995 ? in(s/1e-3, "ms") : in(s, "s")
in(count, unit) = sprintf(count < 9.95 ? "%.1f " : "%.0f ", count).unit

# Labels that do not overlap. y[1] ... y[m] are the wanted heights of the labels. label(r) is the
# r-th label from above. spread(r) is its height, at least one line of text below the label r - 1.
rank(j) = 1 + sum [k=1:m] (y[k] > y[j] || (y[k] == y[j] && k < j))
label(r) = sum [j=1:m] (rank(j) == r ? j : 0)
spread(r) = r == 1 ? y[label(1)] : min(y[label(r)], spread(r - 1)/gap)
gap_of(low, high) = (high/low)**line_of_text

# ---- The data ----
quantity(q) = strcol("quantity") eq q
has(list, item) = strstrt(list." ", " ".item." ") > 0

# The curves. Each curve is a method at a time step, written as method@step.
curves = ""
deltas = ""
gas_delta = ""
name(_) = sprintf("%s@%g", strcol("method"), column("time_step"))
note_curve(_) = has(curves, name(0)) ? 0 : (curves = curves." ".name(0), 1)
note_delta(_) = (deltas = deltas." ".strcol("delta"), 1)
note_pair(_) = (rho = column("rho"), delta = strcol("delta"), epsilon = strcol("epsilon"), 1)
note_gas(_) = (gas_delta = sprintf("%.6g", column("delta")), 1)
closed_work = 0
closed_error = 0
note_closed(_) = quantity("mean-free-time") && strcol("method") eq "closed-form" ? \
                 (closed_work = column("work_seconds"), closed_error = column("value"), 1) : 0
stats data using (quantity("limit-floor") ? note_delta(0) : quantity("relaxation-time") ? 0 : \
                  note_closed(0) + note_curve(0) + \
                  (quantity("heat-current") ? note_gas(0) : note_pair(0))) nooutput
has_gas = gas_delta ne ""
n = words(curves)
at_sign(i) = strstrt(word(curves, i), "@")
method(i) = word(curves, i)[:at_sign(i) - 1]
step(i) = word(curves, i)[at_sign(i) + 1:] + 0.0
style(i) = sum [k=1:words(orbit_methods)] (word(orbit_methods, k) eq method(i) ? k : 0)
colour(i) = style(i) == 0 ? grey : word(orbit_colours, style(i))
title_of(i) = step(i) > 0 ? "Δt = ".power(step(i)) : word(orbit_titles, style(i))
drawn(i) = style(i) > 0 && style(i) <= words(methods)
in_curve(i, x) = word(curves, i) eq name(0) ? x : NaN
shown(x) = column("samples") >= fewest_samples ? x : NaN

array work[n]    # work of the longest run of each curve; 0: no run
array hits[n]
array value[n]
array error[n]
array bias[n]
array bias_error[n]
curve(_) = sum [k=1:n] (word(curves, k) eq name(0) ? k : 0)
note_run(i) = (work[i] = column("work_seconds"), hits[i] = column("wall_hits"), \
               value[i] = column("value"), error[i] = column("own_error"), \
               bias[i] = strcol("bias_resolved") eq "1" ? value[i] : 0, \
               bias_error[i] = column("statistical_error"), 1)

# ---- The picture ----
set terminal svg size 960,1290 enhanced font "Helvetica,Arial,sans-serif,15" \
  background rgb "white"
set output "speed-accuracy.svg"
set multiplot
set tics nomirror
set mytics 10
unset key
left_of(panel) = strstrt("ace", panel) > 0 ? 0.085 : 0.59
top_of(panel) = strstrt("ab", panel) > 0 ? 0.972 : strstrt("cd", panel) > 0 ? 0.659 : 0.346
panel_width = 0.395
panel_height = 0.232
place = 'set lmargin screen left_of(panel); set rmargin screen left_of(panel) + panel_width; \
         set tmargin screen top_of(panel); set bmargin screen top_of(panel) - panel_height'

# ---- a, b, c and f: errors against work ----
panel_title(panel) = panel eq "a" ? "mean free time, against time" : \
                     panel eq "b" ? "mean free time, against wall hits" : \
                     panel eq "c" ? "law of the ingoing angle" : "heat current of a gas of one cell"
# The expected error of a run of curve i, and its standard error if the scatter is normal.
expected(i) = hypot(column("own_error"), bias[i])
uncertain(i) = hypot(column("own_error")**2/sqrt(2*column("samples")), \
                     bias[i]*bias_error[i])/expected(i)
do for [panel in has_gas ? "a b c f" : "a b c"] {
  q = panel eq "c" ? "ingoing-law" : panel eq "f" ? "heat-current" : "mean-free-time"
  by = panel eq "b" || panel eq "c" ? "wall_hits" : "work_seconds"
  of_panel(x) = quantity(q) ? x : NaN
  of(i, x) = of_panel(in_curve(i, shown(x)))

  unset logscale
  set xrange [*:*]
  set yrange [*:*]
  do for [i=1:n] {
    work[i] = 0
    error[i] = 0
    bias[i] = 0
    bias_error[i] = 0
  }
  stats data using (quantity(q) && column("samples") >= fewest_samples ? note_run(curve(0)) : 0) \
        nooutput
  stats data using (of_panel(shown(positive(column(by))))) name "work" nooutput
  stats data using (of_panel(shown(positive(column("own_error"))))) name "chance" nooutput
  highest = chance_max
  # Against time each line has a name. Against hits, all methods without a bias have the same line.
  # Its name is at the end of the line of the vector lanes, or of another method if there are no
  # lanes.
  by_hits = by eq "wall_hits"
  common = 0
  do for [i=1:n] {
    is_common = by_hits && work[i] > 0 && drawn(i) && bias[i] == 0
    if (is_common && (common == 0 || method(i) eq "billiard")) { common = i }
  }
  array y[n]
  array ends[n]
  m = 0
  failed = ""
  do for [i=1:n] {
    if (work[i] > 0 && drawn(i)) {
      highest = max(highest, hypot(error[i], bias[i]))
      if (!by_hits || bias[i] > 0 || i == common) {
        m = m + 1
        ends[m] = i
        y[m] = hypot(error[i], bias[i])
      }
    }
    if (work[i] == 0 && method(i) eq "fixed-step") {
      failed = failed.(failed eq "" ? "Δt = " : ", ").power(step(i))
    }
  }
  lowest = 0.4*chance_min
  gap = gap_of(lowest, 3*highest)
  set print $names
  print "curve,x,y"
  do for [r=1:m] {
    i = ends[label(r)]
    print sprintf("%d,%.17g,%.17g", i, label_at*(by_hits ? hits[i] : work_max), spread(r))
  }
  set print

  set logscale xy
  set xrange [0.5*work_min:room*work_max]
  set yrange [lowest:3*highest]
  set format "10^{%T}"
  set xtics 10
  set ytics 10
  set mxtics 10
  eval place
  set title "{/:Bold ".panel."}  ".panel_title(panel) offset 0,-0.5
  set xlabel by_hits ? "wall hits" : "time / s" offset 0,0.4
  set ylabel panel eq "c" ? "Kullback-Leibler divergence" : "relative error" offset 0.5,0
  set label 1 panel eq "a" && closed_work > 0 ? "closed form: ".duration(closed_work).\
              ", error ≤ ".power(closed_error) : panel ne "f" || failed eq "" ? "" : \
              "balls lost, or too slow: ".failed \
            at graph 0.03,0.06 left font small
  plot for [i=1:n] data using (drawn(i) ? of(i, column(by)) : NaN):(expected(i)) \
         with lines lw 2 lc rgb colour(i), \
       for [i=1:n] data using (drawn(i) ? of(i, column(by)) : NaN): \
         (max(expected(i) - uncertain(i), lowest)):(0): \
         (expected(i) + uncertain(i) - max(expected(i) - uncertain(i), lowest)) \
         with vectors nohead lw 1.2 lc rgb colour(i), \
       for [i=1:n] data using (drawn(i) ? of(i, column(by)) : NaN):(expected(i)) \
         with points pt 7 ps 0.4 lc rgb colour(i), \
       for [i=1:n] $names using (column("curve") == i ? column("x") : NaN):"y": \
         (i == common ? "all others" : title_of(i)) with labels left font small tc rgb colour(i)
}
unset label 1

# ---- d: single orbits ----
# Only the longest runs: the cost of a hit and the horizon do not depend on the number of orbits.
panel = "d"
unset logscale
set xrange [*:*]
set yrange [*:*]
do for [i=1:n] { work[i] = 0 }
stats data using (quantity("trajectory") ? note_run(curve(0)) : 0) nooutput
cost(i) = 1e9*work[i]/hits[i]
set print $orbits
print "curve,x,y,error"
first_step = 0
do for [i=1:n] {
  if (work[i] > 0) {
    print sprintf("%d,%.17g,%.17g,%.17g", i, cost(i), value[i], error[i])
    if (step(i) > 0 && first_step == 0) { first_step = i }
  }
}
set print
stats $orbits using "x" name "cost" nooutput
stats $orbits using "y" name "horizon" nooutput
of_curve(i, x) = column("curve") == i ? x : NaN
stepped(x) = step(int(column("curve"))) > 0 ? x : NaN
exact(x) = step(int(column("curve"))) > 0 ? NaN : x
set logscale x
set xrange [0.2*cost_min:5*cost_max]
set yrange [-0.36*horizon_max:1.2*horizon_max]
set format y "%g"
set ytics 20
set mytics 1
eval place
set title "{/:Bold d}  single orbits" offset 0,-0.5
set xlabel "time of a wall hit / ns" offset 0,0.4
set ylabel "wall hits until the orbit is wrong" offset 0.5,0
set arrow 1 from graph 0,first 0 to graph 1,first 0 nohead lw 1 lc rgb grey
# Error bars are drawn as vectors: the error bars of gnuplot leave white rings around the points.
plot for [i=1:n] $orbits using (of_curve(i, column("x"))):(column("y") - column("error")): \
       (0):(2*column("error")) with vectors nohead lw 1.2 lc rgb colour(i), \
     for [i=1:n] $orbits using (of_curve(i, column("x"))):"y" \
       with points pt 7 ps 0.7 lc rgb colour(i), \
     for [i=1:n] $orbits using (of_curve(i, exact(column("x")))):"y":(title_of(i)) \
       with labels center offset 0,0.9 font small tc rgb colour(i), \
     for [i=1:n] $orbits using (of_curve(i, stepped(column("x")))):(-0.03*horizon_max): \
       (i == first_step ? title_of(i) : power(step(i))) \
       with labels right rotate by 90 font small tc rgb colour(i)
unset arrow 1

# ---- e: relaxation times ----
# For each delta the rows limit-floor contain the bias of the limit, or an upper bound of it, and
# the work at which the billiard has the same error.
d = words(deltas)
if (d > 0) {
  panel = "e"
  array limit_bias[d]
  array is_bias[d]
  array crossing[d]
  delta_of_row(_) = sum [k=1:d] (word(deltas, k) eq strcol("delta") ? k : 0)
  note_floor(k) = (limit_bias[k] = column("value"), \
                   is_bias[k] = strcol("bias_resolved") eq "1" ? 1 : 0, 1)
  unset logscale
  set xrange [*:*]
  set yrange [*:*]
  stats data using (quantity("limit-floor") ? note_floor(delta_of_row(0)) : 0) nooutput
  chosen = ""
  bounds = ""
  do for [k=1:d] {
    if (is_bias[k] == 1 && words(chosen) < words(delta_colours)) {
      chosen = chosen." ".k
    } else {
      if (is_bias[k] == 0) {
        bounds = bounds.sprintf("%sδ = %s: ≤ %.2g %%", bounds eq "" ? "" : ", ", \
                                word(deltas, k), 100*limit_bias[k])
      }
    }
  }
  if (chosen eq "") { chosen = " 1" }
  shade(c) = word(delta_colours, c)
  which(c) = int(word(chosen, c) + 0)
  by(c, kind, x) = quantity("relaxation-time") && strcol("method") eq kind && \
                   strcol("delta") eq word(deltas, which(c)) && \
                   (kind eq "spectrum" || column("samples") >= fewest_orbits) ? x : NaN
  of_e(x) = quantity("relaxation-time") && column("samples") >= fewest_orbits ? x : NaN
  stats data using (of_e(column("work_seconds"))) name "work" nooutput
  stats data using (quantity("relaxation-time") ? positive(column("work_seconds")) : NaN) \
        name "all" nooutput
  stats data using (of_e(strcol("method") eq "billiard" ? column("own_error") : NaN)) \
        name "chance" nooutput
  limit_error(c) = hypot(column("own_error"), limit_bias[which(c)])
  lowest = 0.3*chance_min
  highest = 3*chance_max

  # The labels at the right: the billiard and the limit for each delta.
  c_max = words(chosen)
  array y[2*c_max]
  array last_error[c_max]
  array last_work[c_max]
  note_last(c) = (last_error[c] = column("own_error"), last_work[c] = column("work_seconds"), 1)
  do for [c=1:c_max] {
    last_error[c] = 0
    stats data using (by(c, "billiard", 1) == 1 ? note_last(c) : 0) nooutput
    y[2*c - 1] = last_error[c]
    y[2*c] = limit_bias[which(c)]
  }
  m = 2*c_max
  gap = gap_of(lowest, highest)
  set print $names
  print "colour,kind,x,y"
  do for [r=1:m] {
    j = label(r)
    print sprintf("%d,%s,%.17g,%.17g", (j + 1)/2, j % 2 == 1 ? "billiard" : "limit", \
                  label_at*work_max, spread(r))
  }
  set print

  set logscale xy
  set xrange [0.3*all_min:30*room*work_max]
  set yrange [lowest:highest]
  set format "10^{%T}"
  set xtics 10
  set ytics 10
  set mytics 10
  eval place
  set title "{/:Bold e}  relaxation time: where the limit δ → 0 will do" offset 0,-0.5
  set xlabel "time / s" offset 0,0.4
  set ylabel "relative error" offset 0.5,0
  do for [c=1:c_max] {
    set arrow c from first all_min,first limit_bias[which(c)] \
      to first work_max,first limit_bias[which(c)] nohead lw 1.5 dt (3,4) lc rgb shade(c)
  }
  set label 1 "spectrum" at first all_min,first limit_bias[which(1)] left offset -0.5,1 \
    font small tc rgb shade(1)
  set label 2 bounds eq "" ? "" : "limit unresolved:" at graph 0.03,0.13 left font small
  set label 3 bounds at graph 0.03,0.06 left font small
  plot for [c=1:c_max] data using (by(c, "markov", column("work_seconds"))):(limit_error(c)) \
         with linespoints lw 2 dt (8,4) pt 7 ps 0.4 lc rgb shade(c), \
       for [c=1:c_max] data using (by(c, "billiard", column("work_seconds"))):"own_error" \
         with linespoints lw 2 pt 7 ps 0.4 lc rgb shade(c), \
       for [c=1:c_max] data using (by(c, "spectrum", column("work_seconds"))): \
         (limit_bias[which(c)]) with points pt 13 ps 0.9 lc rgb shade(c), \
       for [c=1:c_max] $names using (column("colour") == c ? column("x") : NaN):"y": \
         (strcol("kind").", δ = ".word(deltas, which(c))) \
         with labels left font small tc rgb shade(c)
  unset arrow
  unset label
}

# ---- The parameters ----
unset logscale
unset border
unset tics
unset grid
unset xlabel
unset ylabel
unset title
set lmargin screen 0
set rmargin screen 1
set tmargin screen 0.05
set bmargin screen 0
set xrange [0:1]
set yrange [0:1]
set label sprintf("a to c: ρ = %.6g, δ = %s, ε = %s. d: this ρ.", rho, delta, epsilon).\
          (has_gas ? sprintf(" f: this ρ, δ = %s, walls at T = 1.5 and 0.5.", gas_delta) : "") \
  at screen 0.03,0.037 left font text
set label "Lines: statistical error and bias. 113 bits: the reference, more precise. \
Not drawn in a to c: single, 64 bits; as double." at screen 0.03,0.017 left font text
plot NaN notitle
unset multiplot

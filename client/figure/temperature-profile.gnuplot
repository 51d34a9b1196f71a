# Draws temperature-profile.svg. Change it as you like; run it with:
# gnuplot temperature-profile.gnuplot
#
# Temperatures of balls and pistons along chains of N cells between two reservoirs, against x/N,
# from the jump process (the limit delta -> 0) and from the billiard. If the conductivity grows as
# sqrt(T), T^(3/2) falls linearly. Lower panel: the difference from that line.
# temperature-profile.sh lists the commands that write the data.

# ---- Settings ----
load "style.gnuplot"
set terminal svg size 960,840 enhanced font font background rgb "white"
set output "temperature-profile.svg"
measured(model) = "temperature-profile-".model.".csv"
aside = 0.007  # shift of the billiard's points to the right, so that all points are visible

# ---- The data ----

lengths = ""
note(n) = (lengths = strstrt(lengths." ", " ".n." ") ? lengths : lengths." ".n, 1)
stats measured("markov") \
  using (hot = column("hot"), cold = column("cold"), note(strcol("cells"))) nooutput
n = words(lengths)

line(t) = (hot**1.5 + (cold**1.5 - hot**1.5)*t)**(2/3.0)
is_piston(_) = column("position") == floor(column("position"))
part(_) = column("position")/column("cells")
# The bodies of one kind in the chain i.
of(i, piston) = strcol("cells") eq word(lengths, i) && is_piston(0) == piston
at(i, model, piston) = of(i, piston) ? part(0) + (model eq "billiard" ? aside : 0) : NaN
error(_) = strcol("standard_error") eq "" ? 0 : column("standard_error")
temperature(_) = column("value")
excess(_) = column("value") - line(part(0))
# Points of the jump process are filled. Balls are round, pistons square.
shape(model, piston) = (piston ? 4 : 6) + (model eq "markov" ? 1 : 0)
size(piston) = piston ? 0.62 : 0.7

set multiplot
set xrange [-0.02:1.03]
set xtics 0.2
set mxtics 2
set mytics 2
set lmargin screen 0.115
set rmargin screen 0.975

# ---- The temperatures ----
set tmargin screen 0.975
set bmargin screen 0.455
set format x ""
set ylabel "temperature T"
set key top right Left reverse samplen 1.2 spacing 1.15 width 1
models = "markov billiard"
plot x < 0 || x > 1 ? NaN : line(x) with lines lw 2 lc rgb black title "linear T^{3/2}", \
     for [i=1:n] for [piston=0:1] for [model in models] measured(model) \
       using (at(i, model, piston)):(temperature(0)) \
       with points pt shape(model, piston) ps size(piston) lw 1.3 lc rgb colour(i) notitle, \
     for [i=1:n] NaN with points pt 7 ps 0.8 lc rgb colour(i) \
       title "N = ".word(lengths, i), \
     NaN with points pt 7 ps 0.8 lc rgb "#606060" title "balls, δ → 0", \
     NaN with points pt 5 ps 0.75 lc rgb "#606060" title "pistons, δ → 0", \
     NaN with points pt 6 ps 0.8 lw 1.3 lc rgb "#606060" title "balls, billiard", \
     NaN with points pt 4 ps 0.75 lw 1.3 lc rgb "#606060" title "pistons, billiard"

# ---- The difference, with one standard error ----
# Error bars are drawn as vectors: the error bars of gnuplot leave white rings around the points.
set tmargin screen 0.43
set bmargin screen 0.105
set format x "%g"
set xlabel "x/N"
set ylabel "T minus the line"
unset key
plot 0 with lines lw 2 lc rgb black, \
     for [i=1:n] for [piston=0:1] for [model in models] measured(model) \
       using (at(i, model, piston)):(excess(0) - error(0)):(0):(2*error(0)) \
       with vectors nohead lw 1 lc rgb colour(i), \
     for [i=1:n] for [piston=0:1] for [model in models] measured(model) \
       using (at(i, model, piston)):(excess(0)) \
       with points pt shape(model, piston) ps size(piston) lw 1.3 lc rgb colour(i)
unset multiplot

# Draws kernel.svg. Change it as you like; run it with: gnuplot kernel.gnuplot
#
# The density W/f of the piston's energy after a collision, for several energies before it. Lines:
# the exact kernel, which diverges at 0 and at the largest energy, 1/2 - epsilon. Points: collisions
# of the billiard, with one standard error.
# kernel.sh lists the commands that write the data.

# ---- Settings ----
load "style.gnuplot"
exact = "kernel-exact.csv"
measured = "kernel-measured.csv"
height = 350     # of a row of panels
highest = 3.2    # density of a panel, in units of its mean

# ---- The data ----
energies = ""
note(e) = (energies = strstrt(energies." ", " ".e." ") ? energies : energies." ".e, 1)
stats exact using (note(strcol("epsilon"))) nooutput
n = words(energies)
energy(i) = real(word(energies, i))
of(i, x) = column("epsilon") == energy(i) ? x : NaN
positive(x) = x > 0 ? x : NaN

rows = (n + 1)/2
set terminal svg size 960,rows*height enhanced font font background rgb "white"
set output "kernel.svg"
set multiplot layout rows,2 margins 0.09,0.98,76.0/(rows*height),1 - 20.0/(rows*height) \
  spacing 0.09,50.0/(rows*height)
unset key
set xrange [0:0.5]
set xtics 0.1
set mxtics 2
do for [i=1:n] {
  if (i > n - 2) { set xlabel "piston energy after, ε'" offset 0,0.3 } else { unset xlabel }
  if (i % 2 == 1) { set ylabel "W(ε, ε')/f(ε)" } else { unset ylabel }
  set yrange [0:highest/(0.5 - (energy(i) < 0.49 ? energy(i) : 0.49))]
  # The label is left or right of the curve that rises at 1/2 - epsilon.
  set label 1 "ε = ".word(energies, i) at graph energy(i) < 0.2 ? 0.35 : 0.85,0.9 center
  # Error bars are drawn as vectors: the error bars of gnuplot leave white rings around the points.
  plot exact using (of(i, column("outgoing"))):(positive(column("density"))) \
         with lines lw 2 lc rgb black, \
       measured using (of(i, column("outgoing"))): \
         (column("density") - column("standard_error")):(0):(2*column("standard_error")) \
         with vectors nohead lw 1.2 lc rgb colour(i), \
       measured using (of(i, column("outgoing"))):"density" \
         with points pt 7 ps 0.6 lc rgb colour(i)
}
unset multiplot

# Draws relative-entropy.svg. Change it as you like; run it with:
# gnuplot relative-entropy.gnuplot
#
# The relative entropy of the ingoing law of first hits with respect to the equilibrium law h^(1),
# against delta, for four outgoing laws h^(n) and several energies of the piston, with one standard
# error. Lines are noise floors: the mean for samples drawn from h^(1). Below epsilon = 1/4 the
# histograms have twice as many bins, and the floor is twice as high.
# relative-entropy.sh lists the commands that write the data.

# ---- Settings ----
load "style.gnuplot"
set terminal svg size 960,840 enhanced font font background rgb "white"
set output "relative-entropy.svg"
measured = "relative-entropy.csv"
exponents = "0 1 5 10"  # one panel each
aside = 1.025  # the points of successive energies are shifted in delta by this factor

# ---- The data ----
set datafile missing NaN  # joins lines across rows of other energies
is_of(name, n) = strcol("name") eq name && column("exponent") == n
energies = ""
note(e) = (energies = strstrt(energies." ", " ".e." ") ? energies : energies." ".e, 1)
stats measured using (note(strcol("epsilon"))) nooutput
count = words(energies)
stats measured using (column("delta")) nooutput
smallest = STATS_min
largest = STATS_max
energy(i) = real(word(energies, i))
of(i, n, name) = is_of(name, n) && column("epsilon") == energy(i) ? column("value") : NaN
error(_) = column("standard_error")
beside(i) = column("delta")*aside**(i - (count + 1)/2.0)

set multiplot layout 2,2 margins 0.11,0.98,0.09,0.97 spacing 0.09,0.07
set logscale xy
set xrange [0.88*smallest:1.14*largest]
set format y "10^{%T}"
set xtics ("0.0004" 0.0004, "0.0008" 0.0008, "0.0016" 0.0016, "0.003" 0.003, "0.006" 0.006, \
           "0.0125" 0.0125, "0.025" 0.025, "0.05" 0.05, "0.1" 0.1, "0.2" 0.2)
set key top left Left reverse samplen 0.8 spacing 1.05 width -2 font ",15"
do for [panel=1:words(exponents)] {
  n = int(word(exponents, panel))
  if (panel > 2) { set xlabel "δ" } else { unset xlabel }
  if (panel % 2 == 1) { set ylabel "relative entropy" } else { unset ylabel }
  set label 1 sprintf("n = %d", n) at graph 0.97, graph 0.06 right
  if (panel == 2) { set key } else { unset key }
  plot for [i=1:count] measured using (column("delta")):(of(i, n, "kl_noise_floor")) \
         with lines lw 1 dt 2 lc rgb colour(i) notitle, \
       for [i=1:count] measured using (beside(i)):(of(i, n, "kl_divergence") - error(0)): \
         (0):(2*error(0)) with vectors nohead lw 1.2 lc rgb colour(i) notitle, \
       for [i=1:count] measured using (beside(i)):(of(i, n, "kl_divergence")) \
         with points pt 7 ps 0.45 lc rgb colour(i) notitle, \
       for [i=1:count] NaN with points pt 7 ps 0.8 lc rgb colour(i) title "ε = ".word(energies, i)
}
unset multiplot

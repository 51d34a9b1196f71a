# The mean time until ball and piston meet, times delta^2: points with standard errors, and the exact
# value as a line. `files` is a list of CSV files, which `ballpiston run --save` wrote.
set terminal svg size 720,480 background "white"
set datafile separator ","
set datafile columnheaders
set logscale x
set xlabel "penetration {/Symbol d}"
set ylabel "mean hit time x {/Symbol d}^2"
set key outside right
is_time(x) = stringcolumn("name") eq "mean_hit_time" ? x : NaN
d2(x) = column("delta")**2
plot for [i=1:words(files)] word(files, i) \
       using "delta":(is_time(column("value")*d2(0))):(column("standard_error")*d2(0)) \
       with yerrorbars lt i pt 7 title word(files, i), \
     for [i=1:words(files)] word(files, i) \
       using "delta":(is_time(column("exact")*d2(0))) with lines lt i notitle

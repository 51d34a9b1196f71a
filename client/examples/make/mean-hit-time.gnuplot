# The mean time until ball and piston meet, times delta^2: points with standard errors, and the exact
# value as a line. `files` is a list of CSV files, which `ballpiston run --save` wrote.
set encoding utf8
set terminal svg size 720,480 background "white"
set datafile separator ","
set datafile columnheaders
set datafile missing NaN  # so that lines connect the rows that are left
set logscale x
set xrange [0.018:0.11]
set xtics (0.02, 0.03, 0.05, 0.07, 0.1)
set xlabel "penetration δ"
set ylabel "mean hit time, times δ^2"
set key top left
name(file) = "ρ = ".file[strstrt(file, "rho-") + 4 : strlen(file) - 4]
is_time(x) = stringcolumn("name") eq "mean_hit_time" ? x : NaN
d2(x) = column("delta")**2
plot for [i=1:words(files)] word(files, i) \
       using "delta":(is_time(column("value")*d2(0))):(column("standard_error")*d2(0)) \
       with yerrorbars lt i pt 7 title name(word(files, i)), \
     for [i=1:words(files)] word(files, i) \
       using "delta":(is_time(column("exact")*d2(0))) with lines lt i notitle

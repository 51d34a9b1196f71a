# Draws orbit.svg. Change it as you like; run it with: gnuplot orbit.gnuplot
#
# One orbit of ball and piston. Above left, the ball's path in its cell, coloured by its energy;
# the piston reaches the shaded part. Above right, the energies, which change only where ball and
# piston collide (circles). Below, the positions of both along the piston's axis.
# orbit.sh lists the commands that write the data.

# ---- Settings ----
load "style.gnuplot"
set terminal svg size 960,900 enhanced font font background rgb "white"
set output "orbit.svg"
ball = "orbit-ball.csv"
piston = "orbit-piston.csv"
ball_colour = red
piston_colour = blue
reach_colour = "#e3ecfb"
disc_colour = "#dcdcdc"
shown_time = 25     # of the path and the positions; longer curves would be too dense

# ---- The data ----
stats "orbit-geometry.csv" using (rho = column("rho"), delta = column("delta"), \
                                  lambda = column("lambda"), tip = column("tip"), 1) nooutput
stats ball using (column("time")) name "last_ball" nooutput
stats piston using (column("time")) name "last_piston" nooutput
end = last_ball_max < last_piston_max ? last_ball_max : last_piston_max
part = end < shown_time ? end : shown_time
early(x) = column("time") <= part ? x : NaN
low = tip - delta
high = 1 - low
met(x) = strcol("event") eq "ball_piston" ? x : NaN

set multiplot
unset key
set palette defined (0 "#2b3a9e", 0.25 "#6a8cf0", 0.5 "#c4243a", 0.8 "#f28a1c", 1 "#f5d000")

# ---- The path in the cell ----
corner = acos(0.5/rho)
steps = 60
set print $cell
print "x,y"
do for [k=0:3] {
  do for [n=0:steps] {
    angle = pi/2*(k + 1) - corner - (pi/2 - 2*corner)*n/steps
    print sprintf("%.6f,%.6f", (k == 0 || k == 3 ? -0.5 : 0.5) + rho*cos(angle), \
                  (k < 2 ? -0.5 : 0.5) + rho*sin(angle))
  }
}
set print
half(x) = 0.5 - sqrt(rho**2 - (0.5 - abs(x))**2)
wide = 1.04*tip
set lmargin screen 0.02
set rmargin screen 0.485
set tmargin screen 0.985
set bmargin screen 0.49
set xrange [-wide:wide]
set yrange [-wide:wide]
set size ratio -1
set object 1 rectangle from graph 0,0 to graph 1,1 behind fillcolor rgb disc_colour \
  fillstyle solid noborder
unset tics
unset border
set cbrange [0:0.5]
set cbtics 0.1 font ",14"
set colorbox horizontal user origin screen 0.335,0.535 size screen 0.13,0.016
set label 1 "ball's energy" at screen 0.4,0.565 center font ",14"
set samples 200
plot $cell with filledcurves closed fillcolor rgb "white", \
     [low:tip] "+" using 1:(-half($1)):(half($1)) with filledcurves fillcolor rgb reach_colour, \
     ball using (early(column("x"))):"y":"energy" with lines lw 1.2 lc palette, \
     ball using (early(met(column("x")))):"y" with points pt 6 ps 0.7 lw 1.5 lc rgb black, \
     $cell with lines lw 2 lc rgb black
unset object 1
unset label 1

# ---- Energies ----
set size noratio
set border 31 lw 1.2
set lmargin screen 0.585
set rmargin screen 0.975
set tmargin screen 0.955
set bmargin screen 0.585
set xrange [0:end]
set yrange [0:0.5]
set xtics autofreq nomirror
set ytics 0.1 nomirror
set xlabel "time" offset 0,0.4
set ylabel "energy" offset 0.5,0
set label 1 "ball" at graph 0.02,1.04 left tc rgb ball_colour
set label 2 "piston" at graph 0.14,1.04 left tc rgb piston_colour
plot ball using "time":"energy" with steps lw 1.6 lc rgb ball_colour, \
     piston using "time":"energy" with steps lw 1.6 lc rgb piston_colour, \
     ball using (met(column("time"))):"energy" with points pt 7 ps 0.45 lc rgb ball_colour, \
     piston using (met(column("time"))):"energy" with points pt 7 ps 0.45 lc rgb piston_colour

# ---- Positions ----
set lmargin screen 0.095
set rmargin screen 0.975
set tmargin screen 0.44
set bmargin screen 0.085
set xrange [0:part]
set yrange [-tip:high]
set ytics 0.2 nomirror
set ylabel "position" offset 1,0
set label 1 "ball, q₁" at graph 0.01,1.05 left tc rgb ball_colour
set label 2 "piston, q₃" at graph 0.13,1.05 left tc rgb piston_colour
set object 1 rectangle from graph 0,first low to graph 1,first tip behind \
  fillcolor rgb reach_colour fillstyle solid noborder
plot ball using "time":"x" with lines lw 1.4 lc rgb ball_colour, \
     piston using "time":"x" with lines lw 1.4 lc rgb piston_colour, \
     ball using (met(column("time"))):"x" with points pt 6 ps 0.8 lw 1.5 lc rgb black
unset multiplot

# Draws cell.svg. Change it as you like; run it with: gnuplot cell.gnuplot
#
# The minimal ball-piston model. The ball moves in the cell between four discs of radius rho at the
# corners of the unit square. The piston, a vertical segment of height eta, moves in the piston
# cell, which is lambda + 2 delta long. lambda, with tan(theta) = lambda, is the length of the
# overlap of two opposite discs. Arrows are proportional to the velocities.
# cell.sh lists the commands that write the data.

# ---- Settings ----
load "style.gnuplot"
start = "cell.csv"
disc_colour = "#dcdcdc"
overlap_colour = "#c8c8c8"
piston_cell_colour = "#e3ecfb"
edge_colour = "#8c8c8c"
arrow = 0.2       # length for a velocity of 1, in cells
away = 0.045      # distance of a dimension line from the measured length
left = -0.64      # the drawn part of the plane
right = 1.22
bottom = -0.66
top = 0.64
width = 960

# ---- The data ----
stats start using (rho = column("rho"), delta = column("delta"), lambda = column("lambda"), \
                   eta = column("eta"), ball_x = column("ball_x"), ball_y = column("ball_y"), \
                   ball_vx = column("ball_vx"), ball_vy = column("ball_vy"), \
                   piston_x = column("piston_x"), piston_vx = column("piston_vx"), 1) nooutput
tip = 0.5 - lambda/2            # the overlap's left end; its right end is at 1 - tip
first = tip - delta             # the piston's leftmost position
theta = atan(lambda)

set terminal svg size width,(width*(top - bottom)/(right - left)) enhanced font font \
  background rgb "white"
set output "cell.svg"
unset key
unset border
unset tics
unset grid
set size ratio -1
set margins 0,0,0,0
set xrange [left:right]
set yrange [bottom:top]

# ---- The discs, their overlap behind the piston, and the cell's outline ----
x(k) = k % 2 == 0 ? -0.5 : 0.5   # the centre of disc k
y(k) = k < 2 ? -0.5 : 0.5
do for [k=0:3] {
  set object circle at x(k),y(k) size rho behind fillcolor rgb disc_colour fillstyle solid noborder
}
steps = 60
arc(k, angle) = sprintf("%.6f,%.6f", x(k) + rho*cos(angle), y(k) + rho*sin(angle))
set print $circles
print "x,y"
do for [k=0:3] {
  do for [n=0:2*steps] { print arc(k, pi*n/steps) }
  print ""
}
set print $overlap
print "x,y"
do for [n=0:steps] { print arc(1, pi/2 + theta - 2*theta*n/steps) }
do for [n=0:steps] { print arc(3, -pi/2 + theta - 2*theta*n/steps) }
set print $cell                # the ball's cell, from its left tip counterclockwise
print "x,y"
corner = pi/2 - 2*theta        # the angle of each arc
do for [n=0:steps] { print arc(0, pi/2 - theta - corner*n/steps) }
do for [n=0:steps] { print arc(1, pi - theta - corner*n/steps) }
do for [n=0:steps] { print arc(3, 3*pi/2 - theta - corner*n/steps) }
do for [n=0:steps] { print arc(2, -theta - corner*n/steps) }
set print $square
print "x,y\n-0.5,-0.5\n0.5,-0.5\n0.5,0.5\n-0.5,0.5\n-0.5,-0.5"
set print $piston_cell
print "x,y"
do for [n=0:4] {
  print sprintf("%.6f,%.6f", n % 4 == 0 || n == 3 ? first : 1 - first, n % 4 < 2 ? -eta/2 : eta/2)
}
set print

# ---- The parameters ----
set style arrow 1 heads size 0.022,18 filled front lw 1.3 lc rgb black # dimension lines
set style arrow 2 nohead front dt (5,4) lw 1 lc rgb edge_colour   # extension lines

# rho: from the centre of the lower left disc
direction = pi/4
set arrow from -0.5,-0.5 to -0.5 + rho*cos(direction),-0.5 + rho*sin(direction) arrowstyle 1
set label "ρ" at -0.5 + 0.62*rho*cos(direction),-0.5 + 0.62*rho*sin(direction) \
  left offset 0.5,-0.6

# theta: at the centre of the upper right disc
set arrow from 0.5,0.5 to tip,0 arrowstyle 2
set arrow from 0.5,0.5 to 0.5,0 arrowstyle 2
swing = 0.25
set object circle at 0.5,0.5 size swing arc [270 - theta*180/pi:270] nowedge front \
  fillstyle empty border lc rgb black lw 1.3
set label "θ" front at 0.5 - 1.16*swing*sin(theta/2),0.5 - 1.16*swing*cos(theta/2) center \
  offset 0,-0.2

# lambda: below the piston cell, between the tips
below = -eta/2 - 1.6*away
set arrow from tip,below to 1 - tip,below arrowstyle 1
set arrow from tip,0 to tip,below - 0.02 arrowstyle 2
set arrow from 1 - tip,0 to 1 - tip,below - 0.02 arrowstyle 2
set label "λ" front at 0.5,below center offset 0,-0.9

# delta: above the piston cell, at both ends
above = eta/2 + away
do for [side in "-1 1"] {
  s = side + 0
  inner = 0.5 + s*lambda/2
  outer = inner + s*delta
  set arrow from inner,above to outer,above arrowstyle 1
  set arrow from inner,0 to inner,above + 0.02 arrowstyle 2
  set arrow from outer,eta/2 to outer,above + 0.02 arrowstyle 2
  set label "δ" front at (inner + outer)/2,above center offset 0,0.8
}

# eta: right of the piston cell
beside = 1 - first + away
set arrow from beside,-eta/2 to beside,eta/2 arrowstyle 1
set arrow from 1 - first,-eta/2 to beside + 0.02,-eta/2 arrowstyle 2
set arrow from 1 - first,eta/2 to beside + 0.02,eta/2 arrowstyle 2
set label "η" at beside,0 left offset 0.7,0

# The unit square
set arrow from -0.5,-0.555 to 0.5,-0.555 arrowstyle 1
set arrow from -0.5,-0.5 to -0.5,-0.575 arrowstyle 2
set arrow from 0.5,-0.5 to 0.5,-0.575 arrowstyle 2
set label "1" at 0,-0.555 center offset 0,-0.9

set label sprintf("ρ = %.6g     λ = tan θ = %.4g     δ = %.4g     η = %.4g", \
                  rho, lambda, delta, eta) at -0.5,0.575 left font ",15"

plot $circles with lines lw 0.7 lc rgb edge_colour, \
     $overlap with filledcurves closed fillcolor rgb overlap_colour, \
     $cell with filledcurves closed fillcolor rgb "white", \
     $piston_cell with filledcurves closed fillcolor rgb piston_cell_colour, \
     $piston_cell with lines lw 1 lc rgb edge_colour, \
     $overlap with lines lw 0.7 dt (4,3) lc rgb edge_colour, \
     $square with lines lw 1 dt (8,5) lc rgb edge_colour, \
     $cell with lines lw 2.2 lc rgb black, \
     start using "piston_x":(-eta/2):(0):(eta) with vectors nohead lw 5 lc rgb blue, \
     start using "piston_x":(0):(arrow*column("piston_vx")):(0) \
       with vectors head filled size 0.03,20 lw 2.2 lc rgb blue, \
     start using "ball_x":"ball_y":(arrow*column("ball_vx")):(arrow*column("ball_vy")) \
       with vectors head filled size 0.03,20 lw 2.2 lc rgb red, \
     start using "ball_x":"ball_y" with points pt 7 ps 1.2 lc rgb red

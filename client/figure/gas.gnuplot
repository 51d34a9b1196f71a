# Draws gas.svg. Change it as you like; run it with: gnuplot gas.gnuplot
#
# A configuration of the periodic gas of balls and pistons. Each ball moves in its cell between four
# discs. Each piston, a segment, moves through the overlap of two discs from one cell into the next.
# An arrow is proportional to the velocity; its colour shows the kinetic energy. The pistons of the
# first column and row are drawn again at the last column and row.
# gas.sh lists the commands that write the data.

# ---- Settings ----
load "style.gnuplot"
balls = "gas-balls.csv"
pistons = "gas-pistons.csv"
geometry = "gas-geometry.csv"
width = 960              # of the picture
arrow = 0.13             # length for a thermal velocity, sqrt(T), in cells
brightest = 4            # the colour is the same for all higher energies, in units of T
disc_colour = "#dcdcdc"
piston_cell_colour = "#efefef"
cell_colour = "#ffffff"
edge_colour = "#8c8c8c"
margin = 0.22            # of discs around the gas, in cells

# ---- The data ----
stats geometry using (rho = column("rho"), delta = column("delta"), lambda = column("lambda"), \
                      eta = column("eta"), temperature = column("temperature"), \
                      columns = column("columns"), rows = column("rows"), 1) nooutput
wide = columns + 2*margin
high = rows + 2*margin

left = 0.012
right = 0.885
legend = 0.915
height = 0.976*(right - left)*width*high/wide
height = height < 260 ? 260 : height
set terminal svg size width,(height/0.976) enhanced \
  font font background rgb "white"
set output "gas.svg"

unset key
unset border
unset tics
set size ratio -1
set xrange [-0.5 - margin:columns - 0.5 + margin]
set yrange [-0.5 - margin:rows - 0.5 + margin]
set lmargin screen left
set rmargin screen right
set bmargin screen 0.012
set tmargin screen 0.988

set palette defined (0 "#2b3a9e", 0.25 "#6a8cf0", 0.5 "#c4243a", 0.8 "#f28a1c", 1 "#f5d000")
set cbrange [0:brightest]
set cbtics 1
set colorbox user origin screen legend,0.15 size screen 0.02,0.62
set label "energy/T" at screen legend,0.84 left

# ---- The outlines of the balls' cells; the discs cover the rest of the plane ----
set angles degrees
set object rectangle from graph 0,0 to graph 1,1 behind fillcolor rgb disc_colour \
  fillstyle solid noborder
corner = acos(0.5/rho)  # of a disc: from the direction of its neighbour to the cell's tip
steps = 24
set print $cells
print "x,y"
do for [i=0:columns-1] {
  do for [j=0:rows-1] {
    do for [k=0:3] {  # the disc at the lower left, then counterclockwise
      do for [n=0:steps] {
        angle = 90*(k + 1) - corner - (90 - 2*corner)*n/steps
        print sprintf("%.6f,%.6f", i + (k == 0 || k == 3 ? -0.5 : 0.5) + rho*cos(angle), \
                      j + (k < 2 ? -0.5 : 0.5) + rho*sin(angle))
      }
    }
    print ""
  }
}
set print

# Each piston of the first column or row is also drawn at the opposite end of the periodic gas.
is_vertical(_) = strcol("vertical") eq "true"
reach = lambda/2 + delta
across(a, b) = is_vertical(0) ? a : b
half = eta/2
shift_x(copy) = is_vertical(0) && column("x") < 0 ? copy*columns : 0
shift_y(copy) = !is_vertical(0) && column("y") < 0 ? copy*rows : 0
x(copy) = column("x") + shift_x(copy)
y(copy) = column("y") + shift_y(copy)
cell_x(copy) = is_vertical(0) ? nearest(x(copy)) : x(copy)
cell_y(copy) = is_vertical(0) ? y(copy) : nearest(y(copy))
nearest(x) = floor(x) + 0.5  # edge of a cell; a piston is less than half a cell away from its edge
energy(_) = column("energy")/temperature
scale = arrow/sqrt(temperature)

plot for [copy=0:1] pistons using (cell_x(copy)):(cell_y(copy)): \
       (across(reach, half)):(across(half, reach)) \
       with boxxyerror lw 1 fillstyle solid border lc rgb edge_colour \
       fillcolor rgb piston_cell_colour, \
     $cells using "x":"y" with filledcurves closed fillcolor rgb cell_colour, \
     $cells using "x":"y" with lines lw 1.2 lc rgb edge_colour, \
     for [copy=0:1] pistons using (cell_x(copy)):(cell_y(copy)): \
       (across(reach, half)):(across(half, reach)) \
       with boxxyerror lw 0.7 dt (4,4) lc rgb edge_colour fillstyle empty border lc rgb edge_colour, \
     for [copy=0:1] pistons using (x(copy) - across(0, half)):(y(copy) - across(half, 0)): \
       (across(0, eta)):(across(eta, 0)):(energy(0)) with vectors nohead lw 4 lc palette, \
     for [copy=0:1] pistons using (x(copy)):(y(copy)):(scale*column("vx")):(scale*column("vy")): \
       (energy(0)) with vectors head filled size 0.06,22 lw 1.8 lc palette, \
     balls using "x":"y":(scale*column("vx")):(scale*column("vy")):(energy(0)) \
       with vectors head filled size 0.07,22 lw 2.2 lc palette, \
     balls using "x":"y":(energy(0)) with points pt 7 ps 0.9 lc palette

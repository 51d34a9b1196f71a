# Draws cell-3d.svg. Change it as you like; run it with: gnuplot cell-3d.gnuplot
#
# The ball at (q1, q2) and the piston at q3 are one point of a three-dimensional billiard, seen here
# from below. Its vertical walls stand on the arcs of the ball's cell; its floor and ceiling are the
# piston's walls. The ball is left of the piston. Therefore the slanted plane q1 = q3, the collision
# surface, cuts off the lower end of the right tip.
# cell-3d.sh lists the commands that write the data.

# ---- Settings ----
load "style.gnuplot"
set terminal svg size 960,800 enhanced font font background rgb "white"
set output "cell-3d.svg"
wall_colour = 0xc3cfe6
floor_colour = 0xf4f4f4
surface_colour = 0xc40a2e
rim_colour = "#404040"
highest = 1.1  # largest height of the drawing, in units of its width
lowest = 0.6   # smallest height
steps = 48    # per arc
slices = 1     # per wall, in height; they make the depth order right

# ---- The data ----
stats "cell-3d.csv" using (rho = column("rho"), delta = column("delta"), \
                           lambda = column("lambda"), eta = column("eta"), 1) nooutput
tip = 0.5 - lambda/2
low = tip - delta
high = 1 - low
theta = atan(lambda)
corner = pi/2 - 2*theta

# If a cell is much higher or lower than wide, its heights are scaled.
ratio = (high - low)/(2*tip)
stretch = ratio > highest ? highest/ratio : ratio < lowest ? lowest/ratio : 1
drawn(z) = low + stretch*(z - low)
ceiling = drawn(high)

# The wall's outline at the fraction t of arc k. The arcs start at the left tip, counterclockwise.
centre_x(k) = k == 0 || k == 3 ? -0.5 : 0.5
centre_y(k) = k < 2 ? -0.5 : 0.5
angle(k, t) = pi/2 + k*pi/2 - theta - corner*t
x(k, t) = centre_x(k) + rho*cos(angle(k, t))
y(k, t) = centre_y(k) + rho*sin(angle(k, t))
bottom(x) = x > low ? drawn(x) : low   # the wall's lower end: the floor, or the collision surface
max(a, b) = a > b ? a : b
point(x, y, z) = sprintf("%.6f,%.6f,%.6f,%d", x, y, z, shade)

set print $faces
print "x,y,z,colour"
shade = wall_colour
do for [k=0:3] {
  do for [n=0:steps-1] {
    xa = x(k, real(n)/steps); ya = y(k, real(n)/steps)
    xb = x(k, real(n + 1)/steps); yb = y(k, real(n + 1)/steps)
    do for [m=0:slices-1] {
      from = low + (ceiling - low)*m/slices
      to = low + (ceiling - low)*(m + 1)/slices
      if (to > bottom(xa) || to > bottom(xb)) {
        print point(xa, ya, max(from, bottom(xa)))
        print point(xa, ya, max(to, bottom(xa)))
        print ""
        print point(xb, yb, max(from, bottom(xb)))
        print point(xb, yb, max(to, bottom(xb)))
        print "\n"
      }
    }
  }
}
# Floor and collision surface, as strips between the lower and the upper arcs.
half(x) = 0.5 - sqrt(rho**2 - (0.5 - abs(x))**2)
do for [part in "floor surface"] {
  shade = part eq "floor" ? floor_colour : surface_colour
  start = part eq "floor" ? -tip : low
  width = part eq "floor" ? low + tip : delta
  do for [n=0:steps-1] {
    from = start + width*n/steps
    to = start + width*(n + 1)/steps
    print point(from, -half(from), bottom(from))
    print point(from, half(from), bottom(from))
    print ""
    print point(to, -half(to), bottom(to))
    print point(to, half(to), bottom(to))
    print "\n"
  }
}
set print

# The visible edges: of the floor and the collision surface, of the ceiling over the right arcs, and
# between the walls. They are drawn as arrows, because arrows are on top of the faces.
set style arrow 1 nohead front lw 1.5 lc rgb rim_colour
set style arrow 2 head filled size screen 0.015,18 front lw 1.5 lc rgb black
do for [k=0:3] {
  do for [n=0:steps-1] {
    xa = x(k, real(n)/steps); ya = y(k, real(n)/steps)
    xb = x(k, real(n + 1)/steps); yb = y(k, real(n + 1)/steps)
    set arrow from xa,ya,bottom(xa) to xb,yb,bottom(xb) arrowstyle 1
    if (k == 1 || k == 2) { set arrow from xa,ya,ceiling to xb,yb,ceiling arrowstyle 1 }
  }
  xa = x(k, 0); ya = y(k, 0)
  if (k > 0) { set arrow from xa,ya,bottom(xa) to xa,ya,ceiling arrowstyle 1 }
}
set arrow from low,-eta/2,low to low,eta/2,low arrowstyle 1

set view 118,62,1.2,1
set view equal xyz
set xyplane at low
set pm3d depthorder lighting primary 0.28 specular 0.0
unset key
unset colorbox
unset border
unset tics
unset grid
set xrange [-tip:tip]
set yrange [-tip:tip]
set zrange [low:ceiling]

# ---- Axes and labels ----
axis = 0.45*tip
ox = tip; oy = -1.9*tip; oz = low
set arrow from ox,oy,oz to ox + axis,oy,oz arrowstyle 2
set arrow from ox,oy,oz to ox,oy + axis,oz arrowstyle 2
set arrow from ox,oy,oz to ox,oy,oz + axis arrowstyle 2
set label "q₁" at ox + 1.25*axis,oy,oz center front
set label "q₂" at ox,oy + 1.25*axis,oz center front
set label "q₃" at ox,oy,oz + 1.2*axis center front
set label "wall of a disc" at x(1, 0.5),y(1, 0.5),0.55*ceiling + 0.45*low center front
set label "floor: q₃ = 1/2 - λ/2 - δ" at -tip,0,low center offset 0,-1.2 front
set label "ceiling: q₃ = 1/2 + λ/2 + δ" at tip,0,ceiling center offset 0,1 front
set label "collision surface:" at tip,0,drawn(tip) left offset 9.5,0.6 front tc rgb "#b40426"
set label "q₁ = q₃" at tip,0,drawn(tip) left offset 9.5,-0.8 front tc rgb "#b40426"
if (stretch != 1) { set label sprintf("heights drawn × %.2g", stretch) at screen 0.97,0.03 right }

splot $faces using 1:2:3:4 with pm3d fillcolor rgb variable

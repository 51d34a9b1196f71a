# Draws collision-surface.svg. Change it as you like; run it with: gnuplot collision-surface.gnuplot
#
# Velocities (v1, v2, v3) of ball and piston are points of the unit sphere. The outgoing velocities
# of the collision surface, with normal n = (-1, 0, 1)/sqrt 2, are the hemisphere above its tangent
# plane. At the piston's energy epsilon the velocities lie on two circles, v3 = sigma sqrt(2
# epsilon). The parts above the plane (green) contribute to the rate of collisions, the other parts
# (pale) do not. collision-surface.sh contains the command that writes the energy.

# ---- Settings ----
load "style.gnuplot"
set terminal svg size 960,800 enhanced font font background rgb "white"
set output "collision-surface.svg"
plane_colour = "#c9d3ea"
hemisphere_colour = "#b4b4b4"
included_colour = green
excluded_colour = "#c8c8c8"
steps = 180
meridians = 12
parallels = 5

stats "collision-surface.csv" using (epsilon = column("epsilon"), 1) nooutput
rim = sqrt(1 - 2*epsilon)
level(sigma) = sigma*sqrt(2*epsilon)

# ---- The sphere in the frame of the plane: n, t = (1, 0, 1)/sqrt 2, and v2 ----
r2 = sqrt(2)
x(n, t) = (t - n)/r2
z(n, t) = (t + n)/r2
set print $net
print "x,y,z"
at(n, t, v2) = sprintf("%.5f,%.5f,%.5f", x(n, t), v2, z(n, t))
do for [k=0:meridians-1] {     # from the plane to the pole n
  phi = 2*pi*k/meridians
  do for [i=0:steps/4] {
    a = pi/2*i/(steps/4)
    print at(sin(a), cos(a)*cos(phi), cos(a)*sin(phi))
  }
  print ""
}
do for [k=0:parallels] {
  a = pi/2*k/(parallels + 1)
  do for [i=0:steps] {
    phi = 2*pi*i/steps
    print at(sin(a), cos(a)*cos(phi), cos(a)*sin(phi))
  }
  print ""
}
set print $plane
print "x,y,z"
do for [k=0:1] {
  do for [i=0:steps] {
    phi = 2*pi*i/steps
    print at(0, k*cos(phi), k*sin(phi))
  }
  print ""
}
set print $circles
print "x,y,z,included"
do for [sigma in "-1 1"] {
  h = level(sigma + 0)
  do for [included=0:1] {
    do for [i=0:2*steps] {
      alpha = pi*i/steps
      if ((h - rim*cos(alpha) >= 0) == included) {
        print sprintf("%.5f,%.5f,%.5f,%d", rim*cos(alpha), rim*sin(alpha), h, included)
      } else {
        print ""
      }
    }
    print ""
  }
}
set print

unset key
unset colorbox
unset border
unset tics
unset grid
set view 68,40,1.62,1
set view equal xyz
set xrange [-1:1]
set yrange [-1:1]
set zrange [-1:1]
set xyplane at -1

# ---- Axes, normal and labels ----
set style arrow 1 head filled size screen 0.015,18 front lw 1.3 lc rgb black
set style arrow 2 head filled size screen 0.018,18 front lw 2.5 lc rgb blue
axis = 0.42
ox = -1.02
oy = -0.9
oz = -1.1
set arrow from ox,oy,oz to ox + axis,oy,oz arrowstyle 1
set arrow from ox,oy,oz to ox,oy + axis,oz arrowstyle 1
set arrow from ox,oy,oz to ox,oy,oz + axis arrowstyle 1
set label "v₁" at ox + 1.2*axis,oy,oz center front
set label "v₂" at ox,oy + 1.2*axis,oz center front
set label "v₃" at ox,oy,oz + 1.15*axis center front
set arrow from 0,0,0 to x(1.22, 0),0,z(1.22, 0) arrowstyle 2
set label "n" at x(1.3, 0),0,z(1.3, 0) center front tc rgb blue
end = sqrt(0.5)*rim  # the labels stand at the rightmost points of the circles
do for [sigma in "1 -1"] {
  set label sprintf("v₃ = %s√(2ε)", sigma eq "1" ? "" : "-") at end,end,level(sigma + 0) \
    left offset 1.5,0 front
}
set label sprintf("ε = %.6g", epsilon) at screen 0.03,0.95 left
set label "above the plane" at screen 0.97,0.95 right tc rgb included_colour
set label "below the plane" at screen 0.97,0.91 right tc rgb "#8c8c8c"
set label "tangent plane, normal n" at screen 0.97,0.87 right tc rgb blue

of(included) = column("included") == included ? column("z") : NaN
splot $plane using 1:2:3 with pm3d fillcolor rgb plane_colour, \
      $net using 1:2:3 with lines lw 0.8 lc rgb hemisphere_colour, \
      $circles using 1:2:(of(0)) with lines lw 4 lc rgb excluded_colour, \
      $circles using 1:2:(of(1)) with lines lw 5 lc rgb included_colour

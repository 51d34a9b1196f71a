# Draws stability.svg. Change it as you like; run it with: gnuplot stability.gnuplot
#
# Failures per 100 starts of every method (columns) in every situation (rows). Failures are escapes,
# negative times, loops, hits after which the ball still flies into the wall, missed and phantom
# hits of the piston, and pistons beyond their walls. One start can fail several times. A cell is
# empty if the method was not run in the situation.
# stability.sh lists the commands that write the data.

# ---- Settings ----
load "style.gnuplot"
set datafile separator tab
data = "stability.tsv"
engines = "'lanes' 'lanes, single' 'reference' 'reference, single' 'reference, 64 bits' \
'reference, 113 bits' 'jump process'"
naive = "'nearest root' 'nearest root, no threshold' 'approaching disc' 'unit speed assumed' \
'fixed steps of 1e-3'"
methods = engines." ".naive
row_height = 25      # in pixels
left = 415           # width of the names of the rows
top = 190            # height of the names of the columns
cell_font = ",12"
name_font = ",13"

# ---- The data ----
column_of(m) = sum [k=1:words(methods)] (word(methods, k) eq m ? k : 0)
sections = 0
section = ""
rows = 0
# Each section has a line with its name above its rows.
note(_) = (sections = sections + (strcol("section") eq section ? 0 : 1), \
           section = strcol("section"), rows = column("row"), 1)
stats data using (note(0)) nooutput
lines = rows + sections

# The lines of the rows and of the names of sections, from above.
array line[rows]
array name[rows]
array first_of[rows]   # the section's name, if the row is its first
section = ""
sections = 0
place(row) = (first_of[row] = strcol("section") eq section ? "" : strcol("section"), \
              sections = sections + (first_of[row] eq "" ? 0 : 1), section = strcol("section"), \
              line[row] = row + sections, name[row] = strcol("case"), 1)
seen = 0
stats data using (column("row") == seen ? 0 : (seen = column("row"), place(int(seen)))) nooutput

rate(_) = 100*column("failures")/column("starts")
shown_rate(x) = x == 0 ? "0" : x < 0.01 ? short(sprintf("%.0e", x)) : \
                x < 10 ? sprintf("%.2g", x) : sprintf("%.0f", x)
short(t) = t[1:2].sprintf("%d", int(t[3:*] + 0))   # 4e-4 for 4e-04
y(_) = line[int(column("row"))]
x(_) = column_of(strcol("method"))
is_zero(x) = column("failures") == 0 ? x : NaN
fails(x) = column("failures") > 0 ? x : NaN

width = 960
height = top + row_height*lines + 15
set terminal svg size width,height enhanced font font background rgb "white"
set output "stability.svg"
unset key
unset border
unset tics
unset grid
unset colorbox
set lmargin screen real(left)/width
set rmargin screen 0.945
set tmargin screen 1 - real(top)/height
set bmargin screen 15.0/height
set xrange [0.5:words(methods) + 0.5]
set yrange [lines + 0.5:0.5]
set logscale cb
set cbrange [1e-4:100]
set palette defined (0 "#fdf0d5", 0.35 "#fdbf6f", 0.7 "#e8603c", 1 "#b40426")
zero_colour = "#d9efe6"

do for [k=1:words(methods)] {
  set label word(methods, k) at k,0.3 left rotate by 55 font name_font
}
set label "failures per 100 starts" at screen 0.01,1 - 25.0/height left
do for [r=1:rows] {
  set label name[r] at 0.4,line[r] right font name_font
  if (first_of[r] ne "") {
    set label "{/:Bold ".first_of[r]."}" at 0.4,line[r] - 1 right font name_font
  }
}
border_at = words(engines) + 0.5
set arrow from border_at,0.5 to border_at,lines + 0.5 nohead lw 2 lc rgb black front

plot data using (x(0)):(is_zero(y(0))):(0.46):(0.42) with boxxyerror fillstyle solid noborder \
       fillcolor rgb zero_colour, \
     data using (x(0)):(fails(y(0))):(0.46):(0.42):(rate(0)) with boxxyerror \
       fillstyle solid noborder lc palette, \
     data using (x(0)):(y(0)):(shown_rate(rate(0))):(rate(0) > 2 ? 0xffffff : 0x202020) \
       with labels center font cell_font tc rgb variable

# Settings that all pictures share; each picture's script loads this file: load "style.gnuplot"
set encoding utf8
set datafile separator comma
set datafile columnheaders
font = "Helvetica,Arial,sans-serif,18"

# Colours that are dark enough on white and that colour-blind readers can distinguish.
blue = "#3b4cc0"
green = "#1b9e77"
orange = "#d95f02"
red = "#b40426"
purple = "#7570b3"
olive = "#66a61e"
grey = "#808080"
black = "#202020"
grid_colour = "#e6e6e6"
colours = blue." ".green." ".orange." ".red." ".purple." ".olive." ".black." ".grey
colour(i) = word(colours, (i - 1) % words(colours) + 1)

set border lw 1.2
set grid xtics ytics lc rgb grid_colour lw 1 lt 1

# Ball and piston as one billiard in three dimensions (a figure of the paper)
#
# Run by `ballpiston figure cell-3d --out DIR`, whose flags replace these values, or by hand:
# sh cell-3d.sh
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"  # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=0.15}"

into cell-3d.csv ballpiston analytic --rho "$rho" --delta "$delta" --format csv

draw cell-3d

# The velocities with which ball and piston leave a collision, at one energy (a figure of the paper)
#
# Run by `ballpiston figure collision-surface --out DIR`, whose flags replace these values, or by
# hand: sh collision-surface.sh.
set -eu
. ./figure.sh
: "${epsilon:=0.125}"  # the piston's energy; below 1/4 two circles contribute, above 1/4 one circle
# The picture depends neither on rho nor on delta.
: "${rho:=0.529561127988977}"
: "${delta:=0.1}"

case $epsilon in
  *[,:]*)
    echo "epsilon: \"$epsilon\" is not one energy" >&2
    exit 2
    ;;
esac
into collision-surface.csv ballpiston analytic --rho "$rho" --delta "$delta" --epsilon "$epsilon" \
  --format csv

draw collision-surface

# One orbit of ball and piston: the path in the cell, positions and energies against time
#
# Run by `ballpiston figure orbit --out DIR`, whose flags replace these values, or by hand:
# sh orbit.sh
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"  # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=0.3}"              # large, so that ball and piston collide often
: "${seed:=0}"
: "${events:=200}"             # of the orbit

into orbit.jsonl ballpiston trace --rho "$rho" --delta "$delta" --seed "$seed" --events "$events"

# The first line contains the geometry and the start; every other line is an event.
number() { sed -n '1s/.*"'"$1"'":\([^,}]*\).*/\1/p' orbit.jsonl; }
geometry() {
  echo "rho,delta,lambda,tip"
  echo "$(number rho),$(number delta),$(number lambda),$(number tip)"
}
# The start and all events of one body, ball or piston.
body() {
  echo "time,event,x,y,energy"
  sed -n '1{s/.*"'"$1"'s":\[{\([^]]*\)}\].*/\1/
            s/"x":\([^,]*\),"y":\([^,]*\),.*"energy":\([^,]*\).*/0,start,\1,\2,\3/p;}
    s/"'"$1"'_\([a-z]*\)":/"\1":/g
    s/.*"time":\([^,]*\),"event":"\([a-z_]*\)".*"x":\([^,]*\),"y":\([^,]*\),/\1,\2,\3,\4,/
    s/,"vx".*"energy":\([^,}]*\).*/,\1/p' orbit.jsonl
}
into orbit-geometry.csv geometry
into orbit-ball.csv body ball
into orbit-piston.csv body piston

draw orbit

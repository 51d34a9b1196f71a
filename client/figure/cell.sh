# The ball-piston pair and the parameters of its cell (the paper's figure of the minimal model)
#
# Run by `ballpiston figure cell --out DIR`, whose flags replace these values, or by hand:
# sh cell.sh
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"  # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=0.15}"
: "${seed:=17}"                # with this random start no arrow covers a label

into cell.jsonl ballpiston trace --rho "$rho" --delta "$delta" --seed "$seed" --events 1

# The first line of the trace contains the geometry and the start of both bodies.
number() { sed -n '1s/.*"'"$1"'":\([^,}]*\).*/\1/p' cell.jsonl; }
body() { sed -n '1{s/.*"'"$1"'":\[{\([^]]*\)}\].*/\1/; s/"[a-z]*"://g; p;}' cell.jsonl; }
start() {
  echo "rho,delta,lambda,eta,ball_x,ball_y,ball_vx,ball_vy,ball_energy,\
piston_x,piston_y,piston_vx,piston_vy,piston_energy,vertical"
  echo "$(number rho),$(number delta),$(number lambda),$(number eta),$(body balls),$(body pistons)"
}
into cell.csv start

draw cell

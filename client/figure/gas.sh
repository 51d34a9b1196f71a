# A random configuration of the gas of balls and pistons (the paper's figure of the gas)
#
# Run by `ballpiston figure gas --out DIR`, whose flags replace these values, or by hand: sh gas.sh
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"  # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=0.15}"
: "${cells:=6x4}"              # a lattice, NxM, or a chain, N
: "${temperature:=1}"
: "${seed:=0}"

into gas.jsonl ballpiston trace --rho "$rho" --delta "$delta" --cells "$cells" \
  --temperature "$temperature" --seed "$seed" --events 1

# The first line of the trace contains all bodies. `bodies balls` prints the balls' numbers as CSV.
bodies() {
  echo "$2"
  sed -n '1{s/.*"'"$1"'":\[{\([^]]*\)}\].*/\1/; s/"[a-z]*"://g; s/},{/\n/g; p}' gas.jsonl
}
number() { sed -n '1s/.*"'"$1"'":\([^,}]*\).*/\1/p' gas.jsonl; }
geometry() {
  case $cells in
    *x*) columns=${cells%x*} rows=${cells#*x} ;;
    *) columns=$cells rows=1 ;;
  esac
  echo "rho,delta,lambda,eta,temperature,columns,rows"
  echo "$(number rho),$(number delta),$(number lambda),$(number eta),$(number temperature),$columns,$rows"
}
into gas-balls.csv bodies balls x,y,vx,vy,energy
into gas-pistons.csv bodies pistons x,y,vx,vy,energy,vertical
into gas-geometry.csv geometry

draw gas

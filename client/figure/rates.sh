# Collision rates from the probability of a collision in a short time (three equations of the paper)
#
# Run by `ballpiston figure rates --out DIR`, whose flags replace these values, or by hand:
# sh rates.sh. Time on two cores: quick 3 s, default 25 s, full 4 min.
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"             # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=0.2}"
: "${epsilon:=0.05,0.15,0.25,0.35,0.45}"  # energies of the piston, of the conditional rates
: "${seed:=0}"                            # of the first orbit; the next orbits have the next seeds
orbits=$(by_effort 5 5 20)
events=$(by_effort 40000 400000 1000000)  # of each orbit
batches=8         # of each orbit; their scatter gives the standard errors
half_width=0.02   # a conditional rate is the rate at all energies within epsilon +- half_width
energies=20       # the exact conditional rate is averaged over this number of energies
least=0.0001      # the windows' lengths, in units of the mean free time
per_decade=4
lengths=17

# Prints the interval of each epsilon: epsilon,lower,upper.
intervals() {
  ballpiston analytic --rho "$rho" --delta "$delta" --epsilon "$epsilon" --format csv \
    >".rates-list.$$"
  awk -F, -v w="$half_width" '
    NR == 1 { for (i = 1; i <= NF; i++) if ($i == "epsilon") at = i; next }
    { print $at "," ($at > w ? $at - w : 0) "," ($at + w < 0.5 ? $at + w : 0.5) }' ".rates-list.$$"
}
into rates-intervals.csv intervals

# In equilibrium u = sqrt(2 epsilon) is uniform. Therefore these energies, evenly spaced in u, have
# equal weights. `analytic` keeps their order.
list=$(awk -F, -v n="$energies" '{
    for (i = 0; i < n; i++) {
      u = sqrt(2*$2) + (i + 0.5)*(sqrt(2*$3) - sqrt(2*$2))/n
      printf "%s%.15g", separator, u*u/2
      separator = ","
    } }' rates-intervals.csv)
into rates-exact.csv ballpiston analytic --rho "$rho" --delta "$delta" --epsilon "$list" \
  --format csv

# Prints all events of the orbits.
trace() {
  orbit=0
  while [ "$orbit" -lt "$orbits" ]; do
    ballpiston trace --rho "$rho" --delta "$delta" --seed "$((seed + orbit))" --events "$events" ||
      return
    orbit=$((orbit + 1))
  done
}

# A window of length t that begins at a uniformly random time of an orbit contains an event with the
# probability P(t), the sum of min(gap, t) over the gaps between events, divided by the sum of the
# gaps. The piston's energy is constant during a gap between ball-piston events. Therefore the gaps
# of one energy give the conditional probability. The rate is P(t)/t; its standard error is the
# error of a ratio of sums over batches. All t use the same gaps: their errors are not independent.
rates() {
  echo "kind,epsilon,t,rate,standard_error,exact"
  trace | awk -v orbits="$orbits" -v events="$events" -v batches="$batches" \
    -v energies="$energies" -v least="$least" -v per_decade="$per_decade" -v lengths="$lengths" '
    # Adds a gap to the sums of its kind in this batch: the number and the sum of the gaps
    # between t(m - 1) and t(m).
    function add(k, gap,  m) {
      m = gap > least*tau[k] ? int(log(gap/(least*tau[k]))*scale) + 1 : 0
      if (m > lengths) m = lengths
      ++number[k, m]
      sum[k, m] += gap
    }
    function t(k, m) { return least*tau[k]*exp(m/scale) }
    function end_of_batch(  k, m, shorter, longer) {
      for (k = 0; k < kinds; k++) {
        shorter = longer = 0
        for (m = 0; m <= lengths; m++) longer += number[k, m]
        for (m = 0; m < lengths; m++) {
          shorter += sum[k, m]
          longer -= number[k, m]
          hit[batch, k, m] = shorter + longer*t(k, m)
          total[k, m] += hit[batch, k, m]
        }
        time[batch, k] = shorter + sum[k, lengths]
        total_time[k] += time[batch, k]
      }
      ++batch
      split("", number)
      split("", sum)
    }
    function print_rates(k,  m, b, p, difference, square) {
      if (total_time[k] == 0) return
      for (m = 0; m < lengths; m++) {
        p = total[k, m]/total_time[k]
        square = 0
        for (b = 0; b < batch; b++) {
          difference = hit[b, k, m] - p*time[b, k]
          square += difference*difference
        }
        print name[k] "," epsilon[k] "," t(k, m) "," p/t(k, m) "," \
          sqrt(square*batch/(batch - 1))/total_time[k]/t(k, m) "," 1/tau[k]
      }
    }
    BEGIN {
      scale = per_decade/log(10)
      kinds = 2
      name[0] = "all"
      name[1] = "ball_piston"
      while ((getline line <"rates-intervals.csv") > 0) {
        split(line, part, ",")
        name[kinds] = "conditional"
        epsilon[kinds] = part[1]
        lower[kinds] = part[2] + 0
        upper[kinds++] = part[3] + 0
      }
      getline line <"rates-exact.csv"
      n = split(line, part, ",")
      for (i = 1; i <= n; i++) at[part[i]] = i
      for (row = 0; (getline line <"rates-exact.csv") > 0; row++) {
        split(line, part, ",")
        rate[2 + int(row/energies)] += 1/part[at["mean_free_time_conditional"]]/energies
      }
      rate[1] = 1/part[at["tau_ball_piston"]]
      rate[0] = rate[1] + 1/part[at["tau_ball_wall"]] + 1/part[at["tau_piston_wall"]]
      for (k = 0; k < kinds; k++) tau[k] = 1/rate[k]
    }
    {
      now = substr($0, 9, index($0, ",") - 9) + 0  # {"time":...,
      if (index($0, "\"start\"")) {
        last_event = last_collision = seen = 0
        next
      }
      add(0, now - last_event)
      last_event = now
      if (index($0, "\"ball_piston\"")) {
        gap = now - last_collision
        last_collision = now
        add(1, gap)
        energy = substr($0, index($0, "\"piston_energy_before\":") + 23, 24) + 0
        for (k = 2; k < kinds; k++) if (energy >= lower[k] && energy < upper[k]) add(k, gap)
      }
      if (++seen % (events/batches) == 0) end_of_batch()
    }
    END {
      if (batch != orbits*batches) exit 1  # a trace has failed
      for (k = 0; k < kinds; k++) print_rates(k)
    }'
}
into rates.csv rates

draw rates

# Relative entropies of first hits above their noise, and whether they oscillate in log(delta)
#
# Run by `ballpiston figure markov-test --out DIR`, whose flags replace these values, or by hand:
# sh markov-test.sh. Time on two cores: quick 5 s, default 1 min, full 45 min.
set -eu
. ./figure.sh
: "${rho:=0.529561127988977}"  # the paper's value, (sqrt(33) - 2)/(5 sqrt(2))
: "${delta:=$(by_effort 0.1:0.325:16:log 0.03:0.325:44:log 0.03:0.325:44:log)}"
: "${epsilon:=0.03125,0.125,0.25,0.375,0.46875}"  # energies of the piston
: "${exponent:=0,1,5,10}"                         # n of the outgoing law h^(n)
: "${samples:=$(by_effort 30000 100000 4000000)}" # first hits of each point
: "${seed:=0}"
synthetic=$(by_effort 20 200 200)  # repetitions that calibrate a probability

ask markov-test.csv first-hit --rho "$rho" --delta "$delta" --epsilon "$epsilon" \
  --exponent "$exponent" --samples "$samples" --seed "$seed" --format csv

# The relative entropy minus its noise floor, with its standard error. If the two laws are equal,
# the standard error is the error of the floor.
excess() {
  echo "delta,epsilon,exponent,excess,standard_error"
  awk -F, -v OFS=, '
    /^#/ { next }
    $1 == "rho" { for (i = 1; i <= NF; i++) at[$i] = i; next }
    $at["name"] == "kl_divergence" { value = $at["value"]; error = $at["standard_error"] }
    $at["name"] == "kl_noise_floor" {
      if ($at["standard_error"] > error) error = $at["standard_error"]
      print $at["delta"], $at["epsilon"], $at["exponent"], value - $at["value"], error
    }' markov-test.csv
}
into markov-test-excess.csv excess

# Does the excess decay differently if the piston is slower than the ball, epsilon < 1/4? The table
# has the mean excess over the deltas of each octave below the largest delta. It also has the ratio
# to the mean of the first octave, if that mean is above 3 standard errors.
decay() {
  echo "epsilon,exponent,lower_delta,upper_delta,points,mean_excess,standard_error,ratio,\
ratio_error"
  awk -F, -v OFS=, '
    NR == 1 { next }
    {
      key = $2 OFS $3
      if (!(key in known)) { known[key] = 1; keys[series++] = key }
      delta[NR] = $1
      if ($1 > largest) largest = $1
      of[NR] = key
      excess[NR] = $4
      error[NR] = $5
    }
    END {
      for (i = 2; i <= NR; i++) {
        # With the factor a delta at the border of two octaves stays in its octave despite rounding.
        octave = int(log(largest/delta[i])/log(2)*(1 - 1e-9))
        if (octave > last) last = octave
        ++count[of[i], octave]
        sum[of[i], octave] += excess[i]
        square[of[i], octave] += error[i]^2
      }
      for (j = 0; j < series; j++) {
        for (o = 0; o <= last; o++) {
          n = count[keys[j], o]
          if (!n) continue
          mean = sum[keys[j], o]/n
          mean_error = sqrt(square[keys[j], o])/n
          if (o == 0) { first = mean; first_error = mean_error }
          ratio = ratio_error = ""
          if (o > 0 && first > 3*first_error) {
            ratio = mean/first
            ratio_error = sqrt(mean_error^2 + (ratio*first_error)^2)/first
          }
          print keys[j], largest/2^(o + 1), largest/2^o, n, mean, mean_error, ratio, ratio_error
        }
      }
    }' markov-test-excess.csv
}
into markov-test-decay.csv decay

# In which variable x does the excess E(delta) oscillate? The models are the power law
# E = A delta^b and E = A delta^b exp(c cos(omega x + phase)), with x = delta, log(delta), 1/delta.
# The exponential function equals 1 + c cos(...) for small c, keeps E positive, and makes log E
# linear in all parameters but omega. omega is scanned, for every x in the same range: from 1.5
# cycles over the data to one cycle in three points. The fit uses the points whose excess is above 3
# standard errors, without n = 1, which is the equilibrium law.
#
# None of these models is exact. Therefore every log E has, beside its statistical error, a common
# error `model_error`, which makes chi^2 of the best oscillating model equal to its degrees of
# freedom. All models have the same errors, so that their chi^2 can be compared.
#   false_alarm  probability that the scan finds as large a relative gain in chi^2 in data of the
#                plain power law
#   p_value      probability that this model, if it is true, fits worse than the best model by as
#                much as here
# Both probabilities are shares of synthetic data sets with a fixed seed: 0 means less than
# 1/synthetic.
#   transform    the p for which x = delta^-p fits best (p = 0 is the logarithm), with the range of
#                all p whose chi^2 is at most 4 larger
# In rows with the exponent "all", chi^2 is summed over the exponents.
fit() {
  echo "epsilon,exponent,points,smallest_delta,model_error,model,b,b_error,amplitude,period,\
chi_squared,degrees_of_freedom,gain,false_alarm,p_value,transform,transform_low,transform_high"
  awk -F, -v OFS=, -v synthetic="$synthetic" '
    # ---- Random numbers: Lehmer, then Box and Muller ----
    function uniform() { state = state*16807 % 2147483647; return state/2147483647 }
    function normal() { return sqrt(-2*log(uniform()))*cos(2*pi*uniform()) }

    # ---- Vectors of the whitened data: log E and the basis are divided by the errors ----
    function x_of(l, p) { return p == 0 ? l : exp(-p*l) }
    # Makes v orthogonal to the power laws u0 and u1.
    function remove_power_law(v,  i, d0, d1) {
      d0 = d1 = 0
      for (i = 1; i <= n; i++) { d0 += u0[i]*v[i]; d1 += u1[i]*v[i] }
      for (i = 1; i <= n; i++) v[i] -= d0*u0[i] + d1*u1[i]
    }
    function normalise(v,  i, s) {
      s = 0
      for (i = 1; i <= n; i++) s += v[i]*v[i]
      s = s > 1e-20 ? 1/sqrt(s) : 0
      for (i = 1; i <= n; i++) v[i] *= s
    }
    function dot(v, w,  i, s) {
      s = 0
      for (i = 1; i <= n; i++) s += v[i]*w[i]
      return s
    }
    function whiten(s,  i, d) {
      for (i = 1; i <= n; i++) {
        weight[i] = 1/sqrt(e[i]*e[i] + s*s)
        u0[i] = weight[i]
        u1[i] = weight[i]*l[i]
        z[i] = weight[i]*y[i]
      }
      normalise(u0)
      d = dot(u0, u1)
      for (i = 1; i <= n; i++) u1[i] -= d*u0[i]
      normalise(u1)
    }
    # Stores the orthonormal vectors C and S of an oscillation for x = delta^-p and every frequency,
    # from the index `at` on.
    function oscillations(p, at,  i, m, lowest, highest, x, d) {
      lowest = highest = x_of(l[1], p)
      for (i = 1; i <= n; i++) {
        x = x_of(l[i], p)
        if (x < lowest) lowest = x
        if (x > highest) highest = x
      }
      range = highest - lowest
      for (m = 0; m < frequencies; m++) {
        omega = 2*pi*cycles(m)/range
        for (i = 1; i <= n; i++) {
          x = omega*x_of(l[i], p)
          c[i] = weight[i]*cos(x)
          s[i] = weight[i]*sin(x)
        }
        remove_power_law(c); normalise(c)
        remove_power_law(s)
        d = dot(c, s)
        for (i = 1; i <= n; i++) s[i] -= d*c[i]
        normalise(s)
        for (i = 1; i <= n; i++) { C[at] = c[i]; S[at++] = s[i] }
      }
    }
    function cycles(m) { return 1.5 + 0.15*m }
    # The largest reduction of chi^2 over all frequencies; sets best.
    function scan(v, at,  i, m, a, b, gain, largest) {
      largest = -1
      for (m = 0; m < frequencies; m++) {
        a = b = 0
        for (i = 1; i <= n; i++) { a += C[at]*v[i]; b += S[at++]*v[i] }
        gain = a*a + b*b
        if (gain > largest) { largest = gain; best = m; best_a = a; best_b = b }
      }
      return largest
    }
    function fit_all(s,  v, smallest) {
      whiten(s)
      remove_power_law(z)
      chi0 = dot(z, z)
      smallest = chi0
      for (v = 0; v < 3; v++) {
        oscillations(power[v], v*size)
        gain[v] = scan(z, v*size)
        best_of[v] = best; a_of[v] = best_a; b_of[v] = best_b
        range_of[v] = range
        if (chi0 - gain[v] < smallest) smallest = chi0 - gain[v]
      }
      return smallest
    }
    # Solves the normal equations of k columns of X for log E: sets beta and the error of b.
    function solve(k,  i, j, m, f) {
      for (i = 1; i <= k; i++) {
        for (j = 1; j <= k; j++) {
          M[i, j] = 0
          M[i, k + 1 + j] = i == j
          for (m = 1; m <= n; m++) M[i, j] += weight[m]*weight[m]*X[m, i]*X[m, j]
        }
        M[i, k + 1] = 0
        for (m = 1; m <= n; m++) M[i, k + 1] += weight[m]*weight[m]*X[m, i]*y[m]
      }
      for (i = 1; i <= k; i++) {
        f = M[i, i]
        for (j = 1; j <= 2*k + 1; j++) M[i, j] /= f
        for (m = 1; m <= k; m++) {
          if (m == i) continue
          f = M[m, i]
          for (j = 1; j <= 2*k + 1; j++) M[m, j] -= f*M[i, j]
        }
      }
      for (i = 1; i <= k; i++) beta[i] = M[i, k + 1]
      b_error = sqrt(M[2, k + 3])
    }
    # The p with the smallest chi_of, and the range of all p whose chi_of is at most 4 larger.
    function p_of(k) { return -2 + k/8 }
    function find_transform(  k, least) {
      least = 1e300
      for (k = 0; k < transforms; k++)
        if (chi_of[k] < least) { least = chi_of[k]; transform = p_of(k) }
      low = p_of(transforms)
      for (k = 0; k < transforms; k++) {
        if (chi_of[k] > least + 4) continue
        if (p_of(k) < low) low = p_of(k)
        high = p_of(k)
      }
    }
    function parameters(v,  m, omega, k) {
      k = v < 0 ? 2 : 4
      for (m = 1; m <= n; m++) {
        X[m, 1] = 1
        X[m, 2] = l[m]
        if (v < 0) continue
        omega = 2*pi*cycles(best_of[v])/range_of[v]
        X[m, 3] = cos(omega*x_of(l[m], power[v]))
        X[m, 4] = sin(omega*x_of(l[m], power[v]))
      }
      solve(k)
    }

    # ---- One series: an energy and an exponent ----
    function analyse(key,  part, i, v, r, w, smallest, lower, upper, middle, p, dof) {
      split(key, part, ",")
      n = count[key]
      if (n < 10) return
      least_delta = 1e300
      for (i = 1; i <= n; i++) {
        l[i] = log_delta[key, i]
        if (exp(l[i]) < least_delta) least_delta = exp(l[i])
        y[i] = log_excess[key, i]
        e[i] = relative_error[key, i]
      }
      frequencies = 1
      while (cycles(frequencies) < n/3) frequencies++
      size = frequencies*n
      dof = n - 5
      lower = 0
      upper = 4
      if (fit_all(0) <= dof) upper = 0
      for (i = 0; i < 12 && upper > 0; i++) {
        middle = (lower + upper)/2
        if (fit_all(middle) > dof) lower = middle; else upper = middle
      }
      error = upper
      smallest = fit_all(error)

      # The transform.
      least = 1e300
      for (k = 0; k < transforms; k++) {
        oscillations(p_of(k), 3*size)
        chi_of[k] = chi0 - scan(z, 3*size)
        sum_of[part[1], k] += chi_of[k]
      }
      find_transform()

      # The truth -1 is the power law; the other truths are the oscillating models.
      for (v = 0; v < 3; v++) alarms[v] = worse[v] = 0
      for (t = -1; t < 3; t++) {
        for (r = 0; r < synthetic; r++) {
          for (i = 1; i <= n; i++) g[i] = normal()
          if (t >= 0) {
            at0 = t*size + best_of[t]*n
            for (i = 1; i <= n; i++)
              g[i] += a_of[t]*C[at0 + i - 1] + b_of[t]*S[at0 + i - 1]
          }
          remove_power_law(g)
          chi = dot(g, g)
          most = 0
          for (v = 0; v < 3; v++) {
            gained[v] = scan(g, v*size)
            if (gained[v] > most) most = gained[v]
            if (t < 0 && gained[v]/(chi - gained[v]) >= gain[v]/(chi0 - gain[v])) alarms[v]++
          }
          if (t >= 0 && most - gained[t] >= (chi0 - gain[t]) - smallest) worse[t]++
        }
      }

      if (!(part[1] in fits)) energies[energy_count++] = part[1]
      ++fits[part[1]]
      sum_points[part[1]] += n
      for (v = -1; v < 3; v++) {
        sum_chi[part[1], v] += v < 0 ? chi0 : chi0 - gain[v]
        parameters(v)
        head = part[1] OFS part[2] OFS n OFS least_delta OFS error OFS name[v] OFS beta[2] OFS \
          b_error
        if (v < 0) print head, "", "", chi0, n - 2, "", "", "", "", "", ""
        else print head, sqrt(beta[3]^2 + beta[4]^2), range_of[v]/cycles(best_of[v]), \
          chi0 - gain[v], dof, gain[v], alarms[v]/synthetic, worse[v]/synthetic, \
          transform, low, high
      }
    }
    # The sums over the exponents of one energy, each with its own frequency and amplitude.
    function add_up(energy,  k, v) {
      for (k = 0; k < transforms; k++) chi_of[k] = sum_of[energy, k]
      find_transform()
      for (v = -1; v < 3; v++)
        print energy, "all", sum_points[energy], "", "", name[v], "", "", "", "", \
          sum_chi[energy, v], sum_points[energy] - (v < 0 ? 2 : 5)*fits[energy], \
          v < 0 ? "" : sum_chi[energy, -1] - sum_chi[energy, v], "", "", \
          v < 0 ? "" : transform, v < 0 ? "" : low, v < 0 ? "" : high
    }
    BEGIN {
      pi = atan2(0, -1)
      transforms = 41
      state = 20260101
      name[-1] = "power law"
      name[0] = "delta"; power[0] = -1
      name[1] = "log(delta)"; power[1] = 0
      name[2] = "1/delta"; power[2] = 1
    }
    NR > 1 && $3 != 1 {
      key = $2 OFS $3
      if (!(key in count)) { count[key] = 0; keys[series++] = key }
      if ($4 <= 3*$5) next
      i = ++count[key]
      log_delta[key, i] = log($1)
      log_excess[key, i] = log($4)
      relative_error[key, i] = $5/$4
    }
    END {
      for (j = 0; j < series; j++) analyse(keys[j])
      for (j = 0; j < energy_count; j++) add_up(energies[j])
    }' markov-test-excess.csv
}
into markov-test-fit.csv fit

# The maxima of the excess from the largest delta down, without a model. Their spacings in
# log(delta) or in 1/delta are constant if the oscillation is periodic in that variable. A maximum
# counts if on both sides the excess falls by 15 percent and by 3 standard errors before it is
# higher again. The position is the maximum of the parabola of log E through three points.
maxima() {
  echo "epsilon,exponent,delta,spacing_of_log_delta,spacing_of_inverse_delta"
  awk -F, -v OFS=, '
    NR > 1 && $3 != 1 {
      key = $2 OFS $3
      if (!(key in count)) { count[key] = 0; keys[series++] = key }
      i = ++count[key]
      x[key, i] = log($1)
      y[key, i] = $4
      e[key, i] = $5
    }
    function lower(key, i, j) {
      return y[key, i] < 0.85*y[key, j] && y[key, j] - y[key, i] > 3*sqrt(e[key, i]^2 + e[key, j]^2)
    }
    function report(key, i,  a, b, x0, y0, y1, y2, place) {
      y0 = y[key, i - 1]
      y1 = y[key, i]
      y2 = y[key, i + 1]
      place = x[key, i]
      if (y0 > 0 && y2 > 0) {
        a = (log(y2) - log(y1))/(x[key, i + 1] - x[key, i])
        b = (log(y1) - log(y0))/(x[key, i] - x[key, i - 1])
        x0 = (x[key, i + 1] - x[key, i - 1])/2
        if (a != b) place = (x[key, i] + x[key, i - 1])/2 - b*x0/(a - b)
      }
      delta = exp(place)
      print key, delta, last ? last_log - place : "", last ? 1/delta - 1/last : ""
      last = delta
      last_log = place
    }
    END {
      for (j = 0; j < series; j++) {
        key = keys[j]
        n = count[key]
        for (i = 2; i <= n; i++)  # in falling order of delta
          for (k = i; k > 1 && x[key, k] > x[key, k - 1]; k--) {
            t = x[key, k]; x[key, k] = x[key, k - 1]; x[key, k - 1] = t
            t = y[key, k]; y[key, k] = y[key, k - 1]; y[key, k - 1] = t
            t = e[key, k]; e[key, k] = e[key, k - 1]; e[key, k - 1] = t
          }
        last = rising = 0
        top = bottom = 1
        for (i = 2; i <= n; i++) {
          if (rising) {
            if (y[key, i] > y[key, top]) top = i
            else if (lower(key, i, top)) {
              report(key, top)
              rising = 0
              bottom = i
            }
          } else {
            if (y[key, i] < y[key, bottom]) bottom = i
            else if (lower(key, bottom, i)) {
              rising = 1
              top = i
            }
          }
        }
      }
    }' markov-test-excess.csv
}
into markov-test-maxima.csv maxima

draw markov-test

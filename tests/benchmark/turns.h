// Contenders that take turns, and whether a neighbour on the same core disturbed them.
//
// Two threads of a processor's core share its ports. A program of another user there costs code
// that keeps the ports busy much, and code that waits for results little: so it changes ratios, and
// the clock does not show it. A probe before and after each turn does: independent operations, as
// many at a time as a core can do, take longer then.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "server/processor_time.h"

namespace ballpiston {

// Processor seconds of so many steps of `kChains` chains of six operations, each of which waits for
// the one before it. The compiler may not make vectors of them.
template <size_t kChains>
double SecondsOfChains(uint64_t steps) {
  uint64_t x[kChains];
  for (size_t i = 0; i < kChains; ++i) x[i] = 0x9e3779b97f4a7c15 * (i + 1);
  const double begin = server::ThreadSeconds();
  for (uint64_t step = 0; step < steps; ++step) {
    _Pragma("GCC unroll 8") for (size_t i = 0; i < kChains; ++i) {
      x[i] += step;
      asm volatile("" : "+r"(x[i]));
      x[i] ^= step;
      asm volatile("" : "+r"(x[i]));
      x[i] -= step;
      asm volatile("" : "+r"(x[i]));
      x[i] &= ~step;
      asm volatile("" : "+r"(x[i]));
      x[i] += step;
      asm volatile("" : "+r"(x[i]));
      x[i] |= step;
      asm volatile("" : "+r"(x[i]));
    }
  }
  return server::ThreadSeconds() - begin;
}

// The clock's rate. It is measured by one chain of multiplications, which take three cycles each on
// processors of Intel and AMD.
inline double CyclesPerSecond() {
  constexpr uint64_t kSteps = 200'000;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 20; ++i) {
    uint64_t x = 3;
    const double begin = server::ThreadSeconds();
    for (uint64_t step = 0; step < kSteps; ++step) {
      x *= 0x9e3779b97f4a7c15;
      asm volatile("" : "+r"(x));
    }
    least = std::min(least, server::ThreadSeconds() - begin);
  }
  return 3 * kSteps / least;
}

// The compiler may not leave out the computation of the value.
inline void Keep(double value) { asm volatile("" : : "g"(value) : "memory"); }

struct Contender {
  std::string name;
  std::function<double(uint64_t turn)> work;  // returns how much it has done

  // How much a second of processor time would do.
  double Rate(uint64_t turn) const {
    const double begin = server::ThreadSeconds();
    const double done = work(turn);
    return done / (server::ThreadSeconds() - begin);
  }
};

// Rates of contenders that take turns.
class Turns {
 public:
  // There are at least `turns` turns, and up to three times as many: the turns go on until five for
  // each contender, on average, had no neighbour.
  Turns(const std::vector<Contender>& contenders, int turns) {
    for (int turn = 0; turn < turns || (turn < 3 * turns && !IsQuietEnough(contenders.size()));
         ++turn) {
      for (size_t i = 0; i < contenders.size(); ++i) {
        const double before = Probe();
        const double rate = contenders[i].Rate(static_cast<uint64_t>(turn));
        turns_.push_back({i, rate, std::min(before, Probe())});
      }
    }
  }

  // The contender's rates in turns without a neighbour, unless all of its turns had one; ascending.
  std::vector<double> Rates(size_t contender) const {
    std::vector<double> all, quiet;
    for (const Turn& turn : turns_) {
      if (turn.contender != contender) continue;
      all.push_back(turn.rate);
      if (!IsDisturbed(turn)) quiet.push_back(turn.rate);
    }
    std::vector<double>& rates = quiet.empty() ? all : quiet;
    std::sort(rates.begin(), rates.end());
    return rates;
  }
  double Best(size_t contender) const { return Rates(contender).back(); }
  size_t disturbed() const {
    return static_cast<size_t>(std::count_if(turns_.begin(), turns_.end(), IsDisturbed));
  }
  size_t turns() const { return turns_.size(); }

 private:
  struct Turn {
    size_t contender;
    double rate;
    double probe;
  };

  // Chains a second, of as many as keep all ports busy.
  static double Probe() {
    constexpr uint64_t kSteps = 20'000;
    const double probe = kSteps / SecondsOfChains<6>(kSteps);
    best_probe_ = std::max(best_probe_, probe);
    return probe;
  }

  // Against the best of the whole program.
  static bool IsDisturbed(const Turn& turn) { return turn.probe < 0.9 * best_probe_; }

  bool IsQuietEnough(size_t contenders) const {
    constexpr size_t kQuietTurns = 5;
    return turns() - disturbed() >= kQuietTurns * contenders;
  }

  static inline double best_probe_ = 0;

  std::vector<Turn> turns_;
};

// Prints the median of some values, and their range.
inline void ShowMedian(const char* name, std::vector<double> values, const char* unit) {
  std::sort(values.begin(), values.end());
  std::printf("   %s %.4g (%.4g to %.4g)%s", name, values[values.size() / 2], values.front(),
              values.back(), unit);
}

// Prints, at the end of a line, in how many turns there was a neighbour.
inline void ShowDisturbance(const Turns& turns) {
  if (turns.disturbed() == 0) return;
  std::printf("  [a neighbour in %zu of %zu turns]", turns.disturbed(), turns.turns());
}

// A line for each contender: its best rate, the time and the cycles of one thing, and, with a text
// for it, the rate over that of the first.
inline void ShowRates(const std::vector<Contender>& contenders, int least_turns,
                      const char* over_the_first) {
  const Turns turns(contenders, least_turns);
  const double cycles = CyclesPerSecond();
  for (size_t i = 0; i < contenders.size(); ++i) {
    const double rate = turns.Best(i);
    std::printf("%-42s %9.2f million/s   %8.2f ns   %8.2f cycles", contenders[i].name.c_str(),
                rate * 1e-6, 1e9 / rate, cycles / rate);
    if (*over_the_first != 0) std::printf("   %6.3g%s", rate / turns.Best(0), over_the_first);
    ShowDisturbance(turns);
    std::printf("\n");
  }
}

}  // namespace ballpiston

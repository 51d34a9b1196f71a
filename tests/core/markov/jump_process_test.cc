#include "core/markov/jump_process.h"

#include "core/closed_form/kernel.h"
#include "tests/core/billiard/each_target.h"
#include "tests/core/preamble.h"
#include "tests/oracle/gauss_legendre.h"
#include "tools/flows/quad_precision.h"

namespace ballpiston {
namespace {

// From 0 to the total energy, through 1/sqrt 2, where the two parts of the law separate.
std::vector<double> Energies() {
  std::vector<double> us = {0, std::numeric_limits<double>::denorm_min(), 1e-300, 1e-160, 1e-30};
  for (int k = 1; k <= 16; ++k) {
    const double small = std::pow(10.0, -k);
    for (const double u : {small, M_SQRT1_2 - small, M_SQRT1_2 + small, 1 - small}) {
      if (u >= 0 && u <= 1) us.push_back(u);
    }
  }
  for (int k = 1; k < 64; ++k) us.push_back(k / 64.0);
  for (const double u : {M_SQRT1_2, std::nextafter(1.0, 0.0), 1.0}) us.push_back(u);
  return us;
}

// In (0, 1), with the least and the greatest that CounterRandom gives.
std::vector<double> UniformNumbers() {
  std::vector<double> vs = {0x1p-53, 0x1.8p-52, 1 - 0x1p-53, 1 - 0x1.8p-52};
  for (int k = 1; k <= 15; ++k) {
    vs.push_back(std::pow(10.0, -k));
    vs.push_back(1 - std::pow(10.0, -k));
  }
  for (int k = 1; k < 64; ++k) vs.push_back(k / 64.0);
  return vs;
}

// The distribution function of u' after a jump from u, as in the header, with 113 bits.
class ExactLaw {
 public:
  explicit ExactLaw(double u) : u_(u), s2_(1 - u_ * u_), s_(sqrt(s2_)) {
    const Quad q2 = 1 - 2 * u_ * u_;
    c_ = q2 > 0 ? sqrt(q2) + u_ * asin(u_ / s_) : u_ * QuadPi() / 2;
  }
  Quad Below(Quad next) const {
    if (next >= s_) return 1;
    if (next <= u_) return u_ * asin(next / s_) / c_;
    return 1 - sqrt(s2_ - next * next) / c_;
  }
  Quad rate() const { return c_ / (sqrt(Quad{2}) * QuadPi()); }

 private:
  Quad u_, s2_, s_, c_;
};

// v lies between the probabilities of the two values that are a relative kJumpError below and above
// `next`. Below (u/s)/c times 1e-290 the quantile is not a normal number.
void ExpectQuantile(double u, double v, double next) {
  SCOPED_TRACE(testing::Message() << "u " << u << " v " << v << " u' " << next);
  EXPECT_TRUE(next >= 0 && next <= 1);
  const ExactLaw law(u);
  const Quad error = kJumpError;
  EXPECT_TRUE(u == 1 ? next == 0 : law.Below(Quad{next} * (1 - error)) <= v);
  EXPECT_TRUE(law.Below(Quad{next} * (1 + error)) >= v);
}

void ExpectWaitingTime(double u, double v, double time) {
  ASSERT_TRUE(time > 0 && std::isfinite(time));
  EXPECT_LE(RelativeError(time, -Quad{std::log(v)} / ExactLaw(u).rate()), kJumpError)
      << "u " << u << " v " << v;
}

// CounterRandom's uniform number, and a word that gives it.
double UniformOf(uint64_t word) { return (static_cast<double>(word >> 12) + 0.5) * 0x1p-52; }
uint64_t WordOf(double v) { return static_cast<uint64_t>(v * 0x1p52) << 12; }

struct Group {
  uint64_t waiting_words[kJumpGroup];
  uint64_t target_words[kJumpGroup];
  double u[kJumpGroup];
  double waiting_times[kJumpGroup];

  void Jump() { JumpInLanes(waiting_words, target_words, u, waiting_times); }
};

// Jumps from every energy with every uniform number, in lanes of every kind.
void ForEachJump(
    const std::function<void(const Group& before, const Group& after, size_t lane)>& expect) {
  const std::vector<double> us = Energies(), vs = UniformNumbers();
  ForEachTarget([&](int64_t) {
    for (size_t j = 0; j < vs.size(); ++j) {
      for (size_t begin = 0; begin < us.size(); begin += kJumpGroup) {
        Group before = {};
        for (size_t i = 0; i < kJumpGroup; ++i) {
          before.u[i] = us[(begin + i) % us.size()];
          before.target_words[i] = WordOf(vs[j]);
          before.waiting_words[i] = WordOf(vs[(j + i) % vs.size()]);
        }
        Group after = before;
        after.Jump();
        for (size_t i = 0; i < kJumpGroup; ++i) expect(before, after, i);
      }
    }
  });
}

TEST(JumpProcess, InvertsTheDistributionOfW) {
  ForEachJump([](const Group& before, const Group& after, size_t i) {
    ExpectQuantile(before.u[i], UniformOf(before.target_words[i]), after.u[i]);
  });
}

TEST(JumpProcess, WaitsWithTheRateOfCollisions) {
  ForEachJump([](const Group& before, const Group& after, size_t i) {
    ExpectWaitingTime(before.u[i], UniformOf(before.waiting_words[i]), after.waiting_times[i]);
  });
  // The closed form's rate; u^2/2 rounds.
  for (int k = 0; k <= 64; ++k) {
    const double u = k / 64.0;
    EXPECT_NEAR(static_cast<double>(ExactLaw(u).rate()) / PairCollisionRate(u * u / 2), 1,
                kJumpError + kKernelMomentsRelativeError);
  }
}

}  // namespace
}  // namespace ballpiston

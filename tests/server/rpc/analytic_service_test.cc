#include "tests/server/preamble.h"

namespace ballpiston::server {
namespace {

class AnalyticServiceTest : public testing::Test {
 protected:
  AnalyticServiceTest() {
    request_.add_rho(kPaperRho);
    request_.add_delta(0.2);
  }

  v1::EvaluatePairsResponse Answer() const {
    return RunningServer().Answered<v1::EvaluatePairsResponse>(request_);
  }

  v1::EvaluatePairsRequest request_;
};

// No field was forgotten. A number that is 0 has no bytes.
void ExpectNoZero(const google::protobuf::Message& message) {
  std::vector<const google::protobuf::FieldDescriptor*> filled;
  message.GetReflection()->ListFields(message, &filled);
  EXPECT_EQ(std::ssize(filled), message.GetDescriptor()->field_count()) << message.DebugString();
}

TEST_F(AnalyticServiceTest, EveryPairHasItsPointRhoOutermost) {
  request_.add_rho(0.55);
  request_.add_delta(0.1);
  const auto points = Answer().points();
  ASSERT_EQ(points.size(), 4);
  EXPECT_EQ(points[1].rho(), kPaperRho);
  EXPECT_EQ(points[1].delta(), 0.1);
  EXPECT_EQ(points[2].rho(), 0.55);
}

// Temperatures follow the betas.
TEST_F(AnalyticServiceTest, ValuesAreThoseOfTheClosedForms) {
  for (const double epsilon : {0.0, 0.25, 0.5}) request_.add_epsilon(epsilon);
  request_.add_outgoing_epsilon(0.125);
  request_.add_beta(4);
  request_.add_temperature(2);
  const v1::PairAnalytics point = Answer().points(0);
  EXPECT_NEAR(point.gas_delta_bound(), 0.2, 1e-14);
  EXPECT_NEAR(point.tau_ball_piston(), 4 * point.volume() / point.area_ball_piston(),
              1e-13 * point.tau_ball_piston());
  ExpectNoZero(point);
  ASSERT_EQ(point.energies_size(), 3);
  ExpectNoZero(point.energies(1));
  EXPECT_NEAR(point.energies(0).phi(), std::sqrt(8) / M_PI, 1e-15);
  EXPECT_NEAR(point.energies(1).phi(), 1, 1e-15);
  EXPECT_NEAR(point.energies(2).phi(), std::sqrt(2), 1e-15);
  EXPECT_NEAR(point.energies(1).mean_free_time_conditional(), point.tau_ball_piston(), 1e-12);
  ASSERT_EQ(point.energies(1).kernel_size(), 1);
  EXPECT_NEAR(point.energies(1).kernel(0), 0.5 / (2 * M_PI * std::sqrt(0.125 * 0.125)), 1e-14);
  ASSERT_EQ(point.canonical_size(), 2);
  EXPECT_EQ(point.canonical(0).temperature(), 0.25);
  EXPECT_NEAR(point.canonical(0).mean_f(), 1 / std::sqrt(8 * M_PI), 1e-15);
  EXPECT_NEAR(point.canonical(0).mean_h(), 0.125 * point.canonical(0).mean_f(), 1e-15);  // 2 T^2
  const v1::CanonicalAnalytics& canonical = point.canonical(1);
  ExpectNoZero(canonical);
  EXPECT_EQ(canonical.beta(), 0.5);
  EXPECT_EQ(canonical.temperature(), 2);
  EXPECT_NEAR(canonical.mean_f(), 1 / std::sqrt(M_PI), 1e-15);
  const double rate = canonical.mean_f() * point.area_ball_piston() / point.volume();
  EXPECT_NEAR(canonical.exchange_rate(), rate, 1e-15 * rate);
  EXPECT_EQ(canonical.static_conductivity(), canonical.exchange_rate() / 2);
  const double limit = std::sqrt(2 / M_PI) / point.cell_area();
  EXPECT_NEAR(canonical.rare_limit_exchange_rate(), limit, 1e-15 * limit);
}

TEST_F(AnalyticServiceTest, TheWholeRangeOfTemperaturesIsAnswered) {
  request_.set_delta(0, 1e-100);
  for (const double temperature : {1e-120, 1e120}) {
    request_.add_temperature(temperature);
    request_.add_beta(temperature);
  }
  const v1::PairAnalytics point = Answer().points(0);
  for (const v1::CanonicalAnalytics& row : point.canonical()) {
    for (const double value : {row.mean_f(), row.mean_h(), row.exchange_rate(),
                               row.static_conductivity(), row.rare_limit_exchange_rate()}) {
      EXPECT_TRUE(std::isnormal(value)) << row.DebugString();
    }
  }
}

}  // namespace
}  // namespace ballpiston::server

#include "client/output/analytic_output.h"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/message_text.h"

namespace ballpiston::client {
namespace {

constexpr char kCanonical[] =
    "canonical { beta: 2 temperature: 0.5 mean_f: 0.3 mean_energy_current: 0.04 mean_h: 0.05 "
    "exchange_rate: 0.06 static_conductivity: 0.03 rare_limit_exchange_rate: 2.7 }";

std::string PrintedPairs(Format format, const std::string& energies = R"(
      energies { epsilon: 0 phi: 0.9 f: 0.2 j: 0.07 h: 0.03 mean_free_time_conditional: 24 kernel: 0.25 }
      energies { epsilon: 0.1 phi: 0.8 f: 0.3 j: 0.06 h: 0.04 mean_free_time_conditional: 27 kernel: 0.5 })") {
  const auto response = FromText<v1::EvaluatePairsResponse>(
      "points { rho: 0.529561127988977 delta: 0.1 lambda: 0.3489125293076058 eta: 1 cell_area: 2 "
      "volume: 3 area_ball_piston: 4 area_ball_wall: 5 area_piston_wall: 6 tau_ball_piston: 7 "
      "tau_ball_wall: 8 tau_piston_wall: 9 pair_delta_bound: 0.3255 gas_delta_bound: 0.2 "
      "rare_limit_rate: 10 " +
      energies + "}");
  std::ostringstream out;
  PrintAnalytics(response, {0.2}, format, out);
  return out.str();
}

TEST(AnalyticCsv, HasTheColumnsOfPairThenEnergyThenTemperature) {
  EXPECT_EQ(
      PrintedPairs(Format::kCsv),
      R"(rho,delta,lambda,eta,cell_area,volume,area_ball_piston,area_ball_wall,area_piston_wall,tau_ball_piston,tau_ball_wall,tau_piston_wall,pair_delta_bound,gas_delta_bound,rare_limit_rate,epsilon,phi,f,j,h,mean_free_time_conditional,beta,temperature,mean_f,mean_energy_current,mean_h,exchange_rate,static_conductivity,rare_limit_exchange_rate
0.529561127988977,0.1,0.3489125293076058,1,2,3,4,5,6,7,8,9,0.3255,0.2,10,0,0.9,0.2,0.07,0.03,24,,,,,,,,
0.529561127988977,0.1,0.3489125293076058,1,2,3,4,5,6,7,8,9,0.3255,0.2,10,0.1,0.8,0.3,0.06,0.04,27,,,,,,,,
)");
}

TEST(AnalyticCsv, WithoutEnergiesHasARowForThePair) {
  const std::string text = PrintedPairs(Format::kCsv, "");
  EXPECT_EQ(
      text.substr(text.find('\n') + 1),
      "0.529561127988977,0.1,0.3489125293076058,1,2,3,4,5,6,7,8,9,0.3255,0.2,10,,,,,,,,,,,,,,\n");
}

TEST(AnalyticCsv, ATemperatureHasARowAfterTheEnergies) {
  const std::string pair =
      "0.529561127988977,0.1,0.3489125293076058,1,2,3,4,5,6,7,8,9,0.3255,0.2,10";
  const std::string row = ",2,0.5,0.3,0.04,0.05,0.06,0.03,2.7\n";
  const std::string alone = PrintedPairs(Format::kCsv, kCanonical);
  EXPECT_EQ(alone.substr(alone.find('\n') + 1), pair + ",,,,,," + row);
  const std::string both =
      PrintedPairs(Format::kCsv, std::string("energies { epsilon: 0.25 phi: 1 }") + kCanonical);
  EXPECT_EQ(both.substr(both.find('\n') + 1),
            pair + ",0.25,1,0,0,0,0,,,,,,,,\n" + pair + ",,,,,," + row);
}

TEST(AnalyticJson, HasTheProtosNamesAtFullPrecision) {
  EXPECT_EQ(PrintedPairs(Format::kJson),
            R"({"points": [
{"rho":0.529561127988977,"delta":0.1,"lambda":0.3489125293076058,"eta":1,"cell_area":2,"volume":3,"area_ball_piston":4,"area_ball_wall":5,"area_piston_wall":6,"tau_ball_piston":7,"tau_ball_wall":8,"tau_piston_wall":9,"pair_delta_bound":0.3255,"gas_delta_bound":0.2,"rare_limit_rate":10,"energies":[{"epsilon":0,"phi":0.9,"f":0.2,"j":0.07,"h":0.03,"mean_free_time_conditional":24,"kernel":[0.25]},{"epsilon":0.1,"phi":0.8,"f":0.3,"j":0.06,"h":0.04,"mean_free_time_conditional":27,"kernel":[0.5]}],"canonical":[]}
]}
)");
}

TEST(AnalyticTable, ListsQuantitiesThenEnergies) {
  EXPECT_EQ(PrintedPairs(Format::kTable), R"(quantity          value
rho               0.529561127989
delta             0.1
lambda            0.348912529308
eta               1
cell_area         2
volume            3
area_ball_piston  4
area_ball_wall    5
area_piston_wall  6
tau_ball_piston   7
tau_ball_wall     8
tau_piston_wall   9
pair_delta_bound  0.3255
gas_delta_bound   0.2
rare_limit_rate   10

  epsilon  phi    f     j     h  mean_free_time_conditional  W(0.2)
        0  0.9  0.2  0.07  0.03                          24    0.25
      0.1  0.8  0.3  0.06  0.04                          27     0.5
)");
}

TEST(AnalyticTable, ListsTheAveragesAtEachTemperature) {
  const std::string text = PrintedPairs(Format::kTable, kCanonical);
  EXPECT_EQ(text.substr(text.find("\n\n")),
            R"(

  beta  temperature  mean_f  mean_energy_current  mean_h  exchange_rate  static_conductivity  rare_limit_exchange_rate
     2          0.5     0.3                 0.04    0.05           0.06                 0.03                       2.7
)");
}

}  // namespace
}  // namespace ballpiston::client
